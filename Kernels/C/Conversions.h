// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeConversions_h
#define DeformVolumeConversions_h

#include "ImageGeometry.h"
#include "VectorView.h"
#include "VolumeArray.h"
#include "deformvolume.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace deformvolume
{

/// What programs in C give, checked, as the engine takes it. All throw an Error, which calls the
/// thing by the name given.

/// A number of things of which each takes some bytes.
std::size_t GetProduct(std::int64_t count, std::size_t factor, const char* what);

ImageGeometry MakeGeometry(const dv_grid* given, const char* name);

/// Vectors of three floats or doubles.
VectorView MakeView(const void* data, std::int32_t type, std::int64_t count, const char* what);

/// The data are borrowed.
VolumeArray MakeArray(const dv_array& given, const std::string& name);

/// Null: no progress.
std::function<bool(double)> MakeProgress(dv_progress progress, void* user);

} // namespace deformvolume

#endif
