// SPDX-License-Identifier: BSD-3-Clause
// Pictures of render windows, and their comparison.
#ifndef PictureTesting_h
#define PictureTesting_h

#include "FilterTesting.h"

#include <vtkRenderWindow.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

namespace pictureTesting
{

using namespace filterTesting;

inline vtkSmartPointer<vtkImageData> Draw(vtkRenderWindow* window)
{
  window->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->SetInputBufferTypeToRGB();
  grab->ReadFrontBufferOff();
  grab->Update();
  return grab->GetOutput();
}

struct Comparison
{
  /// The mean absolute difference of all bytes; 255 if the pictures cannot be compared.
  double Difference = 255.0;
  /// The differences; null if the pictures cannot be compared.
  vtkSmartPointer<vtkImageData> Image;
};

inline Comparison Compare(vtkImageData* first, vtkImageData* second)
{
  auto* const one = vtkUnsignedCharArray::SafeDownCast(first->GetPointData()->GetScalars());
  auto* const other = vtkUnsignedCharArray::SafeDownCast(second->GetPointData()->GetScalars());
  Comparison comparison;
  if (!one || !other || GetExtent(first) != GetExtent(second) ||
    one->GetNumberOfComponents() != other->GetNumberOfComponents())
  {
    return comparison;
  }
  comparison.Image = vtkSmartPointer<vtkImageData>::New();
  comparison.Image->DeepCopy(first);
  auto* const image =
    static_cast<vtkUnsignedCharArray*>(comparison.Image->GetPointData()->GetScalars());
  double sum = 0.0;
  for (vtkIdType i = 0; i < one->GetNumberOfValues(); ++i)
  {
    const int difference = std::abs(one->GetValue(i) - other->GetValue(i));
    image->SetValue(i, static_cast<unsigned char>(difference));
    sum += difference;
  }
  comparison.Difference = sum / static_cast<double>(one->GetNumberOfValues());
  return comparison;
}

} // namespace pictureTesting

#endif
