// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaterialTable_h
#define DeformVolumeMaterialTable_h

#include "MaterialArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

namespace deformvolume
{

/// Whether a number is an index of a material, 0 to 255.
inline bool IsMaterialIndex(double index)
{
  return index >= 0.0 && index <= 255.0 && index == std::floor(index);
}

/// Materials by their indices, and the ranges of values that have them. Material: numbers only.
template <typename Material>
struct MaterialTable
{
  static_assert(std::is_trivially_copyable_v<Material>, "materials are compared by their bytes");

  std::array<Material, 256> Materials;
  std::array<bool, 256> Exists{};
  std::vector<MaterialRange> Ranges;

  /// Returns whether it was not so before.
  bool Set(std::size_t index, const Material& material)
  {
    Material& last = this->Materials[index];
    if (this->Exists[index] && std::memcmp(&last, &material, sizeof(Material)) == 0)
    {
      return false;
    }
    last = material;
    this->Exists[index] = true;
    return true;
  }

  /// Null where there is none.
  const Material* Find(int index) const
  {
    return IsMaterialIndex(index) && this->Exists[static_cast<std::size_t>(index)]
      ? &this->Materials[static_cast<std::size_t>(index)]
      : nullptr;
  }

  int GetNumber() const
  {
    return static_cast<int>(std::count(this->Exists.begin(), this->Exists.end(), true));
  }
};

} // namespace deformvolume

#endif
