// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVTKThreads_h
#define DeformVolumeVTKThreads_h

namespace deformvolume
{

/// Has all loops of this process (ParallelFor.h) use VTK's threads, or as many threads of their own
/// where VTK's do not serve. The settings of vtkSMPTools are respected and stay as they are.
void UseVTKThreads();

} // namespace deformvolume

#endif
