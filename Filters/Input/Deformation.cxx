// SPDX-License-Identifier: BSD-3-Clause
#include "Deformation.h"

#include "Error.h"
#include "MeshCells.h"
#include "ParallelFor.h"
#include "VectorArray.h"
#include "VectorComponents.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <utility>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace deformvolume
{

namespace
{

// What is to be added to the points of one mesh to have those of another, part by part. memories:
// of the last reading, from the same points.
void ReadPointDifferences(const MeshParts& shape, const MeshParts& rest, const VectorTaker& take,
  std::vector<VectorMemory>& memories)
{
  const std::vector<glm::dvec3> starts = ReadPoints(rest, REST_NAME);
  memories.resize(shape.size());
  vtkIdType next = 0;
  for (std::size_t part = 0; part < shape.size(); ++part)
  {
    const vtkIdType count = shape[part]->GetNumberOfPoints();
    if (count == 0 || memories[part].Place != next)
    {
      memories[part] = VectorMemory();
      memories[part].Place = next;
    }
    if (count > 0)
    {
      ReadVectors(
        shape[part]->GetPoints()->GetData(),
        [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType some)
        {
          std::vector<glm::dvec3> moves(vectors, vectors + some);
          for (vtkIdType i = 0; i < some; ++i)
          {
            moves[i] -= starts[next + first + i];
          }
          take(next + first, moves.data(), some);
        },
        "Point", MESH_NAME, &memories[part]);
    }
    next += count;
  }
}

// Two ways to make displacements of vectors, three floats each. False where one is too large.
// Without branches, as there are millions.
bool TransformVectors(
  const glm::dmat3& transform, const glm::dvec3* vectors, std::size_t count, float* displacements)
{
  int near = 1;
  for (std::size_t i = 0; i < count; ++i)
  {
    const glm::dvec3 move = transform * vectors[i];
    for (int axis = 0; axis < 3; ++axis)
    {
      // Not-a-number is not near either.
      near &= std::abs(move[axis]) <= LargestDisplacement ? 1 : 0;
      displacements[3 * i + axis] = static_cast<float>(move[axis]);
    }
  }
  return near != 0;
}

// The same where axes stay axes. Finite numbers times finite ones are never not-a-number.
bool ScaleVectors(
  const glm::dvec3& scaling, const glm::dvec3* vectors, std::size_t count, float* displacements)
{
  const double* components = &vectors[0].x;
  double largest = 0.0;
  std::size_t i = 0;
#ifdef __SSE2__
  // Compilers do not find these by themselves. Twelve numbers at a time, of four vectors: every
  // third pair is of the same axes.
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double), "vectors lie side by side");
  constexpr std::size_t width = 12;
  const __m128d factors[3] = { _mm_set_pd(scaling.y, scaling.x), _mm_set_pd(scaling.x, scaling.z),
    _mm_set_pd(scaling.z, scaling.y) };
  const __m128d sign = _mm_set1_pd(-0.0);
  __m128d farthest = _mm_setzero_pd();
  for (; i + width <= 3 * count; i += width)
  {
    for (std::size_t pair = 0; pair < width / 2; pair += 2)
    {
      const double* next = components + i + 2 * pair;
      const __m128d first = _mm_mul_pd(factors[pair % 3], _mm_loadu_pd(next));
      const __m128d second = _mm_mul_pd(factors[(pair + 1) % 3], _mm_loadu_pd(next + 2));
      farthest =
        _mm_max_pd(farthest, _mm_max_pd(_mm_andnot_pd(sign, first), _mm_andnot_pd(sign, second)));
      _mm_storeu_ps(
        displacements + i + 2 * pair, _mm_movelh_ps(_mm_cvtpd_ps(first), _mm_cvtpd_ps(second)));
    }
  }
  std::array<double, 2> distances;
  _mm_storeu_pd(distances.data(), farthest);
  largest = std::max(distances[0], distances[1]);
#endif
  for (; i < 3 * count; ++i)
  {
    const double move = scaling[static_cast<int>(i % 3)] * components[i];
    largest = std::max(largest, std::abs(move));
    displacements[i] = static_cast<float>(move);
  }
  return largest <= LargestDisplacement;
}

} // namespace

glm::dmat3 GetToDisplacement(const DeformationSource& source, double factor)
{
  glm::dmat3 transform(source.Volume.GetWorldToIndex());
  for (int column = 0; column < 3; ++column)
  {
    transform[column] *= source.Scale * factor;
    for (int row = 0; row < 3; ++row)
    {
      transform[column][row] = RoundFactor(transform[column][row]);
    }
  }
  return transform;
}

void Deformation::Read(const DeformationSource& source)
{
  if (const auto image = vtkImageData::SafeDownCast(source.Shape))
  {
    if (source.Rest)
    {
      throw Error("Input port 2 has a rest configuration, but port 1 has a displacement field, "
                  "which needs none. Disconnect port 2.");
    }
    this->ReadField(image, source);
  }
  else
  {
    this->ReadMesh(source);
  }
}

