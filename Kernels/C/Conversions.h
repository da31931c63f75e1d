// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeConversions_h
#define DeformVolumeConversions_h

#include "ImageGeometry.h"
#include "VectorView.h"
#include "VolumeArray.h"
#include "deformvolume.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace deformvolume
{

/// The following functions check input of C programs, and convert it to types of the engine. All of
/// them throw an Error if it is invalid. name, what: names the input in the message.

/// Returns a number of items as std::size_t. factor: the number of bytes of an item. Throws an
/// Error if the number is negative, or if the number of bytes overflows.
std::size_t GetProduct(std::int64_t count, std::size_t factor, const char* what);

ImageGeometry MakeGeometry(const dv_grid* given, const char* name);

/// Returns a view of `count` vectors of three floats or doubles.
VectorView MakeView(const void* data, std::int32_t type, std::int64_t count, const char* what);

/// Returns `count` points of three floats or doubles.
std::vector<glm::dvec3> ReadPoints(
  const void* data, std::int32_t type, std::int64_t count, const char* what);

/// Returns an array that borrows the data.
VolumeArray MakeArray(const dv_array& given, const std::string& name);
/// The same for an array that must have one component.
VolumeArray MakeScalars(const dv_array* given, const char* what);

/// Converts a progress callback. Null: no callback.
std::function<bool(double)> MakeProgress(dv_progress progress, void* user);

} // namespace deformvolume

#endif
