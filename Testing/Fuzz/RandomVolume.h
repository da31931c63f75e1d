// SPDX-License-Identifier: BSD-3-Clause
// Random volumes, and edits of them.
#ifndef Fuzz_RandomVolume_h
#define Fuzz_RandomVolume_h

#include "Random.h"

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <ostream>

namespace fuzz
{

/// With Exact, positions are exact in floating-point numbers: spacings are powers of two, and axes
/// are not rotated.
enum class Geometry
{
  Any,
  Exact
};

/// Returns a small volume, or a large one of several bricks, with a random extent, origin, spacing
/// and direction, random arrays, and sometimes masks. Rarely the volume is an error.
vtkSmartPointer<vtkImageData> MakeVolume(
  Random& random, Geometry geometry, bool isLarge, std::ostream& log);

/// Replaces the point arrays. The types come from a short list of sets of arrays, because kernels
/// are compiled for each new combination of types.
void FillArrays(vtkImageData* volume, Random& random, std::ostream& log);

/// Sets or changes vtkGhostType of points or cells, ActiveTetrahedra, BoundaryDistance or a
/// smooth cut. In large volumes only a few voxels or cells change, and there are no smooth cuts,
/// because these take long.
void EditMasks(vtkImageData* volume, Random& random, std::ostream& log);

/// Changes values, geometry, arrays or masks.
void EditVolume(vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

} // namespace fuzz

#endif
