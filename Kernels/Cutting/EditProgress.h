// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEditProgress_h
#define DeformVolumeEditProgress_h

#include <functional>

namespace deformvolume
{

/// Called repeatedly while an edit is computed, in the calling thread, with the completed fraction,
/// 0 to 1. If it returns false, the edit is abandoned and Aborted is thrown.
using EditProgress = std::function<bool(double)>;

} // namespace deformvolume

#endif
