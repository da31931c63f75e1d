// SPDX-License-Identifier: BSD-3-Clause
#include "Deformation.h"

#include "Error.h"
#include "ParallelFor.h"
#include "PointDifferences.h"
#include "VectorArray.h"
#include "VectorConversion.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

namespace deformvolume
{

glm::dmat3 GetToDisplacement(const DeformationSource& source, double factor)
{
  return GetToDisplacement(source.Volume, source.ToOutput, factor);
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
  if (this->UseVectorsOnDevice(
        only, shape.front()->GetNumberOfPoints(), source.DisplacementScale, source))
  {
    this->RememberVectors(stamp, source, false);
    return;
  }
  if (this->MemoriesAreOfPoints != ofPoints || (ofPoints && !this->Mesh.HasKeptPoints()))
  {
    this->Memories.clear();
  }
  this->MemoriesAreOfPoints = ofPoints;
  this->SetVectors(
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
    ofPoints ? 1.0 : source.DisplacementScale, source, &derived);
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
  PointRanges changes;
  if (this->FieldInPlace.Owner && version == this->VectorsVersion)
  {
    return changes;
  }
  if (this->FieldInPlace.Owner && version == this->VersionBeforeChanges)
  {
    return this->ChangesInPlace;
  }
  if (this->FieldInPlace.Owner)
  {
    return { { { 0, static_cast<std::size_t>(GetNumberOfPoints(this->FieldInPlace)) } } };
  }
  const std::size_t count = this->Vectors.size() / 3;
  for (std::size_t block = 0; block < this->BlockVersions.size(); ++block)
  {
    if (this->BlockVersions[block] <= version)
    {
      continue;
    }
    const std::size_t begin = block * PointsPerBlock;
    if (changes.empty() || changes.back()[1] != begin)
    {
      changes.push_back({ { begin, begin } });
    }
    changes.back()[1] = std::min(begin + PointsPerBlock, count);
  }
  return changes;
}

void Deformation::SetVectors(std::size_t count, const VectorSource& read, double factor,
  const DeformationSource& source, const DerivedNodes* derived)
{
  ++this->VectorsVersion;
  this->ReplaceVectors(count, read, factor, source, derived);
}

void Deformation::ResizeVectors(std::size_t count, std::size_t blocks)
{
  if (!this->VectorsAreWhole)
  {
    this->BlockVersions.clear();
  }
  if (this->Vectors.size() != 3 * count)
  {
    // A block with another number of points has changed.
    const std::size_t same = std::min(this->Vectors.size() / 3, count) / PointsPerBlock;
    this->BlockVersions.resize(std::min(this->BlockVersions.size(), same));
    this->Vectors.resize(3 * count);
  }
  this->BlockVersions.resize(blocks, this->VectorsVersion);
}

void Deformation::UpdateDerived(
  const DerivedNodes& derived, std::size_t count, std::vector<std::atomic<bool>>& changed)
{
  std::atomic<bool> tooFar{ false };
  ParallelForParts(derived.GetCount(), PointsPerBlock,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        const glm::vec3 sum(derived.Sum(i,
          [&](std::int32_t node)
          {
            const float* vector = this->Vectors.data() + 3 * static_cast<std::size_t>(node);
            return glm::dvec3(vector[0], vector[1], vector[2]);
          }));
        float* last = this->Vectors.data() + 3 * (count + i);
        if (std::memcmp(last, &sum.x, 3 * sizeof(float)) != 0)
        {
          std::copy_n(&sum.x, 3, last);
          changed[(count + i) / PointsPerBlock].store(true, std::memory_order_relaxed);
        }
        for (int axis = 0; axis < 3; ++axis)
        {
          if (!(std::abs(sum[axis]) <= LargestDisplacement))
          {
            tooFar = true;
          }
        }
      }
    });
  if (tooFar)
  {
    ThrowTooFar();
  }
}

void Deformation::ReplaceVectors(std::size_t count, const VectorSource& read, double factor,
  const DeformationSource& source, const DerivedNodes* derived)
{
  // If a call below throws, the vectors belong to no source.
  this->VectorsStamp.clear();
  this->FieldInPlace = DisplacementField();
  const std::uint64_t version = this->VectorsVersion;
  const std::size_t all = count + (derived ? derived->GetCount() : 0);
  const std::size_t blocks = (all + PointsPerBlock - 1) / PointsPerBlock;
  if (!this->VectorsAreWhole || !this->HasSameUnits(source))
  {
    this->Memories.clear();
  }
  this->ResizeVectors(all, blocks);
  this->VectorsAreWhole = false;
  const glm::dmat3 toDisplacement = GetToDisplacement(source, factor);
  std::vector<std::atomic<bool>> changed(blocks);
  this->Faults.Resize(count);
  read(
    [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType number)
    {
      this->Faults.Clear(first, number);
      std::array<float, 3 * PointsPerBlock> displacements;
      auto point = static_cast<std::size_t>(first);
      const std::size_t end = point + static_cast<std::size_t>(number);
      while (point < end)
      {
        const std::size_t block = point / PointsPerBlock;
        const std::size_t some = std::min(end, (block + 1) * PointsPerBlock) - point;
        const bool areNear = ConvertVectors(toDisplacement, vectors, some, displacements.data());
        for (std::size_t i = 0; i < some && !areNear; ++i)
        {
          if (!ConvertVectors(toDisplacement, vectors + i, 1, &displacements[3 * i]))
          {
            std::fill_n(&displacements[3 * i], 3, 0.0F);
            this->Faults.Mark(static_cast<vtkIdType>(point + i), NodeFaults::TooFar);
          }
        }
        float* last = this->Vectors.data() + 3 * point;
        if (std::memcmp(last, displacements.data(), 3 * some * sizeof(float)) != 0)
        {
          std::copy_n(displacements.begin(), 3 * some, last);
          changed[block].store(true, std::memory_order_relaxed);
        }
        vectors += some;
        point += some;
      }
    });
  if (all > count)
  {
    this->UpdateDerived(*derived, count, changed);
  }
  for (std::size_t block = 0; block < blocks; ++block)
  {
    if (changed[block])
    {
      this->BlockVersions[block] = version;
    }
  }
  this->VectorsAreWhole = true;
}

void Deformation::RememberVectors(const Stamp& stamp, const DeformationSource& source, bool field)
{
  this->Field = field;
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
