// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelMaterials_h
#define DeformVolumeVoxelMaterials_h

#include <array>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <vector>

namespace deformvolume
{

/// A range of values with one material: Minimum <= value < Maximum.
struct MaterialRange
{
  /// The least value of the range.
  double Minimum;
  /// The end of the range, which does not belong to it.
  double Maximum;
  /// The number of the material.
  int Index;
};

/// The map from values of voxels to materials, of which there are at most 256.
struct MaterialRule
{
  /// The first range that contains a value is used. Empty: values are numbers of materials.
  std::vector<MaterialRange> Ranges;
  /// The material of values that no range contains.
  int Fallback = 0;
  /// Whether each material is defined.
  std::array<bool, 256> Exists{};
};

/// Converts a value to the number of a material. Returns -1 if it is not an integer from 0 to 255.
template <typename T>
int GetMaterialNumber(T value)
{
  const bool isNumber = value >= static_cast<T>(0) && static_cast<double>(value) <= 255.0 &&
    static_cast<T>(static_cast<int>(value)) == value;
  return isNumber ? static_cast<int>(value) : -1;
}

/// Writes the material of each value. Returns the index of the first value without a defined
/// material, or -1. masks: null, or a byte for each value. Values whose byte has one of the bits
/// `ignored` get the fallback material.
template <typename Values>
std::int64_t WriteMaterials(const Values& values, const MaterialRule& rule,
  unsigned char* materials, const unsigned char* masks = nullptr, unsigned char ignored = 0)
{
  using Value =
    std::decay_t<typename std::iterator_traits<decltype(std::begin(values))>::value_type>;
  std::int64_t without = -1;
  std::int64_t voxel = 0;
  for (const Value value : values)
  {
    if (masks && (masks[voxel] & ignored) != 0)
    {
      materials[voxel++] = static_cast<unsigned char>(rule.Fallback);
      continue;
    }
    int index = rule.Ranges.empty() ? GetMaterialNumber<Value>(value) : rule.Fallback;
    for (const MaterialRange& range : rule.Ranges)
    {
      const auto number = static_cast<double>(value);
      if (number >= range.Minimum && number < range.Maximum)
      {
        index = range.Index;
        break;
      }
    }
    if ((index < 0 || !rule.Exists[static_cast<std::size_t>(index)]) && without < 0)
    {
      without = voxel;
    }
    materials[voxel++] = static_cast<unsigned char>(index);
  }
  return without;
}

} // namespace deformvolume

#endif
