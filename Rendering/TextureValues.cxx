// SPDX-License-Identifier: BSD-3-Clause
#include "TextureValues.h"

#include "RangesOfGhosts.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkObjectFactory.h"
#include "vtkWeakPointer.h"

namespace deformvolume
{

namespace
{

template <typename T>
class TextureArray
  : public vtkAOSDataArrayTemplate<T>
  , public TextureValues
{
public:
  static TextureArray* New() { VTK_STANDARD_NEW_BODY(TextureArray<T>); }
  vtkAbstractTemplateTypeMacro(TextureArray<T>, vtkAOSDataArrayTemplate<T>);

  void SetValues(vtkDataArray* values)
  {
    this->Values = values;
    this->SetNumberOfComponents(values->GetNumberOfComponents());
    this->SetVoidArray(nullptr, values->GetNumberOfValues(), 1);
    this->SetName(values->GetName());
  }
  vtkDataArray* GetValues() const override { return this->Values; }
  void SetWithoutValues(bool without) override { this->IsWithoutValues = without; }
  int GetNumberOfRefusals() const override { return this->NumberOfRefusals; }
  int GetNumberOfReads() const override { return this->NumberOfReads; }

  void* GetVoidPointer(vtkIdType value) override
  {
    if (this->IsWithoutValues || !this->Values)
    {
      ++this->NumberOfRefusals;
      return nullptr;
    }
    ++this->NumberOfReads;
    return this->Values->GetVoidPointer(value);
  }

protected:
  TextureArray() = default;
  ~TextureArray() override = default;

#ifdef DEFORMVOLUME_RANGES_OF_GHOSTS
  void ComputeRange(double range[2], int component, const unsigned char* ghosts,
    unsigned char ghostsToSkip = 0xff) override
  {
    Find(range, [&] { this->Values->GetRange(range, component, ghosts, ghostsToSkip); });
  }
  void ComputeFiniteRange(double range[2], int component, const unsigned char* ghosts,
    unsigned char ghostsToSkip = 0xff) override
  {
    Find(range, [&] { this->Values->GetFiniteRange(range, component, ghosts, ghostsToSkip); });
  }
#else
  void ComputeRange(double range[2], int component) override
  {
    Find(range, [&] { this->Values->GetRange(range, component); });
  }
  void ComputeFiniteRange(double range[2], int component) override
  {
    Find(range, [&] { this->Values->GetFiniteRange(range, component); });
  }
#endif

private:
  TextureArray(const TextureArray&) = delete;
  void operator=(const TextureArray&) = delete;

  template <typename Function>
  void Find(double range[2], Function&& function)
  {
    range[0] = VTK_DOUBLE_MAX;
    range[1] = VTK_DOUBLE_MIN;
    if (this->Values)
    {
      function();
    }
  }

  vtkWeakPointer<vtkDataArray> Values;
  bool IsWithoutValues = false;
  int NumberOfRefusals = 0;
  int NumberOfReads = 0;
};

template <typename T>
vtkSmartPointer<vtkDataArray> Make(vtkDataArray* values)
{
  const auto array = vtkSmartPointer<TextureArray<T>>::New();
  array->SetValues(values);
  return array;
}

} // namespace

vtkSmartPointer<vtkDataArray> MakeTextureValues(vtkDataArray* values)
{
  switch (values->GetDataType())
  {
    vtkTemplateMacro(return Make<VTK_TT>(values));
    default:
      return values; // there are no others
  }
}

bool IsTextureType(int type)
{
  return type == VTK_SIGNED_CHAR || type == VTK_UNSIGNED_CHAR || type == VTK_SHORT ||
    type == VTK_UNSIGNED_SHORT || type == VTK_FLOAT;
}

} // namespace deformvolume
