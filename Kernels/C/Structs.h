// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStructs_h
#define DeformVolumeStructs_h

#include "Error.h"
#include "deformvolume.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

namespace deformvolume
{

/// Throws an Error if a required pointer is null.
inline void CheckPointer(const void* pointer, const char* name)
{
  if (!pointer)
  {
    throw Error(std::string(name) + " is null.");
  }
}

/// The size of a structure in the first version of the interface that has it: the least size that a
/// program can have been compiled with. A structure that has grown since has a specialization.
template <typename T>
inline constexpr std::size_t FirstSize = sizeof(T);
template <>
inline constexpr std::size_t FirstSize<dv_mesh> = offsetof(dv_mesh, degrees);
template <>
inline constexpr std::size_t FirstSize<dv_field> = offsetof(dv_field, undefined);

/// Throws an Error if a structure is smaller than in the first version of the interface.
template <typename T>
std::size_t CheckStruct(const T* given, const char* name)
{
  CheckPointer(given, name);
  if (given->struct_size < FirstSize<T>)
  {
    throw Error("struct_size of " + std::string(name) + " is " +
      std::to_string(given->struct_size) + ", less than " + std::to_string(FirstSize<T>) +
      ". Set it to the size of the structure.");
  }
  return given->struct_size;
}

/// Reads a structure of a program that was compiled with fewer or more members. Members that the
/// program does not have are 0.
template <typename T>
T ReadStruct(const T* given, const char* name)
{
  T read{};
  std::memcpy(&read, given, std::min(CheckStruct(given, name), sizeof(T)));
  return read;
}

/// Writes a structure to a program that was compiled with fewer or more members. struct_size of the
/// program does not change.
template <typename T>
void WriteStruct(T written, T* given, const char* name)
{
  written.struct_size = CheckStruct(given, name);
  std::memcpy(given, &written, std::min(written.struct_size, sizeof(T)));
}

} // namespace deformvolume

#endif
