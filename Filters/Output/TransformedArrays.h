// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTransformedArrays_h
#define DeformVolumeTransformedArrays_h

#include "PointMap.h"
#include "VectorArray.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <vector>

class vtkDataArray;
class vtkPointSet;

namespace deformvolume
{

/// A point array of vectors or normals that follows the points.
struct TransformedArray
{
  VectorCopier CopySource;
  int Attribute; // -1: none
  vtkSmartPointer<vtkDataArray> Output;

  /// Writes the tuples of the points from `first` on, one for each image. May be called by several
  /// threads.
  void Transform(vtkIdType first, const std::vector<PointMap::Image>& images) const;
};

/// The point arrays that are transformed: the active normals and vectors, and with allVectors all
/// others of three floats or doubles that have a name, except for texture coordinates. Throws an
/// Error if the number of tuples of an array is not the number of points.
std::vector<TransformedArray> FindTransformed(vtkPointSet* points, bool allVectors);

/// Makes an array of vectors with the name of another array: of floats if that one is, else of
/// doubles.
vtkSmartPointer<vtkDataArray> MakeVectors(vtkDataArray* like, vtkIdType count);

} // namespace deformvolume

#endif
