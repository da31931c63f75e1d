// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformation_h
#define DeformVolumeDeformation_h

#include "DeformationMesh.h"
#include "ImageGeometry.h"
#include "VectorArray.h"
#include "VolumeDeformer.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

class vtkImageData;

namespace deformvolume
{

/// Where a deformation comes from, and where it is wanted.
struct DeformationSource
{
  /// What is connected to port 1, and to port 2 or null.
  vtkDataObject* Shape = nullptr;
  vtkDataObject* Rest = nullptr;
  /// Finds the displacements; Wanted names them in words, Choice tells two choices apart.
  ArraySelector Selector;
  std::string Wanted;
  std::string Choice;
  double DisplacementScale = 1.0;
  ImageGeometry Volume;
  /// Output voxels per voxel of the volume, axis by axis.
  glm::dvec3 Scale{ 1.0 };
};

/// The deformation in the units of the kernels. Keeps what it has read, and reads again only what
/// changed; versions tell what did. Content decides: a mesh that is another object with the same
/// cells and rest positions leaves the rest version as it is.
class Deformation
{
public:
  /// Throws an Error where the source cannot be used.
  void Read(const DeformationSource& source);

  bool IsField() const { return this->Field; }

  ///@{
  /// A mesh: its tetrahedra, its nodes at rest in continuous indices of the volume, and their
  /// displacements in output voxels.
  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Tetrahedra; }
  const std::vector<glm::dvec3>& GetRestPoints() const { return this->RestPoints; }
  const float* GetNodeDisplacements() const { return this->Vectors.data(); }
  ///@}

  /// A field.
  DisplacementField GetField(bool extrapolate) const;

  /// Changes with the tetrahedra and the rest positions.
  std::uint64_t GetRestVersion() const { return this->RestVersion; }
  /// Changes with the displacements and with the kind of the deformation.
  std::uint64_t GetVectorsVersion() const { return this->VectorsVersion; }

  /// What changed of the displacements after a version of them: blocks of points, some of which may
  /// be as they were.
  PointRanges GetChanges(std::uint64_t version) const;

  /// Cells that were ignored, in words for a warning; "" without such.
  const std::string& GetIgnoredCells() const { return this->IgnoredCells; }

private:
  void ReadMesh(const DeformationSource& source);
  void ReadTetrahedra(const MeshParts& shape, const MeshParts& rest);
  void ReadRestPoints(const MeshParts& rest, const DeformationSource& source);
  void ReadField(vtkImageData* image, const DeformationSource& source);
  bool VectorsAreCurrent(const Stamp& stamp, const DeformationSource& source, bool field) const;
  /// Whether equal vectors are equal displacements, now and when they were read last.
  bool HasSameUnits(const DeformationSource& source) const;
  /// read: calls its argument for all displacements in world units, of which there are count.
  void SetVectors(std::size_t count, const std::function<void(const VectorTaker&)>& read,
    double factor, const DeformationSource& source);

  bool Field = false;
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<glm::dvec3> RestPoints;
  std::vector<float> Vectors;
  static constexpr std::size_t PointsPerBlock = 512;
  std::vector<std::uint64_t> BlockVersions; // that with which each block of the vectors came
  bool VectorsAreWhole = false;             // else the last reading of them failed
  std::array<int, 3> FieldDimensions{ { 0, 0, 0 } };
  std::array<double, 12> IndexToField{};
  std::string IgnoredCells;
  std::uint64_t RestVersion = 0;
  std::uint64_t VectorsVersion = 0;

  // What the above was read from.
  Stamp CellsStamp;
  Stamp RestStamp;
  ImageGeometry RestVolume;
  Stamp VectorsStamp;
  DeformationSource VectorsSource;
  std::vector<VectorMemory> Memories; // of each part of a mesh
};

} // namespace deformvolume

#endif
