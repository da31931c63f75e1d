// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgramText_h
#define DeformVolumeProgramText_h

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace deformvolume
{

/// The text of a program, in pieces. Programs are asked for at each update, and their text is long:
/// constant pieces are known by their address, so that a program is found without its text.
class ProgramText
{
public:
  ProgramText() = default;
  /// A constant: a literal or a text of KernelSources.h, which stays as long as the process lives.
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
  /// Texts that are equal may differ, where their pieces do.
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
