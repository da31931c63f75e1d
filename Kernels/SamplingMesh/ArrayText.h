// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeArrayText_h
#define DeformVolumeArrayText_h

#include "OpenCLContext.h"
#include "VolumeArray.h"

#include <string>
#include <vector>

namespace deformvolume
{

/// Returns the OpenCL C name of a type.
std::string GetTypeName(ElementType type);

/// Whether an array can be interpolated in single precision with vector instructions.
bool FitsFloat(const VolumeArray& array);

/// Returns the statement that stores one array at a sample. index: number of the array, as in the
/// names of the kernel parameters.
std::string MakeStore(const VolumeArray& array, const std::string& index);

/// Returns the source text that must precede kernels that work on these arrays. Throws Error if the
/// arrays need double precision and the device has none.
std::string MakeArrayText(const OpenCLContext& context, const std::vector<VolumeArray>& arrays);

} // namespace deformvolume

#endif
