// SPDX-License-Identifier: BSD-3-Clause
#include "WorldDeformation.h"

#include "FieldGeometry.h"
#include "FieldReading.h"
#include "MeshStamp.h"
#include "NodeFaults.h"
#include "PipelineGeometry.h"
#include "PointDifferences.h"
#include "VectorArray.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <algorithm>

namespace deformvolume
{

void WorldDeformation::Read(const DeformationSource& source)
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

bool WorldDeformation::IsCurrent(const Stamp& stamp, const DeformationSource& source) const
{
  return !this->LastStamp.empty() && stamp == this->LastStamp &&
    source.Choice == this->LastChoice && source.DisplacementScale == this->LastScale;
}

void WorldDeformation::Remember(const Stamp& stamp, const DeformationSource& source)
{
  this->LastStamp = stamp;
  this->LastChoice = source.Choice;
  this->LastScale = source.DisplacementScale;
  ++this->Version;
}

void WorldDeformation::ReadMesh(const DeformationSource& source)
{
  const MeshParts& shape = source.ShapeParts;
  const MeshParts& rest = source.GetRestParts();
  this->Mesh.Read(shape, rest, source);
  Stamp stamp = source.Rest ? GetPointsStamp(shape) : GetPointVectorsStamp(shape);
  const Stamp restStamp = GetPointsStamp(rest);
  stamp.insert(stamp.end(), restStamp.begin(), restStamp.end());
  stamp.emplace_back(nullptr, source.Rest ? 1 : 0);
  stamp.emplace_back(nullptr, static_cast<vtkMTimeType>(this->Mesh.GetConnectivityVersion()));
  if (!this->HasField && this->IsCurrent(stamp, source))
  {
    return;
  }
  this->LastStamp.clear();
  this->HasField = false;
  const std::size_t nodes = GetNumberOfNodes(shape);
  const DerivedNodes& derived = this->Mesh.GetDerivedNodes();
  this->Displacements.resize(nodes + derived.GetCount());
  NodeFaults faults;
  faults.Resize(nodes);
  const double factor = source.Rest ? 1.0 : source.DisplacementScale;
  const VectorTaker take = [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
  {
    std::transform(vectors, vectors + count, this->Displacements.begin() + first,
      [factor](const glm::dvec3& vector) { return factor * vector; });
  };
  const std::vector<Tetrahedron>& tetrahedra = this->Mesh.GetTetrahedra();
  if (source.Rest)
  {
    std::vector<VectorMemory> memories;
    ReadPointDifferences(shape, rest, take, memories, faults);
    CheckPoints(shape, MESH_NAME, faults, tetrahedra);
  }
  else
  {
    ReadPointVectors(shape, source.Selector, faults, take);
    CheckPointVectors(shape, source.Selector, source.Wanted, MESH_NAME, faults, tetrahedra);
  }
  for (std::size_t i = 0; i < derived.GetCount(); ++i)
  {
    this->Displacements[nodes + i] = derived.Sum(
      i, [&](std::int32_t node) { return this->Displacements[static_cast<std::size_t>(node)]; });
  }
  this->Remember(stamp, source);
}

void WorldDeformation::ReadField(vtkImageData* image, const DeformationSource& source)
{
  vtkDataArray* array = FindFieldVectors(image, source);
  const float* floats = FindFloats(array);
  Stamp stamp{ { image, image->GetMTime() } };
  AddArray(stamp, array);
  AddMasks(stamp, image);
  if (this->HasField && this->IsCurrent(stamp, source))
  {
    return;
  }
  this->LastStamp.clear();
  this->HasField = true;
  this->Array = array;
  this->Undefined = FindHiddenPoints(image);
  this->Converted.clear();
  this->Converted.resize(floats ? 0 : static_cast<std::size_t>(array->GetNumberOfValues()));
  // All vectors are read even if they are not copied: those that are not finite are an error.
  ReadFieldVectors(array, this->Undefined,
    [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
    {
      for (vtkIdType i = 0; i < count && !floats; ++i)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          this->Converted[static_cast<std::size_t>(3 * (first + i) + axis)] = vectors[i][axis];
        }
      }
    });
  this->Field = MakeWorldField(GetGeometry(image));
  const auto count = static_cast<std::size_t>(array->GetNumberOfTuples());
  this->Field.Vectors = { this->Converted.data(), true, count };
  if (floats)
  {
    this->Field.Vectors = { floats, false, count };
  }
  this->Field.Scale = source.DisplacementScale;
  this->Field.Undefined = this->Undefined.empty() ? nullptr : this->Undefined.data();
  this->Remember(stamp, source);
}

} // namespace deformvolume
