// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaterialTable_h
#define DeformVolumeMaterialTable_h

#include "Error.h"
#include "MaterialArray.h"

#include "vtkIndent.h"
#include "vtkObject.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace deformvolume
{

/// Whether a number is an index of a material: an integer from 0 to 255.
inline bool IsMaterialIndex(double index)
{
  return index >= 0.0 && index <= 255.0 && index == std::floor(index);
}

/// Materials by their indices, and ranges of values with the index of a material.
/// vtkChainMailDeformation and vtkMaterialFromVolume have such tables. Material: a struct of three
/// doubles.
template <typename Material>
struct MaterialTable
{
  static_assert(std::is_trivially_copyable_v<Material> && sizeof(Material) == 3 * sizeof(double),
    "materials are compared and read by their bytes");

  std::array<Material, 256> Materials;
  std::array<bool, 256> Exists{};
  std::vector<MaterialRange> Ranges;

  ///@{
  /// Call Modified() of the owner if something changes. If an index is not an integer from 0 to
  /// 255, report an error of the owner and change nothing.
  void Set(vtkObject* owner, double index, const Material& material)
  {
    if (!CheckIndex(owner, index))
    {
      return;
    }
    const auto i = static_cast<std::size_t>(index);
    Material& last = this->Materials[i];
    if (!this->Exists[i] || std::memcmp(&last, &material, sizeof(Material)) != 0)
    {
      last = material;
      this->Exists[i] = true;
      owner->Modified();
    }
  }
  void Clear(vtkObject* owner)
  {
    if (this->GetNumber() > 0)
    {
      this->Exists.fill(false);
      owner->Modified();
    }
  }
  void AddRange(vtkObject* owner, double minimum, double maximum, double index)
  {
    if (CheckIndex(owner, index))
    {
      this->Ranges.push_back({ minimum, maximum, static_cast<int>(index) });
      owner->Modified();
    }
  }
  void ClearRanges(vtkObject* owner)
  {
    if (!this->Ranges.empty())
    {
      this->Ranges.clear();
      owner->Modified();
    }
  }
  ///@}

  /// The material of an index; null if it is not defined.
  const Material* Find(int index) const
  {
    return IsMaterialIndex(index) && this->Exists[static_cast<std::size_t>(index)]
      ? &this->Materials[static_cast<std::size_t>(index)]
      : nullptr;
  }
  /// The material of an index. Throws an Error if it is not defined. who: the name of the property
  /// with this index, for the message.
  const Material& Get(int index, const std::string& who) const
  {
    const Material* material = this->Find(index);
    if (!material)
    {
      throw Error(
        who + " " + std::to_string(index) + " is not defined. Define it with SetMaterial().");
    }
    return *material;
  }
  /// Copies the numbers of a material. Returns false, and copies nothing, if it is not defined.
  bool GetNumbers(int index, double numbers[3]) const
  {
    const Material* material = this->Find(index);
    if (material)
    {
      std::memcpy(numbers, material, sizeof(Material));
    }
    return material != nullptr;
  }

  int GetNumber() const
  {
    return static_cast<int>(std::count(this->Exists.begin(), this->Exists.end(), true));
  }

  void Print(ostream& os, vtkIndent indent) const
  {
    os << indent << "Materials:\n";
    double numbers[3];
    for (int i = 0; i < static_cast<int>(this->Materials.size()); ++i)
    {
      if (this->GetNumbers(i, numbers))
      {
        os << indent.GetNextIndent() << i << ": " << numbers[0] << " " << numbers[1] << " "
           << numbers[2] << "\n";
      }
    }
    os << indent << "MaterialRanges:\n";
    for (const MaterialRange& range : this->Ranges)
    {
      os << indent.GetNextIndent() << range.Minimum << " to " << range.Maximum << ": "
         << range.Index << "\n";
    }
  }

private:
  static bool CheckIndex(vtkObject* owner, double index)
  {
    if (!IsMaterialIndex(index))
    {
      vtkErrorWithObjectMacro(
        owner, << "The material index " << index << " is not valid. Use an integer from 0 to 255.");
      return false;
    }
    return true;
  }
};

} // namespace deformvolume

#endif
