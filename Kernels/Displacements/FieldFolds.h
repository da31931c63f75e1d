// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldFolds_h
#define DeformVolumeFieldFolds_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"

#include <cstdint>

namespace deformvolume
{

/// Of the tetrahedra of a field's grid, five for each cell, the number that the field turns
/// inside out. Where there are any, several points are led to one.
DEFORMVOLUME_EXPORT std::int64_t CountInvertedTetrahedra(const DisplacementField& field);

} // namespace deformvolume

#endif
