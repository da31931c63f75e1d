// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProcessors_h
#define DeformVolumeProcessors_h

#include "DeformVolumeExport.h"

#include <string>

namespace deformvolume
{

/// Returns the number of processors for one of `processes` processes that share this machine: at
/// least 1, and the minimum of:
/// - the processors to which this process is bound (taskset, MPI), not divided,
/// - the processors of the machine, divided by the number of processes,
/// - the CPU quota of the control groups, divided by the number of processes and rounded up.
/// root is a prefix of the paths of the control groups, for tests.
DEFORMVOLUME_EXPORT int GetProcessorShare(int processes, const std::string& root);

/// Returns the number of processors of this process, for the number of processes that
/// SetProcessesHere() has set. It limits the threads on the host and on CPU devices.
DEFORMVOLUME_EXPORT int GetProcessorShare();

/// Set the number of processes that share this machine. Default: 1.
DEFORMVOLUME_EXPORT void SetProcessesHere(int processes);

} // namespace deformvolume

#endif
