// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldDeformation_h
#define DeformVolumeWorldDeformation_h

#include "Deformation.h"
#include "DeformationMesh.h"
#include "FieldPointMap.h"
#include "RestMesh.h"

#include "vtkSmartPointer.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

/// A deformation in world coordinates and double precision. Only data that have changed are read
/// again.
class WorldDeformation
{
public:
  /// Reads a source, whose Volume and ToOutput have their default values. Throws an Error if it
  /// cannot be used.
  void Read(const DeformationSource& source);

  bool IsField() const { return this->HasField; }
  /// Changes if one of the results below changes.
  std::uint64_t GetVersion() const { return this->Version; }
  const RestMesh& GetRestMesh() const { return this->Mesh; }
  /// Displacements of the nodes of the mesh.
  const std::vector<glm::dvec3>& GetDisplacements() const { return this->Displacements; }
  /// The field points into this object, and into the array that was read.
  const WorldField& GetField() const { return this->Field; }

private:
  void ReadMesh(const DeformationSource& source);
  void ReadField(vtkImageData* image, const DeformationSource& source);
  /// Whether the last vectors were read from the same arrays with the same choice and scale.
  bool IsCurrent(const Stamp& stamp, const DeformationSource& source) const;
  void Remember(const Stamp& stamp, const DeformationSource& source);

  bool HasField = false;
  std::uint64_t Version = 0;
  RestMesh Mesh;
  std::vector<glm::dvec3> Displacements;
  WorldField Field;
  vtkSmartPointer<vtkDataArray> Array; // the vectors of the field
  std::vector<double> Converted; // values of Array, if it is not an array of structs of floats
  std::vector<unsigned char> Undefined;

  // The inputs that the members above were read from. LastStamp is empty if the reading failed.
  Stamp LastStamp;
  std::string LastChoice;
  double LastScale = 1.0;
};

} // namespace deformvolume

#endif
