// SPDX-License-Identifier: BSD-3-Clause
// Pictures that are compared with a baseline: how a scene is drawn, compared and spoiled.
//
// All volumes have a spacing of 1 in world units.
#ifndef SceneTesting_h
#define SceneTesting_h

#include "PictureTesting.h"

#include <vtkRenderer.h>

#include <glm/vec3.hpp>

#include <vector>

class vtkAlgorithmOutput;
class vtkLookupTable;

namespace sceneTesting
{

using namespace pictureTesting;

/// Variants of a scene. INTACT is compared with the baseline. The others have to differ from it:
/// SPOILED is the picture of an error that the scene should find. In SHIFTED all displacements are
/// one voxel longer along x.
enum class Version
{
  INTACT,
  SPOILED,
  SHIFTED
};

/// Adds what a scene shows to a window of 300 x 300 pixels.
using AddScene = void (*)(vtkRenderWindow* window, Version version);

struct Scene
{
  const char* Name;
  /// Limit of the mean absolute difference of all bytes of two pictures, 0 to 255: at most half of
  /// the smaller difference of SPOILED and SHIFTED, far above the difference of two OpenGL drivers.
  double Limit;
  AddScene DrawScene;
};

/// Compares all versions of a scene with <baselines>/<Name>.png. Returns whether INTACT is within
/// the limit, and the others differ by twice the limit or more. Pictures that fail go to the folder
/// of output.
bool Test(const Scene& scene, const std::string& baselines, const std::string& output);

/// Writes the picture of INTACT as the baseline.
bool WriteBaseline(const Scene& scene, const std::string& baselines);

/// Adds a point array as AddScalars() does, and keeps the other arrays.
template <typename T>
void AddValues(vtkImageData* image, const char* name, const WorldFunction& function)
{
  image->GetPointData()->SetActiveScalars(nullptr); // or else SetScalars() removes them
  AddScalars<T>(image, name, function);
}

/// A deformation. SHIFTED adds one voxel along x to its active vectors.
vtkSmartPointer<vtkDataSet> Shifted(vtkDataSet* deformation, Version version);

/// A renderer in one of several columns of the window, with a parallel projection: the window shows
/// so many units from bottom to top, with the centre in its middle, seen from a direction. z is up
/// unless that is the direction.
vtkRenderer* AddRenderer(vtkRenderWindow* window, const glm::dvec3& center,
  const glm::dvec3& direction, double height, int column = 0, int columns = 1);

/// Colours in even steps over a range of values, and nothing below it.
vtkSmartPointer<vtkLookupTable> MakeColours(
  double lowest, double highest, const std::vector<glm::dvec3>& colours, int number = 256);

/// The slice z = 0 of an array, seen from above. Values below the range are not drawn.
void AddSlice(
  vtkRenderer* renderer, vtkImageData* volume, const char* array, vtkLookupTable* colours);

/// The surface where the active scalars of a volume are 50. It is coloured by an array of the
/// volume, or without one it is plain.
void AddSurface(vtkRenderer* renderer, vtkAlgorithmOutput* volume, const char* array = nullptr,
  vtkLookupTable* colours = nullptr);

/// Draws a deformed volume finely, with a border that surfaces close in.
void SetSampling(vtkDeformVolumeFilter* filter, double spacing, double background = 0.0);

void DrawVolumeRendering(vtkRenderWindow* window, Version version);
void DrawIsosurface(vtkRenderWindow* window, Version version);
void DrawSlice(vtkRenderWindow* window, Version version);
void DrawLabels(vtkRenderWindow* window, Version version);
void DrawFold(vtkRenderWindow* window, Version version);
void DrawHardCut(vtkRenderWindow* window, Version version);
void DrawSmoothCut(vtkRenderWindow* window, Version version);
void DrawSmoothBoundary(vtkRenderWindow* window, Version version);
void DrawSplit(vtkRenderWindow* window, Version version);
void DrawChainMail(vtkRenderWindow* window, Version version);
void DrawFiniteElements(vtkRenderWindow* window, Version version);

} // namespace sceneTesting

#endif
