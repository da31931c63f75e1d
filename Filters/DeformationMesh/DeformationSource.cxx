// SPDX-License-Identifier: BSD-3-Clause
#include "DeformationSource.h"

#include "Error.h"

#include "vtkImageData.h"

namespace deformvolume
{

void CheckSource(const DeformationSource& source)
{
  const bool isField = vtkImageData::SafeDownCast(source.Shape) != nullptr;
  if (source.PointsAreDeformed && (isField || source.Rest))
  {
    throw Error(std::string("PointsAreDeformed is on, but ") +
      (isField ? "the deformation is a displacement field, whose points are at rest"
               : "there is a mesh at rest, so that no displacements are read") +
      ". Set PointsAreDeformed off" + (isField ? "." : ", or disconnect the mesh at rest."));
  }
  if (isField && source.Rest)
  {
    throw Error("There is a mesh at rest, but the deformation is a displacement field, "
                "which needs none. Disconnect the mesh at rest.");
  }
  if (isField)
  {
    return;
  }
  const MeshParts& shape = source.ShapeParts;
  const MeshParts& rest = source.GetRestParts();
  CheckParts(shape, source.Shape, MESH_NAME);
  if (source.Rest)
  {
    CheckParts(rest, source.Rest, REST_NAME);
  }
  if (GetNumberOfNodes(shape) != GetNumberOfNodes(rest))
  {
    throw Error("The deformation mesh has " + std::to_string(GetNumberOfNodes(shape)) +
      " points and the mesh at rest has " + std::to_string(GetNumberOfNodes(rest)) +
      ". Use one mesh, at rest and deformed.");
  }
}

} // namespace deformvolume
