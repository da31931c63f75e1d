// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgramText_h
#define DeformVolumeProgramText_h

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace deformvolume
{

/// The source text of a program, as a list of pieces. Each update looks up programs, and their
/// texts are long. So constant pieces are compared by address, and a look-up does not read them.
class ProgramText
{
public:
  ProgramText() = default;
  /// constant: a literal or a text of KernelSources.h, which is never deleted.
  ProgramText(const char* constant)
    : Pieces{ constant }
  {
  }
  ProgramText(std::string text)
    : Pieces{ std::move(text) }
  {
  }

  ProgramText& operator+=(const ProgramText& other)
  {
    this->Pieces.insert(this->Pieces.end(), other.Pieces.begin(), other.Pieces.end());
    return *this;
  }
  friend ProgramText operator+(ProgramText first, const ProgramText& second)
  {
    first += second;
    return first;
  }
  /// Compares pieces. Two ProgramTexts with equal text may be different if their pieces differ.
  bool operator<(const ProgramText& other) const { return this->Pieces < other.Pieces; }

  std::string GetText() const
  {
    std::string text;
    for (const Piece& piece : this->Pieces)
    {
      std::visit([&](const auto& words) { text += words; }, piece);
    }
    return text;
  }

private:
  using Piece = std::variant<const char*, std::string>;
  std::vector<Piece> Pieces;
};

} // namespace deformvolume

#endif
