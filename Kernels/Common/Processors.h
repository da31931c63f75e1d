// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProcessors_h
#define DeformVolumeProcessors_h

#include "DeformVolumeExport.h"

#include <string>

namespace deformvolume
{

/// The processors that are for one of so many processes, which share the machine and a control
/// group alike: those of the machine on which it may run (taskset, MPI's binding), and what the
/// control groups that it is in are given of their time, rounded up. At least 1. A process that is
/// bound to some processors has these for itself.
/// root is put in front of the paths of the control groups, for tests.
DEFORMVOLUME_EXPORT int GetProcessorShare(int processes, const std::string& root);

/// The share of this process: of as many as SetProcessesHere said last. Threads of the host and
/// devices that are processors take no more.
DEFORMVOLUME_EXPORT int GetProcessorShare();

/// So many processes share this machine. Default 1.
DEFORMVOLUME_EXPORT void SetProcessesHere(int processes);

} // namespace deformvolume

#endif
