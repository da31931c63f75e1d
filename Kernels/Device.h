// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDevice_h
#define DeformVolumeDevice_h

#include <string>
#include <vector>

namespace deformvolume
{

/// Names of the OpenCL devices of this machine, the best first, as "device (platform)".
/// Empty where there is no OpenCL platform; never throws for that.
std::vector<std::string> GetDeviceNames();

/// The name of the device that a request resolves to, with the rules of vtkDeformVolumeFilter::
/// SetDevice: "" is the value of the environment variable DEFORMVOLUME_DEVICE where that is set
/// and otherwise the best device; "cpu" and "gpu" are the best device of that kind; everything
/// else is a part of a device's name, compared without regard to case. Throws Error where no
/// device answers to the request.
std::string ResolveDevice(const std::string& request);

/// So many processes share the processors of this machine: devices that are processors take their
/// share of these, unless the environment variable POCL_MAX_PTHREAD_COUNT is set. To be called
/// before any other function, as devices start once.
void ShareProcessors(int processes);

} // namespace deformvolume

#endif
