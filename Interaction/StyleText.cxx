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

std::string Format(const double place[3])
{
  return "(" + Format(place[0]) + ", " + Format(place[1]) + ", " + Format(place[2]) + ")";
}

} // namespace deformvolume
