// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElementType_h
#define DeformVolumeElementType_h

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// Element types of the arrays of a volume, as X(name, C++ type, OpenCL type).
#define DEFORMVOLUME_ELEMENT_TYPES(X)                                                              \
  X(Int8, std::int8_t, "char")                                                                     \
  X(UInt8, std::uint8_t, "uchar")                                                                  \
  X(Int16, std::int16_t, "short")                                                                  \
  X(UInt16, std::uint16_t, "ushort")                                                               \
  X(Int32, std::int32_t, "int")                                                                    \
  X(UInt32, std::uint32_t, "uint")                                                                 \
  X(Int64, std::int64_t, "long")                                                                   \
  X(UInt64, std::uint64_t, "ulong")                                                                \
  X(Float32, float, "float")                                                                       \
  X(Float64, double, "double")

/// Element type of an array.
enum class ElementType
{
#define DEFORMVOLUME_ENUMERATOR(name, type, cl) name,
  DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_ENUMERATOR)
#undef DEFORMVOLUME_ENUMERATOR
};

/// Calls a function with a zero of an element type.
template <typename Function>
void DispatchElementType(ElementType type, const Function& function)
{
  switch (type)
  {
#define DEFORMVOLUME_CASE(name, ctype, cl)                                                         \
  case ElementType::name:                                                                          \
    function(ctype());                                                                             \
    break;
    DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
  }
}

/// Bytes of one element.
inline std::size_t GetElementSize(ElementType type)
{
  std::size_t size = 0;
  DispatchElementType(type, [&](auto zero) { size = sizeof(zero); });
  return size;
}

} // namespace deformvolume

#endif
