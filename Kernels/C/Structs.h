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

/// Throws an Error where a pointer that is needed is null.
inline void CheckPointer(const void* pointer, const char* name)
{
  if (!pointer)
  {
    throw Error(std::string(name) + " is null.");
  }
}

/// The size of a structure in the first version of the interface that has it: what programs know at
/// least. Where one grows, a specialisation has the old size.
template <typename T>
inline constexpr std::size_t FirstSize = sizeof(T);
template <>
inline constexpr std::size_t FirstSize<dv_mesh> = offsetof(dv_mesh, degrees);

/// Throws an Error where a structure is smaller than it ever was.
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

/// Reads a structure of a program that may know fewer or more members: those that it does not know
/// are 0.
template <typename T>
T ReadStruct(const T* given, const char* name)
{
  T read{};
  std::memcpy(&read, given, std::min(CheckStruct(given, name), sizeof(T)));
  return read;
}

/// The same for what the library writes: the size that the program knows stays.
template <typename T>
void WriteStruct(T written, T* given, const char* name)
{
  written.struct_size = CheckStruct(given, name);
  std::memcpy(given, &written, std::min(written.struct_size, sizeof(T)));
}

} // namespace deformvolume

#endif
