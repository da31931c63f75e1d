// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVTKThreads_h
#define DeformVolumeVTKThreads_h

namespace deformvolume
{

/// Makes all parallel loops of this process (ParallelFor.h) use VTK's threads. If VTK is sequential
/// by default, or has more threads than this process's share of the processors, they use threads of
/// their own. The settings of vtkSMPTools do not change.
void UseVTKThreads();

} // namespace deformvolume

#endif
