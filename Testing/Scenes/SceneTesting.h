// SPDX-License-Identifier: BSD-3-Clause
// Scenes: functions that draw pictures and compare them with baselines.
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

/// Versions of a scene. INTACT must equal the baseline, and the other versions must differ from it.
/// SPOILED has an error that the scene is designed to detect. In SHIFTED all displacements are one
/// voxel longer along x.
enum class Version
{
  INTACT,
  SPOILED,
  SHIFTED
};

/// Draws a scene in a window of 300 x 300 pixels.
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
/// the limit, and the other versions differ by twice the limit or more. Pictures that fail are
/// written to the folder of output.
bool Test(const Scene& scene, const std::string& baselines, const std::string& output);

/// Writes the picture of INTACT as the baseline.
bool WriteBaseline(const Scene& scene, const std::string& baselines);

/// Adds a point array as AddScalars() does, and keeps the other arrays.
template <typename T>
void AddValues(vtkImageData* image, const char* name, const WorldFunction& function)
{
  image->GetPointData()->SetActiveScalars(nullptr); // otherwise SetScalars() removes that array
  AddScalars<T>(image, name, function);
}

/// Returns a deformation. With SHIFTED, its active vectors are one voxel longer along x.
vtkSmartPointer<vtkDataSet> Shifted(vtkDataSet* deformation, Version version);

/// Adds a renderer in one of several columns of the window, with a parallel projection. center: the
/// point in the middle; the other arguments: the height of the window in world units, and the
/// direction of view. z is up unless it is the direction of view.
vtkRenderer* AddRenderer(vtkRenderWindow* window, const glm::dvec3& center,
  const glm::dvec3& direction, double height, int column = 0, int columns = 1);

/// Returns a table of colors at equal steps over a range of values. Values below it are
/// transparent.
vtkSmartPointer<vtkLookupTable> MakeColors(
  double lowest, double highest, const std::vector<glm::dvec3>& colors, int number = 256);

/// Draws the slice z = 0 of an array, seen from above. Values below the range are not drawn.
void AddSlice(
  vtkRenderer* renderer, vtkImageData* volume, const char* array, vtkLookupTable* colors);

/// Draws the isosurface of a volume at 50. An array of the volume colors it; without an array it
/// has one color.
void AddSurface(vtkRenderer* renderer, vtkAlgorithmOutput* volume, const char* array = nullptr,
  vtkLookupTable* colors = nullptr);

/// Sets a fine output spacing, and a padding in which isosurfaces are closed.
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
