// SPDX-License-Identifier: BSD-3-Clause
// Draws a scene in its versions and compares them with the baseline.
#include "SceneTesting.h"

#include <vtkPNGReader.h>
#include <vtkPNGWriter.h>
#include <vtkRendererCollection.h>

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
  return Draw(window);
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
    // SPOILED and SHIFTED must differ by at least twice the limit.
    const bool isRight =
      version == Version::INTACT ? isEqual : comparison.Difference >= 2.0 * scene.Limit;
    std::cout << (isRight ? "" : "FAILED: ") << scene.Name << ' ' << words
              << ": the difference from the baseline is " << comparison.Difference << ", must be "
              << (version == Version::INTACT ? "at most " : "at least ")
              << (version == Version::INTACT ? 1.0 : 2.0) * scene.Limit << "\n";
    const std::string file = output + '/' + scene.Name + name;
    if (version == Version::INTACT || !isRight)
    {
      Write(picture, file + ".png");
      std::cout << "  the picture: " << file << ".png\n";
    }
    if (!isRight)
    {
      passes = false;
      if (comparison.Image)
      {
        Write(comparison.Image, file + ".difference.png");
        std::cout << "  the differences: " << file << ".difference.png\n";
      }
    }
  };
  check(Version::INTACT, "", "intact");
  check(Version::SPOILED, ".spoiled", "spoiled");
  check(Version::SHIFTED, ".shifted", "shifted by one voxel");
  return passes;
}

bool WriteBaseline(const Scene& scene, const std::string& baselines)
{
  return Write(DrawPicture(scene, Version::INTACT), baselines + '/' + scene.Name + ".png");
}

} // namespace sceneTesting
