// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeEditProgress_h
#define DeformVolumeEditProgress_h

#include <functional>

namespace deformvolume
{

/// Called now and then while it is found what an edit hits, in the thread that asked for it, with
/// how much is done, 0 to 1. Where it returns false the edit is given up: Aborted is thrown.
using EditProgress = std::function<bool(double)>;

} // namespace deformvolume

#endif
