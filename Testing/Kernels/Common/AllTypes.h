// SPDX-License-Identifier: BSD-3-Clause
#ifndef AllTypes_h
#define AllTypes_h

#include "DeformerCase.h"

#include <algorithm>
#include <type_traits>
#include <vector>

/// Interpolated arrays of all types, categorical ones with two components, and some interpolated
/// ones with two components. Their kernels take a minute to compile, so all tests use the same
/// ones.
struct AllTypes
{
  AllTypes(std::size_t voxels, double background, bool bits)
  {
    const auto fill = [&](auto& values, std::size_t size, unsigned int seed)
    {
      using T = typename std::decay_t<decltype(values)>::value_type;
      values = bits ? MakeRandomBits<T>(size, seed) : MakeRandomValues<T>(size, seed);
    };
#define ADD(name, type, cl)                                                                        \
  fill(this->One##name, voxels, 11);                                                               \
  fill(this->Two##name, 2 * voxels, 12);                                                           \
  this->Arrays.push_back(MakeArray(this->One##name, 1, false, background));                        \
  this->Arrays.push_back(MakeArray(this->Two##name, 2, true, background));
    DEFORMVOLUME_ELEMENT_TYPES(ADD)
#undef ADD
    this->Arrays.push_back(MakeArray(this->TwoUInt8, 2, false, background));
    this->Arrays.push_back(MakeArray(this->TwoInt64, 2, false, background));
    this->Arrays.push_back(MakeArray(this->TwoFloat32, 2, false, background));
  }
  AllTypes(const AllTypes&) = delete;
  AllTypes& operator=(const AllTypes&) = delete;

  /// The number of the interpolated array with one component of a type.
  template <typename T>
  int Find() const
  {
    const auto found = std::find_if(this->Arrays.begin(), this->Arrays.end(),
      [](const deformvolume::VolumeArray& array)
      { return array.Type == GetElementType<T>() && array.Components == 1; });
    return static_cast<int>(found - this->Arrays.begin());
  }

  std::vector<deformvolume::VolumeArray> Arrays;
#define DECLARE(name, type, cl)                                                                    \
  std::vector<type> One##name;                                                                     \
  std::vector<type> Two##name;
  DEFORMVOLUME_ELEMENT_TYPES(DECLARE)
#undef DECLARE
};

#endif
