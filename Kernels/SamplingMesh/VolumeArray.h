// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeArray_h
#define DeformVolumeVolumeArray_h

#include "ElementType.h"

#include <cstddef>
#include <memory>

namespace deformvolume
{

/// One array over the voxels of the volume: tuples of Components elements, x varying fastest.
struct VolumeArray
{
  /// The values; aligned for Type.
  const void* Data = nullptr;
  /// What keeps Data where it is and as it is. With it a device that is a processor reads Data
  /// where it lies, at each Deform(), and holds the owner until it has other arrays; without it,
  /// and on other devices, Data is copied during the call. Null by default.
  std::shared_ptr<const void> Owner;
  /// The type of the elements.
  ElementType Type = ElementType::UInt8;
  /// Elements of a tuple, 1 or more.
  int Components = 1;
  /// True: take the value of the nearest vertex. False: interpolate linearly, and round to the
  /// nearest integer where the type is an integer type.
  bool Categorical = false;
  /// What voxels get that the deformed volume does not cover, clamped to the type's range.
  double Background = 0.0;
};

/// Bytes of one tuple.
inline std::size_t GetTupleSize(const VolumeArray& array)
{
  return GetElementSize(array.Type) * static_cast<std::size_t>(array.Components);
}

} // namespace deformvolume

#endif
