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

/// Whether positions are to be exact in floating-point numbers: spacings are powers of two, and
/// nothing is rotated.
enum class Geometry
{
  Any,
  Exact
};

/// A small volume, or a large one of several bricks: its extent, origin, spacing, direction and
/// arrays; perhaps masks. Now and then one that no filter can take.
vtkSmartPointer<vtkImageData> MakeVolume(
  Random& random, Geometry geometry, bool isLarge, std::ostream& log);

/// Replaces the point arrays. The types come from a short list of sets of arrays, since each new
/// combination of types costs a compilation of kernels.
void FillArrays(vtkImageData* volume, Random& random, std::ostream& log);

/// Sets or changes vtkGhostType of points or cells, ActiveTetrahedra, BoundaryDistance or a
/// smooth cut: in large volumes at a few places, and no cut, which takes long there.
void EditMasks(vtkImageData* volume, Random& random, std::ostream& log);

/// Changes values, geometry, arrays or masks.
void EditVolume(vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

} // namespace fuzz

#endif
