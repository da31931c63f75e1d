// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgramText_h
#define DeformVolumeProgramText_h

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace deformvolume
{

/// The source text of a program, as a list of parts. Each update looks up programs, and their texts
/// are long. Therefore constant parts are compared by address, and a look-up does not read them.
class ProgramText
{
public:
  ProgramText() = default;
  /// constant: a literal or a text of KernelSources.h, which is never deleted.
  ProgramText(const char* constant)
    : Parts{ constant }
  {
  }
  ProgramText(std::string text)
    : Parts{ std::move(text) }
  {
  }

  ProgramText& operator+=(const ProgramText& other)
  {
    this->Parts.insert(this->Parts.end(), other.Parts.begin(), other.Parts.end());
    return *this;
  }
  friend ProgramText operator+(ProgramText first, const ProgramText& second)
  {
    first += second;
    return first;
  }
  /// Compares the parts. Two ProgramTexts with equal text differ if they consist of different
  /// parts.
  bool operator<(const ProgramText& other) const { return this->Parts < other.Parts; }

  std::string GetText() const
  {
    std::string text;
    for (const Part& part : this->Parts)
    {
      std::visit([&](const auto& words) { text += words; }, part);
    }
    return text;
  }

private:
  using Part = std::variant<const char*, std::string>;
  std::vector<Part> Parts;
};

} // namespace deformvolume

#endif
