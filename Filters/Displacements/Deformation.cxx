// SPDX-License-Identifier: BSD-3-Clause
#include "Deformation.h"

#include "Error.h"
#include "PointDifferences.h"
#include "VectorArray.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkUnstructuredGrid.h"

namespace deformvolume
{

glm::dmat3 GetToDisplacement(const DeformationSource& source)
{
  return GetToDisplacement(
    source.Volume, source.ToOutput, source.Rest ? 1.0 : source.DisplacementScale);
}

void Deformation::Read(const DeformationSource& source)
{
  CheckSource(source);
  if (const auto image = vtkImageData::SafeDownCast(source.Shape))
  {
    this->ReadField(image, source);
  }
  else
  {
    this->ReadMesh(source);
  }
}

void Deformation::ReadMesh(const DeformationSource& source)
{
  const MeshParts& shape = source.ShapeParts;
  const MeshParts& rest = source.GetRestParts();
  this->Mesh.Read(shape, rest, source);
  if (this->ConnectivityOfVectors != this->Mesh.GetConnectivityVersion())
  {
    this->ConnectivityOfVectors = this->Mesh.GetConnectivityVersion();
    ++this->VectorsVersion;
    if (this->Faults.MayHaveAny() || this->Mesh.GetDerivedNodes().GetCount() > 0)
    {
      this->VectorsStamp.clear(); // tetrahedra may now use faulty vectors, or derived nodes may
                                  // depend on other nodes
    }
  }

  Stamp stamp = source.Rest ? GetPointsStamp(shape) : GetPointVectorsStamp(shape);
  if (source.Rest)
  {
    const Stamp restStamp = GetPointsStamp(rest);
    stamp.insert(stamp.end(), restStamp.begin(), restStamp.end());
  }
  // Stamps of displacements from points and from vectors must differ.
  const bool ofPoints = source.Rest != nullptr;
  stamp.emplace_back(nullptr, ofPoints ? 1 : 0);
  if (this->VectorsAreCurrent(stamp, source, false))
  {
    return;
  }
  const DerivedNodes& derived = this->Mesh.GetDerivedNodes();
  // Displacements of derived nodes are computed on the host.
  vtkDataArray* only = !ofPoints && shape.size() == 1 && derived.GetCount() == 0
    ? source.Selector(shape.front())
    : nullptr;
  if (this->UseVectorsOnDevice(only, shape.front()->GetNumberOfPoints(), source))
  {
    this->RememberVectors(stamp, source, false);
    return;
  }
  if (this->MemoriesAreOfPoints != ofPoints || (ofPoints && !this->Mesh.HasKeptPoints()))
  {
    this->Memories.clear();
  }
  this->MemoriesAreOfPoints = ofPoints;
  ++this->VectorsVersion;
  this->ReplaceVectors(
    GetNumberOfNodes(shape),
    [&](const VectorTaker& take)
    {
      if (ofPoints)
      {
        ReadPointDifferences(shape, rest, take, this->Memories, this->Faults);
      }
      else
      {
        ReadPointVectors(shape, source.Selector, this->Faults, take, &this->Memories);
      }
      this->CheckFaults(shape, source);
    },
    source, &derived);
  this->RememberVectors(stamp, source, false);
}

void Deformation::CheckFaults(const MeshParts& shape, const DeformationSource& source) const
{
  const std::vector<Tetrahedron>& tetrahedra = this->Mesh.GetTetrahedra();
  const vtkIdType node = this->Faults.FindUsed(tetrahedra);
  if (node >= 0 && this->Faults.Get(node) == NodeFaults::TooFar)
  {
    ThrowTooFar();
  }
  if (source.Rest)
  {
    CheckPoints(shape, MESH_NAME, this->Faults, tetrahedra);
    return;
  }
  CheckPointVectors(shape, source.Selector, source.Wanted, MESH_NAME, this->Faults, tetrahedra);
}

bool Deformation::VectorsAreCurrent(
  const Stamp& stamp, const DeformationSource& source, bool field) const
{
  return this->Field == field && stamp == this->VectorsStamp &&
    source.Choice == this->VectorsSource.Choice && source.Device == this->VectorsSource.Device &&
    this->HasSameUnits(source);
}

bool Deformation::HasSameUnits(const DeformationSource& source) const
{
  const DeformationSource& last = this->VectorsSource;
  return source.DisplacementScale == last.DisplacementScale && source.Volume == last.Volume &&
    source.ToOutput == last.ToOutput;
}

PointRanges Deformation::GetChanges(std::uint64_t version) const
{
  if (!this->FieldInPlace.Owner)
  {
    return IndexDeformation::GetChanges(version);
  }
  if (version == this->VectorsVersion)
  {
    return {};
  }
  return version == this->VersionBeforeChanges
    ? this->ChangesInPlace
    : PointRanges{ { { 0, static_cast<std::size_t>(GetNumberOfPoints(this->FieldInPlace)) } } };
}

void Deformation::ReplaceVectors(std::size_t count, const VectorSource& read,
  const DeformationSource& source, const DerivedNodes* derived)
{
  // If a call below throws, the vectors belong to no source.
  this->VectorsStamp.clear();
  this->FieldInPlace = DisplacementField();
  if (!this->VectorsAreWhole || !this->HasSameUnits(source))
  {
    this->Memories.clear();
  }
  this->SetDisplacements(count, read, GetToDisplacement(source), derived);
}

void Deformation::RememberVectors(const Stamp& stamp, const DeformationSource& source, bool field)
{
  this->Field = field;
  this->Inverse = source.FieldIsInverse;
  this->VectorsStamp = stamp;
  this->VectorsSource = source;
  // The source is only compared later. Do not keep pointers and functions.
  this->VectorsSource.Shape = nullptr;
  this->VectorsSource.Rest = nullptr;
  this->VectorsSource.ShapeParts.clear();
  this->VectorsSource.RestParts.clear();
  this->VectorsSource.Derived = nullptr;
  this->VectorsSource.Selector = nullptr;
}

} // namespace deformvolume
