// SPDX-License-Identifier: BSD-3-Clause
// Draws a scene in its versions and compares them with the baseline.
#include "SceneTesting.h"

#include <vtkPNGReader.h>
#include <vtkPNGWriter.h>
#include <vtkRendererCollection.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>

namespace sceneTesting
{

namespace
{

constexpr int PictureSize = 300;

vtkSmartPointer<vtkImageData> DrawPicture(const Scene& scene, Version version)
{
  vtkNew<vtkRenderWindow> window;
  window->SetSize(PictureSize, PictureSize);
  window->SetMultiSamples(0);
  scene.DrawScene(window, version);
  vtkCollectionSimpleIterator renderers;
  window->GetRenderers()->InitTraversal(renderers);
  while (vtkRenderer* renderer = window->GetRenderers()->GetNextRenderer(renderers))
  {
    renderer->ResetCameraClippingRange();
  }
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
  double Difference = 255.0; // that of pictures that cannot be compared
  vtkSmartPointer<vtkImageData> Image;
};

Comparison Compare(vtkImageData* first, vtkImageData* second)
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

bool Write(vtkImageData* image, const std::string& fileName)
{
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(fileName.c_str());
  writer->SetInputData(image);
  writer->SetCompressionLevel(9);
  writer->Write();
  return writer->GetErrorCode() == 0;
}

} // namespace

bool Test(const Scene& scene, const std::string& baselines, const std::string& output)
{
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName((baselines + '/' + scene.Name + ".png").c_str());
  reader->Update();
  bool passes = true;
  const auto check = [&](Version version, const char* name, const char* words)
  {
    const auto picture = DrawPicture(scene, version);
    const Comparison comparison = Compare(picture, reader->GetOutput());
    const bool isEqual = comparison.Difference <= scene.Limit;
    // What is spoiled has to be far from the limit.
    const bool isRight =
      version == Version::INTACT ? isEqual : comparison.Difference >= 2.0 * scene.Limit;
    std::cout << scene.Name << ' ' << words << ": difference " << comparison.Difference
              << (isEqual ? ", within" : ", beyond") << " the limit of " << scene.Limit
              << (isRight ? "\n" : ": wrong\n");
    if (!isRight)
    {
      passes = false;
      const std::string file = output + '/' + scene.Name + name;
      Write(picture, file + ".png");
      std::cout << "  the picture: " << file << ".png\n";
      if (comparison.Image)
      {
        Write(comparison.Image, file + ".difference.png");
        std::cout << "  the differences: " << file << ".difference.png\n";
      }
    }
  };
  check(Version::INTACT, "", "as it is");
  check(Version::SPOILED, ".spoiled", "spoiled");
  check(Version::SHIFTED, ".shifted", "shifted by one voxel");
  return passes;
}

bool WriteBaseline(const Scene& scene, const std::string& baselines)
{
  return Write(DrawPicture(scene, Version::INTACT), baselines + '/' + scene.Name + ".png");
}

} // namespace sceneTesting
