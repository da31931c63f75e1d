// SPDX-License-Identifier: BSD-3-Clause
#include "FiniteElements.h"

#include "ElementMechanics.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace deformvolume
{
namespace
{

constexpr std::size_t ChunksAtOnce = 512;

// The batches of a chunk.
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
  const ElementBatch& batch, const LaneVector (&forces)[4], double* sums)
{
  for (int node = 0; node < 4; ++node)
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

DEFORMVOLUME_ALWAYS_INLINE void FindForcesOfChunk(const ForceArguments& arguments)
{
  Lanes energy = MakeLanes(0.0);
  std::int64_t inverted = 0;
  for (std::size_t i = arguments.Range.Begin; i < arguments.Range.End; ++i)
  {
    const ElementBatch& batch = arguments.Batches[i];
    const LaneMatrix F = FindDeformationGradient(batch, arguments.Displacements);
    const SingularValues values = FindSingularValues(F);
    const LaneStress stress = FindStress(batch, F, values);
    energy = energy + batch.Volume * stress.EnergyDensity;
    LaneVector forces[4];
    for (int a = 0; a < 3; ++a)
    {
      forces[a + 1] = Scale(Multiply(stress.Piola, batch.Gradients[a]), batch.Volume);
    }
    forces[0] = Scale(Add(Add(forces[1], forces[2]), forces[3]), MakeLanes(-1.0));
    AddForces(batch, forces, arguments.Forces);
    for (int lane = 0; lane < NumberOfLanes; ++lane)
    {
      inverted += values.Values[2][lane] < 0.0 && batch.Volume[lane] > 0.0 ? 1 : 0;
    }
  }
  arguments.Sums->Energy = SumOfLanes(energy);
  arguments.Sums->Inverted = inverted;
}

struct TangentArguments
{
  const ElementBatch* Batches;
  const BatchPositions* Positions;
  const std::int32_t* Diagonal;
  ChunkRange Range;
  const double* Displacements;
  BlockMatrix* Matrix;
};

// Four numbers of each lane, lane by lane.
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

// Adds the matrix of each lane to its block. Blocks of two lanes may be the same.
DEFORMVOLUME_ALWAYS_INLINE void AddBlocks(
  double* const (&blocks)[NumberOfLanes], const LaneMatrix& matrix)
{
  const LaneVector* const columns = matrix.Columns;
  Lanes first[NumberOfLanes];
  Lanes second[NumberOfLanes];
  TransposeLanes(columns[0].X, columns[0].Y, columns[0].Z, columns[1].X, first);
  TransposeLanes(columns[1].Y, columns[1].Z, columns[2].X, columns[2].Y, second);
  for (int lane = 0; lane < NumberOfLanes; ++lane)
  {
    AddLanes(blocks[lane], first[lane]);
    AddLanes(blocks[lane] + 4, second[lane]);
    blocks[lane][8] += columns[2].Z[lane];
  }
}

DEFORMVOLUME_ALWAYS_INLINE void AddTangentsOfChunk(const TangentArguments& arguments)
{
  for (std::size_t i = arguments.Range.Begin; i < arguments.Range.End; ++i)
  {
    const ElementBatch& batch = arguments.Batches[i];
    const BatchPositions& positions = arguments.Positions[i];
    const LaneMatrix F = FindDeformationGradient(batch, arguments.Displacements);
    LaneTangent tangent;
    FindTangent(batch, FindSingularValues(F), tangent);
    for (int pair = 0; pair < 6; ++pair)
    {
      const std::int32_t* const p = positions.Blocks[pair];
      BlockMatrix& matrix = *arguments.Matrix;
      AddBlocks({ matrix.GetBlock(p[0]), matrix.GetBlock(p[1]), matrix.GetBlock(p[2]),
                  matrix.GetBlock(p[3]) },
        tangent.Mixed[pair]);
    }
    for (int node = 0; node < 4; ++node)
    {
      const std::int32_t* const n = batch.Nodes[node];
      const auto block = [&](int lane) __attribute__((always_inline))
      {
        return arguments.Matrix->GetBlock(arguments.Diagonal[n[lane]]);
      };
      AddBlocks({ block(0), block(1), block(2), block(3) }, tangent.Own[node]);
    }
  }
}

#if DEFORMVOLUME_HAS_AVX2_CODE
DEFORMVOLUME_FOR_AVX2 void FindForcesOfChunkWide(const ForceArguments& arguments)
{
  FindForcesOfChunk(arguments);
}
DEFORMVOLUME_FOR_AVX2 void AddTangentsOfChunkWide(const TangentArguments& arguments)
{
  AddTangentsOfChunk(arguments);
}
#endif

void RunChunk(const ForceArguments& arguments)
{
#if DEFORMVOLUME_HAS_AVX2_CODE
  if (HasWideLanes())
  {
    FindForcesOfChunkWide(arguments);
    return;
  }
#endif
  FindForcesOfChunk(arguments);
}

void RunChunk(const TangentArguments& arguments)
{
#if DEFORMVOLUME_HAS_AVX2_CODE
  if (HasWideLanes())
  {
    AddTangentsOfChunkWide(arguments);
    return;
  }
#endif
  AddTangentsOfChunk(arguments);
}

ChunkRange GetRange(const ElementBatches& batches, std::size_t chunk)
{
  return { chunk * ElementBatches::ChunkSize,
    std::min(batches.Batches.size(), (chunk + 1) * ElementBatches::ChunkSize) };
}

// Calls body(chunk) for all chunks, so that those that have a node in common come one after the
// other, in an order that is always the same.
template <typename Body>
void ForChunks(Watch& watch, const ElementBatches& batches, Body&& body)
{
  for (const std::vector<std::uint32_t>& color : batches.Colors)
  {
    ForParts(watch, color.size(), ChunksAtOnce, [&](std::size_t i) { body(color[i]); });
  }
}

// J sigma = P F^T, of which the six components are those that differ.
std::array<double, 6> GetCauchyStress(
  const LaneMatrix& piola, const LaneMatrix& F, int lane, double determinant)
{
  const auto sum = [&](Lanes LaneVector::*row, Lanes LaneVector::*column)
  {
    double result = 0.0;
    for (int k = 0; k < 3; ++k)
    {
      result += (piola.Columns[k].*row)[lane] * (F.Columns[k].*column)[lane];
    }
    return result / determinant;
  };
  return { sum(&LaneVector::X, &LaneVector::X), sum(&LaneVector::Y, &LaneVector::Y),
    sum(&LaneVector::Z, &LaneVector::Z), sum(&LaneVector::X, &LaneVector::Y),
    sum(&LaneVector::Y, &LaneVector::Z), sum(&LaneVector::X, &LaneVector::Z) };
}

} // namespace

FiniteElements::Sums FiniteElements::FindForces(
  Watch& watch, const std::vector<glm::dvec3>& displacements, std::vector<glm::dvec3>& forces) const
{
  forces.assign(displacements.size(), glm::dvec3(0.0));
  std::vector<Sums> sums(this->Batches.GetNumberOfChunks());
  ForChunks(watch, this->Batches,
    [&](std::size_t chunk)
    {
      RunChunk(ForceArguments{ this->Batches.Batches.data(), GetRange(this->Batches, chunk),
        &displacements.front().x, &forces.front().x, &sums[chunk] });
    });
  Sums total;
  for (const Sums& sum : sums)
  {
    total.Energy += sum.Energy;
    total.Inverted += sum.Inverted;
  }
  return total;
}

void FiniteElements::FindInvertedNodes(Watch& watch, const std::vector<glm::dvec3>& displacements,
  std::vector<unsigned char>& isInverted) const
{
  isInverted.assign(displacements.size(), 0);
  ForChunks(watch, this->Batches,
    [&](std::size_t chunk)
    {
      const ChunkRange range = GetRange(this->Batches, chunk);
      for (std::size_t i = range.Begin; i < range.End; ++i)
      {
        const ElementBatch& batch = this->Batches.Batches[i];
        const LaneMatrix F = FindDeformationGradient(batch, &displacements.front().x);
        const Lanes determinant = Dot(F.Columns[0], Cross(F.Columns[1], F.Columns[2]));
        for (int lane = 0; lane < NumberOfLanes; ++lane)
        {
          for (int node = 0; node < 4 && determinant[lane] < 0.0 && batch.Volume[lane] > 0.0;
               ++node)
          {
            isInverted[static_cast<std::size_t>(batch.Nodes[node][lane])] = 1;
          }
        }
      }
    });
}

void FiniteElements::AssembleTangent(
  Watch& watch, const std::vector<glm::dvec3>& displacements, BlockMatrix& matrix) const
{
  matrix.PutToZero(watch);
  ForChunks(watch, this->Batches,
    [&](std::size_t chunk)
    {
      RunChunk(TangentArguments{ this->Batches.Batches.data(), this->Positions.data(),
        matrix.GetPattern().Diagonal.data(), GetRange(this->Batches, chunk),
        &displacements.front().x, &matrix });
    });
  matrix.Mirror(watch);
}

std::vector<ElementResults> FiniteElements::GetResults(
  const std::vector<glm::dvec3>& displacements) const
{
  std::vector<ElementResults> results(
    static_cast<std::size_t>(
      *std::max_element(this->Batches.Tetrahedra.begin(), this->Batches.Tetrahedra.end())) +
    1);
  constexpr std::size_t batchesOfPart = 256;
  ParallelForParts(this->Batches.Batches.size(), batchesOfPart,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        const ElementBatch& batch = this->Batches.Batches[i];
        const LaneMatrix F = FindDeformationGradient(batch, &displacements.front().x);
        const SingularValues values = FindSingularValues(F);
        const LaneStress stress = FindStress(batch, F, values);
        for (int lane = 0; lane < NumberOfLanes; ++lane)
        {
          const std::int32_t tetrahedron =
            this->Batches.Tetrahedra[i * NumberOfLanes + static_cast<std::size_t>(lane)];
          if (tetrahedron < 0)
          {
            continue;
          }
          ElementResults& result = results[static_cast<std::size_t>(tetrahedron)];
          const Lanes* s = values.Values;
          result.Determinant = s[0][lane] * s[1][lane] * s[2][lane];
          result.StrainEnergyDensity = stress.EnergyDensity[lane];
          if (!IsFlat(result.Determinant))
          {
            result.Stress = GetCauchyStress(stress.Piola, F, lane, result.Determinant);
          }
        }
      }
    });
  return results;
}

} // namespace deformvolume
