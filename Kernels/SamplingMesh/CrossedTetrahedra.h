// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCrossedTetrahedra_h
#define DeformVolumeCrossedTetrahedra_h

#include "FiveTetrahedra.h"

#include <cstddef>
#include <vector>

namespace deformvolume
{

/// The active tetrahedra without those that a smooth cut crosses, one byte a cell: what is crossed
/// holds nothing together. active: null where all are.
inline std::vector<unsigned char> SwitchOffCrossed(
  const unsigned char* active, const unsigned char* crossed, std::size_t numberOfCells)
{
  std::vector<unsigned char> left(numberOfCells, DEFORMVOLUME_ALL_TETRAHEDRA);
  for (std::size_t i = 0; i < numberOfCells; ++i)
  {
    left[i] = static_cast<unsigned char>((active ? active[i] : left[i]) & ~crossed[i]);
  }
  return left;
}

} // namespace deformvolume

#endif
