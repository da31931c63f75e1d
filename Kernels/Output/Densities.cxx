// SPDX-License-Identifier: BSD-3-Clause
#include "Densities.h"

#include <iomanip>
#include <sstream>

namespace deformvolume
{

std::string DescribeLoss(
  std::int64_t hidden, std::int64_t covered, std::int64_t lost, const std::string& background)
{
  std::string text;
  if (hidden > 0)
  {
    const auto samples = static_cast<double>(hidden);
    std::ostringstream share;
    share << std::setprecision(2) << 100.0 * samples / (samples + static_cast<double>(covered));
    text = "The deformation folds the volume over. The sums of density arrays lack the tissue that "
           "other parts hide, " +
      share.str() +
      " % of the deformed volume. This can be a larger share of a sum, since densities are high "
      "where the volume is compressed.";
  }
  if (lost > 0)
  {
    text += (text.empty() ? "" : " ") + std::to_string(lost) +
      " voxels show the volume inside out, or compressed to zero volume: density arrays have " +
      background + " there.";
  }
  return text;
}

} // namespace deformvolume
