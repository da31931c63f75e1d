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

/// Values from Minimum on, less than Maximum, have a material.
struct MaterialRange
{
  /// The least value of the material.
  double Minimum;
  /// The first value beyond it.
  double Maximum;
  /// The number of the material.
  int Index;
};

/// How the values of voxels tell materials, of which there are at most 256.
struct MaterialRule
{
  /// The first range that holds a value counts; without ranges values are numbers of materials.
  std::vector<MaterialRange> Ranges;
  /// The material of values that no range holds.
  int Fallback = 0;
  /// Which materials there are.
  std::array<bool, 256> Exists{};
};

/// The number of the material that a value is, or -1.
template <typename T>
int GetMaterialNumber(T value)
{
  const bool isNumber = value >= static_cast<T>(0) && static_cast<double>(value) <= 255.0 &&
    static_cast<T>(static_cast<int>(value)) == value;
  return isNumber ? static_cast<int>(value) : -1;
}

/// Writes the material of each of some values. Returns the place of the first one that has none,
/// or -1.
template <typename Values>
std::int64_t WriteMaterials(
  const Values& values, const MaterialRule& rule, unsigned char* materials)
{
  using Value =
    std::decay_t<typename std::iterator_traits<decltype(std::begin(values))>::value_type>;
  std::int64_t without = -1;
  std::int64_t place = 0;
  for (const Value value : values)
  {
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
      without = place;
    }
    materials[place++] = static_cast<unsigned char>(index);
  }
  return without;
}

} // namespace deformvolume

#endif