void Deformation::ReadMesh(const DeformationSource& source)
{
  const MeshParts shape = GetMeshParts(source.Shape, MESH_NAME);
  const MeshParts rest = source.Rest ? GetMeshParts(source.Rest, REST_NAME) : shape;
  if (GetNumberOfNodes(shape) != GetNumberOfNodes(rest))
  {
    throw Error("The deformation mesh on input port 1 has " +
      std::to_string(GetNumberOfNodes(shape)) +
      " points and the rest configuration on port 2 has " + std::to_string(GetNumberOfNodes(rest)) +
      ". Connect two configurations of one mesh.");
  }
  this->Mesh.Read(shape, rest, source);
  if (this->ConnectivityOfVectors != this->Mesh.GetConnectivityVersion())
  {
    this->ConnectivityOfVectors = this->Mesh.GetConnectivityVersion();
    ++this->VectorsVersion;
  }

  Stamp stamp = source.Rest ? GetPointsStamp(shape) : GetPointVectorsStamp(shape);
  if (source.Rest)
  {
    const Stamp restStamp = GetPointsStamp(rest);
    stamp.insert(stamp.end(), restStamp.begin(), restStamp.end());
  }
  // The two ways to give displacements never count as the same.
  const bool ofPoints = source.Rest != nullptr;
  stamp.emplace_back(nullptr, ofPoints ? 1 : 0);
  if (this->VectorsAreCurrent(stamp, source, false))
  {
    return;
  }
  vtkDataArray* only = !ofPoints && shape.size() == 1 ? source.Selector(shape.front()) : nullptr;
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
        ReadPointDifferences(shape, rest, take, this->Memories);
      }
      else
      {
        ReadPointVectors(shape, source.Selector, source.Wanted, MESH_NAME, take, &this->Memories);
      }
    },
    ofPoints ? 1.0 : source.DisplacementScale, source);
  this->RememberVectors(stamp, source, false);
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
    source.Scale == last.Scale;
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

void Deformation::SetVectors(std::size_t count, const std::function<void(const VectorTaker&)>& read,
  double factor, const DeformationSource& source)
{
  ++this->VectorsVersion;
  this->ReplaceVectors(count, read, factor, source);
}

void Deformation::ReplaceVectors(std::size_t count,
  const std::function<void(const VectorTaker&)>& read, double factor,
  const DeformationSource& source)
{
  // Whatever fails from here on, the vectors are not those of any source.
  this->VectorsStamp.clear();
  this->FieldInPlace = DisplacementField();
  const std::uint64_t version = this->VectorsVersion;
  const std::size_t blocks = (count + PointsPerBlock - 1) / PointsPerBlock;
  const bool comparable = this->VectorsAreWhole;
  if (!comparable)
  {
    this->BlockVersions.clear();
  }
  if (this->Vectors.size() != 3 * count)
  {
    // Of a block that ends elsewhere now not all can be as it was.
    const std::size_t same = std::min(this->Vectors.size() / 3, count) / PointsPerBlock;
    this->BlockVersions.resize(std::min(this->BlockVersions.size(), same));
    this->BlockComponents.resize(std::min(this->BlockComponents.size(), same));
    this->Vectors.resize(3 * count);
  }
  this->BlockVersions.resize(blocks, version);
  if (!comparable || !this->HasSameUnits(source))
  {
    this->Memories.clear();
  }
  const bool isFollowing = !this->Memories.empty();
  this->BlockComponents.resize(blocks);
  this->VectorsAreWhole = false;
  const glm::dmat3 transform = GetToDisplacement(source, factor);
  const glm::dvec3 scaling(transform[0][0], transform[1][1], transform[2][2]);
  const bool isScaling = transform == glm::dmat3(glm::scale(glm::dmat4(1.0), scaling));
  std::vector<std::atomic<bool>> changed(blocks);
  std::vector<std::atomic<bool>> inPieces(blocks);
  std::atomic<bool> tooFar{ false };
  read(
    [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType number)
    {
      std::array<float, 3 * PointsPerBlock> displacements;
      auto point = static_cast<std::size_t>(first);
      const std::size_t end = point + static_cast<std::size_t>(number);
      while (point < end)
      {
        const std::size_t block = point / PointsPerBlock;
        const std::size_t some = std::min(end, (block + 1) * PointsPerBlock) - point;
        const bool near = isScaling
          ? ScaleVectors(scaling, vectors, some, displacements.data())
          : TransformVectors(transform, vectors, some, displacements.data());
        if (!near)
        {
          tooFar = true;
          return;
        }
        float* last = this->Vectors.data() + 3 * point;
        if (std::memcmp(last, displacements.data(), 3 * some * sizeof(float)) != 0)
        {
          std::copy_n(displacements.begin(), 3 * some, last);
          changed[block].store(true, std::memory_order_relaxed);
        }
        if (some == std::min(PointsPerBlock, count - block * PointsPerBlock))
        {
          // While the caches hold them.
          this->BlockComponents[block] = FindComponents(displacements.data(), 3 * some);
        }
        else
        {
          inPieces[block].store(true, std::memory_order_relaxed);
        }
        vectors += some;
        point += some;
      }
    });
  if (tooFar)
  {
    throw Error("The deformation moves the volume by more than 16,383 output voxels. Check "
                "DisplacementScale, the output spacing, and that displacements and volume are in "
                "the same world units.");
  }
  std::size_t number = 0;
  for (std::size_t block = 0; block < blocks; ++block)
  {
    if (inPieces[block])
    {
      this->BlockComponents[block] = VectorComponents();
    }
    if (changed[block])
    {
      this->BlockVersions[block] = version;
      ++number;
    }
  }
  for (VectorMemory& memory : this->Memories)
  {
    memory.KeepsBytes = !isFollowing || 2 * number < blocks;
  }
  this->VectorsAreWhole = true;
}

void Deformation::RememberVectors(const Stamp& stamp, const DeformationSource& source, bool field)
{
  this->Field = field;
  this->VectorsStamp = stamp;
  this->VectorsSource = source;
  // Only compared, never called or read through again.
  this->VectorsSource.Shape = nullptr;
  this->VectorsSource.Rest = nullptr;
  this->VectorsSource.Selector = nullptr;
}

} // namespace deformvolume
