// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldFolds_h
#define DeformVolumeFieldFolds_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"

#include <cstdint>

namespace deformvolume
{

/// Counts the tetrahedra that a field inverts. Each cell of the field's grid is split into five
/// tetrahedra. If any is inverted, the field maps several points to the same position.
DEFORMVOLUME_EXPORT std::int64_t CountInvertedTetrahedra(const DisplacementField& field);

} // namespace deformvolume

#endif
