// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCrossedTetrahedra_h
#define DeformVolumeCrossedTetrahedra_h

#include "FiveTetrahedra.h"

#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Returns the active tetrahedra that no smooth cut crosses, one byte per cell: crossed tetrahedra
/// do not connect the two sides. active: null if all tetrahedra are active.
inline std::vector<unsigned char> SwitchOffCrossed(
  const unsigned char* active, const unsigned char* crossed, std::size_t numberOfCells)
{
  std::vector<unsigned char> remaining(numberOfCells, DEFORMVOLUME_ALL_TETRAHEDRA);
  for (std::size_t i = 0; i < numberOfCells; ++i)
  {
    remaining[i] = static_cast<unsigned char>((active ? active[i] : remaining[i]) & ~crossed[i]);
  }
  return remaining;
}

} // namespace deformvolume

#endif
