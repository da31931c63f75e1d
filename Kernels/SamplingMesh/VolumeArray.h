// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeArray_h
#define DeformVolumeVolumeArray_h

#include "ElementType.h"

#include <cstddef>
#include <memory>

namespace deformvolume
{

/// An array over the voxels of a volume: tuples of Components elements, with x varying fastest.
struct VolumeArray
{
  /// The values, aligned for Type.
  const void* Data = nullptr;
  /// Owner of Data. While an object holds the owner, Data must stay valid and unchanged. With an
  /// owner, a CPU device reads Data in place at each Deform(), and holds the owner until other
  /// arrays are set. Without an owner, and on other devices, the call copies Data. Default: null.
  std::shared_ptr<const void> Owner;
  /// Type of the elements.
  ElementType Type = ElementType::UInt8;
  /// Number of components of a tuple, 1 or more.
  int Components = 1;
  /// True: use the value of the nearest vertex. False: interpolate linearly, and round to the
  /// nearest integer for integer types.
  bool Categorical = false;
  /// Value of output voxels outside the deformed volume, clamped to the range of Type.
  double Background = 0.0;
};

/// Bytes of one tuple.
inline std::size_t GetTupleSize(const VolumeArray& array)
{
  return GetElementSize(array.Type) * static_cast<std::size_t>(array.Components);
}

} // namespace deformvolume

#endif
