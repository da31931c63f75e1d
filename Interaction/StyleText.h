// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStyleText_h
#define DeformVolumeStyleText_h

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>

namespace deformvolume
{

/// A tool or a model, and the key that chooses it.
struct Choice
{
  char Key;
  const char* Name;
};
/// In the order of vtkDeformVolumeInteractorStyle::Tools and vtkDeformVolumeSession::Models.
inline constexpr std::array<Choice, 6> ToolChoices = { { { 't', "turn" }, { 'g', "grab" },
  { 'c', "cut" }, { 'v', "carve" }, { 'b', "probe" }, { 'm', "measure" } } };
inline constexpr std::array<Choice, 4> ModelChoices = { { { '1', "none" }, { '2', "ChainMail" },
  { '3', "mass-spring" }, { '4', "finite elements" } } };

/// Lists all choices in one line, with the chosen one in brackets.
template <std::size_t Count>
std::string ListChoices(const std::array<Choice, Count>& choices, int chosen)
{
  std::string text;
  for (std::size_t i = 0; i < Count; ++i)
  {
    const bool isChosen = static_cast<int>(i) == chosen;
    text += text.empty() ? "" : " ";
    text += isChosen ? '[' : ' ';
    text += choices[i].Key;
    text += ' ';
    text += choices[i].Name;
    text += isChosen ? ']' : ' ';
  }
  return text;
}

/// Returns the index of the choice with a key; -1 if there is none.
template <std::size_t Count>
int FindChoice(const std::array<Choice, Count>& choices, char key)
{
  for (std::size_t i = 0; i < Count; ++i)
  {
    if (choices[i].Key == key)
    {
      return static_cast<int>(i);
    }
  }
  return -1;
}

///@{
/// Return numbers with up to four significant digits. The numbers of a position are in parentheses.
inline std::string FormatShort(double number)
{
  char digits[32];
  std::snprintf(digits, sizeof(digits), "%.4g", number);
  return digits;
}
inline std::string FormatShort(const double position[3])
{
  return "(" + FormatShort(position[0]) + ", " + FormatShort(position[1]) + ", " +
    FormatShort(position[2]) + ")";
}
///@}

} // namespace deformvolume

#endif
