// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFailureReport_h
#define DeformVolumeFailureReport_h

class vtkAlgorithm;

namespace deformvolume
{

/// What a request returns after an error: 0, but 1 in ParaView, where an empty output and the
/// message have to do. The executive would add an error of its own, with the request's keys: that
/// one is not displayed, since the algorithm has said what is wrong. Observers of the executive get
/// it all the same.
int Fail(vtkAlgorithm* algorithm);

} // namespace deformvolume

#endif
