// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailLimits.h"

#include "ChainMailParameters.h"
#include "Error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

constexpr std::size_t MostMaterials = 256;
constexpr double LargestLimit = 1000.0;
constexpr int LargestWeight = 255;
// The weight of a link with a smaller range is computed with this range.
constexpr double SmallestRange = 1.0 / 1024.0;

void Check(const ChainMailMaterial& material, std::size_t index)
{
  const std::string name = "Material " + std::to_string(index);
  // Each condition is negated so that NaN is refused, too.
  if (!(material.MinimumStretch >= 0.0 && material.MinimumStretch <= 1.0))
  {
    throw Error(name + " has the minimum stretch " + FormatNumber(material.MinimumStretch) +
      ". It must be between 0 and 1, as a link at rest has the length 1.");
  }
  if (!(material.MaximumStretch >= 1.0 && material.MaximumStretch <= LargestLimit))
  {
    throw Error(name + " has the maximum stretch " + FormatNumber(material.MaximumStretch) +
      ". It must be between 1 and 1000, as a link at rest has the length 1.");
  }
  if (!(material.Shear >= 0.0 && material.Shear <= LargestLimit))
  {
    throw Error(
      name + " has the shear " + FormatNumber(material.Shear) + ". It must be between 0 and 1000.");
  }
}

// Rounds down, so that no displacement exceeds a limit. Multiples of a unit do not change.
std::int32_t ToUnits(double limit)
{
  return static_cast<std::int32_t>(std::min(std::floor(limit * DEFORMVOLUME_CHAINMAIL_UNITS + 1e-6),
    static_cast<double>(DEFORMVOLUME_NO_LIMIT)));
}

} // namespace

ChainMailLimits::ChainMailLimits(
  const std::vector<ChainMailMaterial>& table, const std::array<double, 3>& spacing)
  : Limits(3 * 3 * 2 * MostMaterials)
  , Weights(2 * MostMaterials * MostMaterials)
  , Reciprocals(6 * LargestWeight + 1)
{
  if (table.empty() || table.size() > MostMaterials)
  {
    throw Error("There are " + std::to_string(table.size()) +
      " materials. ChainMail needs at least one and at most 256.");
  }
  double smallest = 2.0 * LargestLimit;
  for (std::size_t m = 0; m < table.size(); ++m)
  {
    Check(table[m], m);
    smallest = std::min(
      { smallest, table[m].MaximumStretch - table[m].MinimumStretch, 2.0 * table[m].Shear });
    for (std::size_t component = 0; component < 3; ++component)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const bool along = axis == component;
        const double ratio = spacing[axis] / spacing[component];
        std::int32_t* limits = this->Limits.data() + (3 * component + axis) * 2 * MostMaterials;
        limits[m] = ToUnits(along ? table[m].MaximumStretch - 1.0 : table[m].Shear * ratio);
        limits[MostMaterials + m] =
          ToUnits(along ? 1.0 - table[m].MinimumStretch : table[m].Shear * ratio);
      }
    }
  }
  smallest = std::max(smallest, SmallestRange);
  for (std::size_t a = 0; a < table.size(); ++a)
  {
    for (std::size_t b = 0; b < table.size(); ++b)
    {
      const double ranges[2] = { (table[a].MaximumStretch - table[a].MinimumStretch +
                                   table[b].MaximumStretch - table[b].MinimumStretch) /
          2.0,
        table[a].Shear + table[b].Shear };
      for (std::size_t kind = 0; kind < 2; ++kind)
      {
        const double weight = LargestWeight * smallest / std::max(ranges[kind], smallest);
        this->Weights[(kind * MostMaterials + a) * MostMaterials + b] =
          static_cast<unsigned char>(std::max(1L, std::lround(weight)));
      }
    }
  }
  for (std::size_t sum = 1; sum < this->Reciprocals.size(); ++sum)
  {
    this->Reciprocals[sum] = 1.0F / static_cast<float>(sum);
  }
}

} // namespace deformvolume
