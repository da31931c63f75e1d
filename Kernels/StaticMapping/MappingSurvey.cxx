// SPDX-License-Identifier: BSD-3-Clause
#include "MappingSurvey.h"

#include "VertexLink.h"
#include "VertexRuns.h"

#include <algorithm>

namespace deformvolume
{

std::uint64_t MappingSurvey::GetRunBytes(const Extent& voxels) const
{
  if (this->Samples.empty())
  {
    return 0;
  }
  double runs = 0.0;
  double slivers = 0.0;
  double rows = 0.0;
  for (const TileSample& sample : this->Samples)
  {
    runs += static_cast<double>(sample.Runs);
    slivers += static_cast<double>(sample.RunsOfSlivers);
    rows += static_cast<double>(sample.Rows);
  }
  const std::int64_t allRows = GetSize(voxels, 1) * GetSize(voxels, 2);
  const double factor = static_cast<double>(allRows) / rows;
  const std::int64_t records = std::min(this->NumberOfTetrahedra, this->NumberOfEntries);
  const double meanLength = rows * static_cast<double>(GetSize(voxels, 0)) / runs;
  const std::uint64_t bytes = deformvolume::GetRunBytes(static_cast<std::uint64_t>(factor * runs),
    static_cast<std::uint64_t>(allRows),
    static_cast<std::uint64_t>(records) + static_cast<std::uint64_t>(factor * slivers));
  const bool worthwhile = meanLength >= LeastMeanRunLength &&
    bytes < static_cast<std::uint64_t>(GetNumberOfPoints(voxels)) * sizeof(VertexLink);
  return worthwhile || this->Form == StaticMappingForm::Runs ? bytes : 0;
}

} // namespace deformvolume
