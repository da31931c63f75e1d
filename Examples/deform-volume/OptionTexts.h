// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOptionTexts_h
#define DeformVolumeOptionTexts_h

#include "ChainMail.h"
#include "ElasticModel.h"
#include "Failure.h"
#include "Push.h"
#include "Tools.h"
#include "TransformReading.h"

#include <array>
#include <cstddef>
#include <optional>
#include <sstream>
#include <string>

/// Reads numbers with commas between them. shape: the expected text, in words. whole: the argument
/// of the option, if the text is only a part of it. All functions here throw a UsageError with the
/// option and its argument.
template <typename Number, std::size_t Count>
std::array<Number, Count> ParseNumbers(const std::string& option, const std::string& text,
  const std::string& shape, const std::string& whole = "")
{
  std::array<Number, Count> numbers;
  std::istringstream stream(text);
  bool valid = true;
  for (std::size_t i = 0; i < Count && valid; ++i)
  {
    char comma = ',';
    valid = (i == 0 || stream >> comma) && comma == ',' && static_cast<bool>(stream >> numbers[i]);
  }
  if (!valid || !(stream >> std::ws).eof())
  {
    const std::string argument = option + " " + (whole.empty() ? text : whole);
    throw UsageError(argument + (argument.back() == ':' ? "" : ":") + " expected " + shape);
  }
  return numbers;
}

///@{
/// Parse the argument of the option of that name.
Push ParsePush(const std::string& text);
Pull ParsePull(const std::string& text);
Fixation ParseFixation(const std::string& text);
Carving ParseCarving(const std::string& text);
MaterialOfValues ParseMaterial(const std::string& text);
TransformFile ParseTransform(const std::string& text);
std::array<int, 3> ParseLattice(const std::string& text);
std::array<double, 3> ParseGravity(const std::string& text);
std::array<double, 3> ParseSpacing(const std::string& text);
std::array<double, 3> ParseView(const std::string& text);
///@}

/// The Young modulus, Poisson ratio and density of a tissue (vtkElasticDeformation), by its name in
/// lower case. Empty if there is no such tissue.
std::optional<std::array<double, 3>> FindTissue(const std::string& name);
/// The names of all tissues, with commas between them.
std::string GetTissues();

#endif
