// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeArrayText_h
#define DeformVolumeArrayText_h

#include "OpenCLContext.h"
#include "VolumeArray.h"

#include <string>
#include <vector>

namespace deformvolume
{

/// The OpenCL C name of a type.
std::string GetTypeName(ElementType type);

/// Whether single precision is enough to interpolate an array, and vectors of it are worthwhile.
bool FitsFloat(const VolumeArray& array);

/// The statement that stores one array at a sample. index: its number, as in the names of the
/// parameters.
std::string MakeStore(const VolumeArray& array, const std::string& index);

/// What kernels that work on arrays of these types expect in front of them. Throws Error where the
/// device lacks what the arrays need.
std::string MakeArrayText(const OpenCLContext& context, const std::vector<VolumeArray>& arrays);

} // namespace deformvolume

#endif
