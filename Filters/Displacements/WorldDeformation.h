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

/// A deformation in world coordinates and double precision. Keeps what it has read, and reads again
/// only what changed.
class WorldDeformation
{
public:
  /// Throws an Error where the source cannot be used. Its volume and output are those by default.
  void Read(const DeformationSource& source);

  bool IsField() const { return this->Field; }
  /// Changes with all that follows.
  std::uint64_t GetVersion() const { return this->Version; }
  const RestMesh& GetRestMesh() const { return this->Mesh; }
  /// Of the nodes of the mesh.
  const std::vector<glm::dvec3>& GetDisplacements() const { return this->Displacements; }
  /// It points into this object, and into the array that was read.
  const WorldField& GetField() const { return this->Vectors; }

private:
  void ReadMesh(const DeformationSource& source);
  void ReadField(vtkImageData* image, const DeformationSource& source);
  /// Whether the last vectors were read from this, and with this choice.
  bool IsCurrent(const Stamp& stamp, const DeformationSource& source) const;
  void Remember(const Stamp& stamp, const DeformationSource& source);

  bool Field = false;
  std::uint64_t Version = 0;
  RestMesh Mesh;
  std::vector<glm::dvec3> Displacements;
  WorldField Vectors;
  vtkSmartPointer<vtkDataArray> Array; // that of the field
  std::vector<double> Converted;       // its values, where they are not floats one after the other
  std::vector<unsigned char> Undefined;

  // What the above was read from; empty where that failed.
  Stamp LastStamp;
  std::string LastChoice;
  double LastScale = 1.0;
};

} // namespace deformvolume

#endif
