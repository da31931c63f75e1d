// SPDX-License-Identifier: BSD-3-Clause
#include "StyleText.h"

#include <cstdio>

namespace deformvolume
{

std::string Format(double number)
{
  char digits[32];
  std::snprintf(digits, sizeof(digits), "%.4g", number);
  return digits;
}

std::string Format(const double position[3])
{
  return "(" + Format(position[0]) + ", " + Format(position[1]) + ", " + Format(position[2]) + ")";
}

} // namespace deformvolume
