// SPDX-License-Identifier: BSD-3-Clause
#include "FiniteElements.h"

#include "ElementMechanics.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace deformvolume
{
namespace
{

constexpr std::size_t ChunksAtOnce = 512;

// The range of batches of a chunk.
struct ChunkRange
{
  std::size_t Begin;
  std::size_t End;
};

struct ForceArguments
{
  const ElementBatch* Batches;
  ChunkRange Range;
  const double* Displacements;
  double* Forces;
  FiniteElements::Sums* Sums;
};

DEFORMVOLUME_ALWAYS_INLINE void AddForces(
  const ElementBatch& batch, const LaneVector (&forces)[ElementBatch::NumberOfNodes], double* sums)
{
  for (int node = 0; node < ElementBatch::NumberOfNodes; ++node)
  {
    for (int lane = 0; lane < NumberOfLanes; ++lane)
    {
      double* const sum = sums + 3 * static_cast<std::size_t>(batch.Nodes[node][lane]);
      sum[0] += forces[node].X[lane];
      sum[1] += forces[node].Y[lane];
      sum[2] += forces[node].Z[lane];
    }
  }
}

// Whether the tetrahedron in a lane is inverted at a Gauss point.
DEFORMVOLUME_ALWAYS_INLINE bool IsInverted(
  const ElementBatch& batch, const LaneElement& element, int lane)
{
  bool isInverted = false;
  for (const LanePoint& point : element.Points)
  {
    isInverted = isInverted || point.Dilatation[lane] < -1.0;
  }
  return isInverted && batch.InverseVolume[lane] > 0.0;
}

template <MaterialModel Model>
DEFORMVOLUME_ALWAYS_INLINE void FindForcesOfChunk(const ForceArguments& arguments)
{
  Lanes energy = MakeLanes(0.0);
  Lanes sizeOfTerms = MakeLanes(0.0);
  std::int64_t inverted = 0;
  for (std::size_t i = arguments.Range.Begin; i < arguments.Range.End; ++i)
  {
    const ElementBatch& batch = arguments.Batches[i];
    LaneElement element;
    FindElement(batch, arguments.Displacements, element);
    LaneMatrix stresses[ElementBatch::NumberOfGaussPoints];
    Lanes volume = MakeLanes(0.0);
    for (int p = 0; p < ElementBatch::NumberOfGaussPoints; ++p)
    {
      const LanePoint& point = element.Points[p];
      const LaneStress stress = FindStress<Model>(batch, point, element.MeanPressure);
      stresses[p] = stress.Piola;
      volume = volume + batch.Volumes[p];
      energy = energy + batch.Volumes[p] * stress.EnergyDensity;
      const LaneVector* const h = point.Gradient.Columns;
      sizeOfTerms = sizeOfTerms +
        batch.Volumes[p] * batch.Mu * (Dot(h[0], h[0]) + Dot(h[1], h[1]) + Dot(h[2], h[2]));
    }
    energy = energy + 0.5 * volume * element.MeanPressure * element.MeanDilatation;
    LaneVector forces[ElementBatch::NumberOfNodes];
    FindNodeForces(batch, stresses, forces);
    AddForces(batch, forces, arguments.Forces);
    for (int lane = 0; lane < NumberOfLanes; ++lane)
    {
      inverted += IsInverted(batch, element, lane) ? 1 : 0;
    }
  }
  arguments.Sums->Energy = SumOfLanes(energy);
  arguments.Sums->SizeOfTerms = SumOfLanes(sizeOfTerms);
  arguments.Sums->Inverted = inverted;
}

struct TangentArguments
{
  const ElementBatch* Batches;
  const BatchPositions* Positions;
  const std::int32_t* Diagonal;
  ChunkRange Range;
  const double* Displacements;
  bool IsClamped;
  BlockMatrix* Matrix;
};

// Transposes four values of four lanes each.
DEFORMVOLUME_ALWAYS_INLINE void TransposeLanes(
  const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d, Lanes (&result)[NumberOfLanes])
{
  const Lanes lowAB = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Lanes highAB = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes lowCD = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Lanes highCD = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  result[0] = __builtin_shufflevector(lowAB, lowCD, 0, 1, 4, 5);
  result[1] = __builtin_shufflevector(highAB, highCD, 0, 1, 4, 5);
  result[2] = __builtin_shufflevector(lowAB, lowCD, 2, 3, 6, 7);
  result[3] = __builtin_shufflevector(highAB, highCD, 2, 3, 6, 7);
}

DEFORMVOLUME_ALWAYS_INLINE void AddLanes(double* sums, const Lanes& lanes)
{
  Lanes sum;
  std::memcpy(&sum, sums, sizeof(sum));
  sum = sum + lanes;
  std::memcpy(sums, &sum, sizeof(sum));
}

// Adds the matrix of each lane to its block. A negative position ~block stands for the transposed
// block. Two lanes may have the same block, so they are added one after the other.
DEFORMVOLUME_ALWAYS_INLINE void AddBlocks(
  BlockMatrix& target, const std::int32_t* positions, const LaneMatrix& matrix)
{
  const LaneVector* const columns = matrix.Columns;
  Lanes first[NumberOfLanes];
  Lanes second[NumberOfLanes];
  TransposeLanes(columns[0].X, columns[0].Y, columns[0].Z, columns[1].X, first);
  TransposeLanes(columns[1].Y, columns[1].Z, columns[2].X, columns[2].Y, second);
  for (int lane = 0; lane < NumberOfLanes; ++lane)
  {
    if (positions[lane] >= 0)
    {
      double* const block = target.GetBlock(positions[lane]);
      AddLanes(block, first[lane]);
      AddLanes(block + 4, second[lane]);
      block[8] += columns[2].Z[lane];
      continue;
    }
    double* const block = target.GetBlock(~positions[lane]);
    for (int i = 0; i < 3; ++i)
    {
      block[3 * 0 + i] += columns[i].X[lane];
      block[3 * 1 + i] += columns[i].Y[lane];
      block[3 * 2 + i] += columns[i].Z[lane];
    }
  }
}

template <MaterialModel Model>
DEFORMVOLUME_ALWAYS_INLINE void AddTangentsOfChunk(const TangentArguments& arguments)
{
  for (std::size_t i = arguments.Range.Begin; i < arguments.Range.End; ++i)
  {
    const ElementBatch& batch = arguments.Batches[i];
    const BatchPositions& positions = arguments.Positions[i];
    LaneElement element;
    FindElement(batch, arguments.Displacements, element);
    LaneTangent tangent;
    FindTangent<Model>(batch, element, arguments.IsClamped, tangent);
    const LaneMatrix* block = tangent.Blocks;
    int pair = 0;
    for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
    {
      std::int32_t own[NumberOfLanes];
      for (int lane = 0; lane < NumberOfLanes; ++lane)
      {
        own[lane] = arguments.Diagonal[batch.Nodes[a][lane]];
      }
      AddBlocks(*arguments.Matrix, own, *block++);
      for (int b = a + 1; b < ElementBatch::NumberOfNodes; ++b)
      {
        AddBlocks(*arguments.Matrix, positions.Blocks[pair++], *block++);
      }
    }
  }
}

// Calls call(model) with the material model as a compile-time constant, decltype(model)::value.
template <typename Call>
void WithModel(MaterialModel model, Call&& call)
{
  if (model == MaterialModel::Corotational)
  {
    call(std::integral_constant<MaterialModel, MaterialModel::Corotational>());
  }
  else
  {
    call(std::integral_constant<MaterialModel, MaterialModel::StableNeoHookean>());
  }
}

ChunkRange GetRange(const ElementBatches& batches, std::size_t chunk)
{
  return { chunk * ElementBatches::ChunkSize,
    std::min(batches.Batches.size(), (chunk + 1) * ElementBatches::ChunkSize) };
}

// Calls body(chunk) for all chunks, one color after the other. Chunks with a common node are never
// handled in parallel, and always in the same order.
template <typename Body>
void ForChunks(AbortCheck& abortCheck, const ElementBatches& batches, Body&& body)
{
  for (const std::vector<std::uint32_t>& color : batches.Colors)
  {
    ForParts(abortCheck, color.size(), ChunksAtOnce, [&](std::size_t i) { body(color[i]); });
  }
}

// Adds the six components of the Kirchhoff stress J sigma = P F^T times a volume.
void AddKirchhoffStress(const LaneMatrix& piola, const LaneMatrix& F, int lane, double volume,
  std::array<double, 6>& stress)
{
  const auto product = [&](Lanes LaneVector::*row, Lanes LaneVector::*column)
  {
    double result = 0.0;
    for (int k = 0; k < 3; ++k)
    {
      result += (piola.Columns[k].*row)[lane] * (F.Columns[k].*column)[lane];
    }
    return volume * result;
  };
  stress[0] += product(&LaneVector::X, &LaneVector::X);
  stress[1] += product(&LaneVector::Y, &LaneVector::Y);
  stress[2] += product(&LaneVector::Z, &LaneVector::Z);
  stress[3] += product(&LaneVector::X, &LaneVector::Y);
  stress[4] += product(&LaneVector::Y, &LaneVector::Z);
  stress[5] += product(&LaneVector::X, &LaneVector::Z);
}

// Computes means over the tetrahedron in a lane: of the stress over the deformed volume, of the
// energy density over the volume at rest.
ElementResults GetLaneResults(const ElementBatch& batch, const LaneElement& element,
  const LaneStress (&stresses)[ElementBatch::NumberOfGaussPoints], int lane)
{
  ElementResults result;
  double volume = 0.0;
  for (int p = 0; p < ElementBatch::NumberOfGaussPoints; ++p)
  {
    const double part = batch.Volumes[p][lane];
    volume += part;
    result.StrainEnergyDensity += part * stresses[p].EnergyDensity[lane];
    AddKirchhoffStress(stresses[p].Piola, AddToDiagonal(element.Points[p].Gradient, MakeLanes(1.0)),
      lane, part, result.Stress);
  }
  result.Determinant = 1.0 + element.MeanDilatation[lane];
  result.StrainEnergyDensity = result.StrainEnergyDensity / volume +
    0.5 * element.MeanPressure[lane] * element.MeanDilatation[lane];
  for (double& component : result.Stress)
  {
    component = IsFlat(result.Determinant) ? 0.0 : component / (volume * result.Determinant);
  }
  return result;
}

template <MaterialModel Model>
void FindBatchResults(const ElementBatch& batch, const double* displacements,
  const std::int32_t* tetrahedra, std::vector<ElementResults>& results)
{
  LaneElement element;
  FindElement(batch, displacements, element);
  LaneStress stresses[ElementBatch::NumberOfGaussPoints];
  for (int p = 0; p < ElementBatch::NumberOfGaussPoints; ++p)
  {
    stresses[p] = FindStress<Model>(batch, element.Points[p], element.MeanPressure);
  }
  for (int lane = 0; lane < NumberOfLanes; ++lane)
  {
    if (tetrahedra[lane] >= 0 && batch.InverseVolume[lane] > 0.0)
    {
      results[static_cast<std::size_t>(tetrahedra[lane])] =
        GetLaneResults(batch, element, stresses, lane);
    }
  }
}

} // namespace

std::vector<unsigned char> FindInvertedSplits(
  AbortCheck& abortCheck, const ElasticBody& body, const std::vector<glm::dvec3>& displacements)
{
  constexpr std::size_t size = 1024;
  std::vector<unsigned char> isInverted(body.Tetrahedra.size(), 0);
  ForParts(abortCheck, (isInverted.size() + size - 1) / size, ChunksAtOnce,
    [&](std::size_t part)
    {
      const std::size_t end = std::min(isInverted.size(), (part + 1) * size);
      for (std::size_t t = part * size; t < end; ++t)
      {
        std::array<glm::dvec3, QuadraticTetrahedron::NumberOfNodes> points{};
        const bool isMirrored =
          QuadraticTetrahedron::IsMirrored(QuadraticTetrahedron::GetPoints(body, t));
        std::size_t i = 0;
        body.ForNodes(t,
          [&](std::int32_t node)
          {
            points[i++] = body.Points[static_cast<std::size_t>(node)] +
              displacements[static_cast<std::size_t>(node)];
          });
        isInverted[t] = QuadraticTetrahedron::IsSplitInverted(points, isMirrored) ? 1 : 0;
      }
    });
  return isInverted;
}

FiniteElements::Sums FiniteElements::FindForces(AbortCheck& abortCheck,
  const std::vector<glm::dvec3>& displacements, std::vector<glm::dvec3>& forces) const
{
  forces.assign(displacements.size(), glm::dvec3(0.0));
  std::vector<Sums> sums(this->Batches.GetNumberOfChunks());
  ForChunks(abortCheck, this->Batches,
    [&](std::size_t chunk)
    {
      const ForceArguments arguments{ this->Batches.Batches.data(), GetRange(this->Batches, chunk),
        &displacements.front().x, &forces.front().x, &sums[chunk] };
      WithModel(this->Model,
        [&](auto model)
        {
          RunOnLanes([&]() __attribute__((always_inline)) {
            FindForcesOfChunk<decltype(model)::value>(arguments);
          });
        });
    });
  Sums total;
  for (const Sums& sum : sums)
  {
    total.Energy += sum.Energy;
    total.SizeOfTerms += sum.SizeOfTerms;
    total.Inverted += sum.Inverted;
  }
  return total;
}

void FiniteElements::FindInvertedNodes(AbortCheck& abortCheck,
  const std::vector<glm::dvec3>& displacements, std::vector<unsigned char>& isInverted) const
{
  isInverted.assign(displacements.size(), 0);
  ForChunks(abortCheck, this->Batches,
    [&](std::size_t chunk)
    {
      const ChunkRange range = GetRange(this->Batches, chunk);
      for (std::size_t i = range.Begin; i < range.End; ++i)
      {
        const ElementBatch& batch = this->Batches.Batches[i];
        LaneElement element;
        FindElement(batch, &displacements.front().x, element);
        for (int lane = 0; lane < NumberOfLanes; ++lane)
        {
          for (int node = 0; node < ElementBatch::NumberOfNodes && IsInverted(batch, element, lane);
               ++node)
          {
            isInverted[static_cast<std::size_t>(batch.Nodes[node][lane])] = 1;
          }
        }
      }
    });
}

void FiniteElements::AssembleTangent(AbortCheck& abortCheck,
  const std::vector<glm::dvec3>& displacements, bool isClamped, BlockMatrix& matrix) const
{
  matrix.PutToZero(abortCheck);
  ForChunks(abortCheck, this->Batches,
    [&](std::size_t chunk)
    {
      const TangentArguments arguments{ this->Batches.Batches.data(), this->Positions.data(),
        matrix.GetPattern().Diagonal.data(), GetRange(this->Batches, chunk),
        &displacements.front().x, isClamped, &matrix };
      WithModel(this->Model,
        [&](auto model)
        {
          RunOnLanes([&]() __attribute__((always_inline)) {
            AddTangentsOfChunk<decltype(model)::value>(arguments);
          });
        });
    });
  matrix.Mirror(abortCheck);
}

std::vector<ElementResults> FiniteElements::GetResults(
  const std::vector<glm::dvec3>& displacements) const
{
  std::vector<ElementResults> results(
    static_cast<std::size_t>(
      *std::max_element(this->Batches.Tetrahedra.begin(), this->Batches.Tetrahedra.end())) +
    1);
  constexpr std::size_t batchesOfPart = 256;
  ParallelForItems(this->Batches.Batches.size(), batchesOfPart,
    [&](std::size_t i)
    {
      const ElementBatch& batch = this->Batches.Batches[i];
      const std::int32_t* const tetrahedra = &this->Batches.Tetrahedra[i * NumberOfLanes];
      WithModel(this->Model,
        [&](auto known)
        {
          FindBatchResults<decltype(known)::value>(
            batch, &displacements.front().x, tetrahedra, results);
        });
    });
  return results;
}

} // namespace deformvolume
