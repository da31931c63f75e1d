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

  void ComputeRange(double range[2], int component) override
  {
    if (this->Values)
    {
      this->Values->GetRange(range, component);
    }
  }
  void ComputeFiniteRange(double range[2], int component) override
  {
    if (this->Values)
    {
      this->Values->GetFiniteRange(range, component);
    }
  }
#ifdef DEFORMVOLUME_RANGES_OF_GHOSTS
  void ComputeRange(double range[2], int component, const unsigned char* ghosts,
    unsigned char ghostsToSkip = 0xff) override
  {
    if (this->Values)
    {
      this->Values->GetRange(range, component, ghosts, ghostsToSkip);
    }
  }
  void ComputeFiniteRange(double range[2], int component, const unsigned char* ghosts,
    unsigned char ghostsToSkip = 0xff) override
  {
    if (this->Values)
    {
      this->Values->GetFiniteRange(range, component, ghosts, ghostsToSkip);
    }
  }
#endif

private:
  TextureArray(const TextureArray&) = delete;
  void operator=(const TextureArray&) = delete;

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
    case VTK_SIGNED_CHAR:
      return Make<signed char>(values);
    case VTK_UNSIGNED_CHAR:
      return Make<unsigned char>(values);
    case VTK_SHORT:
      return Make<short>(values);
    case VTK_UNSIGNED_SHORT:
      return Make<unsigned short>(values);
    case VTK_FLOAT:
      return Make<float>(values);
    default:
      return nullptr; // the mapper makes floats of these, on the host
  }
}

} // namespace deformvolume
