// SPDX-License-Identifier: BSD-3-Clause
#include "Multigrid.h"

#include "Aggregation.h"
#include "NodeRotations.h"
#include "RowParts.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cstddef>

namespace deformvolume
{
namespace
{

constexpr std::size_t PartsAtOnce = BlockMatrix::PartsAtOnce;
// The largest number of aggregates of the coarsest level, which is solved exactly.
constexpr std::int32_t CoarsestAggregates = 100;
constexpr Eigen::Index ColumnsAtOnce = 48;

// Extracts the rows and columns of free nodes.
SparseBlocks<3, 3> ExtractFree(AbortCheck& abortCheck, const BlockMatrix& matrix,
  const std::vector<unsigned char>& isFree, const std::vector<std::int32_t>& freeNodes)
{
  const BlockPattern& pattern = matrix.GetPattern();
  std::vector<std::int32_t> numbers(isFree.size(), -1);
  for (std::size_t i = 0; i < freeNodes.size(); ++i)
  {
    numbers[static_cast<std::size_t>(freeNodes[i])] = static_cast<std::int32_t>(i);
  }
  SparseBlocks<3, 3> result;
  result.NumberOfColumns = static_cast<std::int32_t>(freeNodes.size());
  result.Starts.reserve(freeNodes.size() + 1);
  result.ColumnOfBlock.reserve(pattern.Columns.size());
  result.Blocks.reserve(pattern.Columns.size());
  ForItems(abortCheck, freeNodes.size(),
    [&](std::size_t i)
    {
      const auto row = static_cast<std::size_t>(freeNodes[i]);
      for (std::int32_t block = pattern.Rows[row]; block < pattern.Rows[row + 1]; ++block)
      {
        const std::int32_t column =
          numbers[static_cast<std::size_t>(pattern.Columns[static_cast<std::size_t>(block)])];
        if (column >= 0)
        {
          result.ColumnOfBlock.push_back(column);
          result.Blocks.emplace_back(Eigen::Map<const Eigen::Matrix3d>(matrix.GetBlock(block)));
        }
      }
      result.Starts.push_back(static_cast<std::int32_t>(result.Blocks.size()));
    });
  return result;
}

NearNullSpace<3> MakeRigidModes(
  const std::vector<glm::dvec3>& positions, const std::vector<std::int32_t>& nodes)
{
  glm::dvec3 center(0.0);
  for (const std::int32_t node : nodes)
  {
    center += positions[static_cast<std::size_t>(node)];
  }
  center /= static_cast<double>(nodes.size());
  NearNullSpace<3> modes(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    const glm::dvec3 arm = positions[static_cast<std::size_t>(nodes[i])] - center;
    modes[i] << 1, 0, 0, 0, arm.z, -arm.y, //
      0, 1, 0, -arm.z, 0, arm.x,           //
      0, 0, 1, arm.y, -arm.x, 0;
  }
  return modes;
}

template <typename Real, int Size>
std::vector<Real> MakeSmoother(AbortCheck& abortCheck,
  const std::vector<Eigen::Matrix<double, Size, Size>>& inverses, double damping)
{
  constexpr std::size_t size = Size * Size;
  // Padding: the last column is read with as many values as there are lanes.
  std::vector<Real> result(inverses.size() * size + PaddedSize<Size>, Real(0));
  ForItemsInParallel(abortCheck, inverses.size(),
    [&](std::size_t row)
    {
      for (std::size_t i = 0; i < size; ++i)
      {
        result[row * size + i] = static_cast<Real>(damping * inverses[row].data()[i]);
      }
    });
  return result;
}

// Sets up a level for a matrix, and returns the next coarser one.
template <typename Real, int Size>
Coarsening<Size> MakeLevel(AbortCheck& abortCheck, const SparseBlocks<Size, Size>& matrix,
  const NearNullSpace<Size>& modes, MultigridLevel<Real, Size>& level)
{
  const auto inverses = InvertDiagonal(abortCheck, matrix);
  const double largest = FindLargestEigenvalue(abortCheck, matrix, inverses);
  Coarsening<Size> coarsening = Coarsen(abortCheck, matrix, inverses, largest, modes);
  level.Matrix = PaddedBlocks<Real, Size, Size>(abortCheck, matrix);
  level.Smoother = MakeSmoother<Real>(abortCheck, inverses, 4.0 / (3.0 * largest));
  level.Prolongation = PaddedBlocks<Real, Size, 6>(abortCheck, coarsening.Prolongation);
  level.Restriction =
    PaddedBlocks<Real, 6, Size>(abortCheck, Transpose(abortCheck, coarsening.Prolongation));
  const std::size_t length = inverses.size() * PaddedSize<Size>;
  level.Right.assign(length, Real(0));
  level.Solution.assign(length, Real(0));
  level.Work.assign(length, Real(0));
  return coarsening;
}

// One smoothing step that starts from 0.
template <typename Real, int Size>
void ApplySmoother(MultigridLevel<Real, Size>& level, std::size_t begin, std::size_t end)
{
  for (std::size_t row = begin; row < end; ++row)
  {
    const Real* const right = &level.Right[row * PaddedSize<Size>];
    Real* const solution = &level.Solution[row * PaddedSize<Size>];
    const Real* const smoother = &level.Smoother[row * (Size * Size)];
    for (int i = 0; i < Size; ++i)
    {
      Real sum = Real(0);
      for (int j = 0; j < Size; ++j)
      {
        sum += smoother[j * Size + i] * right[j];
      }
      solution[i] = sum;
    }
  }
}

// Pre-smoothing, and the residual.
template <typename Real, int Size>
void SmoothFirst(AbortCheck& abortCheck, MultigridLevel<Real, Size>& level)
{
  const std::size_t rows = level.Matrix.GetNumberOfRows();
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end) { ApplySmoother(level, begin, end); });
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    {
      level.Matrix.Subtract(
        begin, end, level.Right.data(), level.Solution.data(), level.Work.data());
    });
}

// Adds the correction of the coarser level, then post-smoothing.
template <typename Real, int Size>
void SmoothLast(
  AbortCheck& abortCheck, MultigridLevel<Real, Size>& level, const std::vector<Real>& coarse)
{
  const std::size_t rows = level.Matrix.GetNumberOfRows();
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    { level.Prolongation.Add(begin, end, coarse.data(), level.Solution.data()); });
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    {
      level.Matrix.Smooth(
        begin, end, level.Smoother, level.Right.data(), level.Solution.data(), level.Work.data());
    });
  level.Solution.swap(level.Work);
}

// Restricts the residual to the right-hand side of the coarser level.
template <typename Real, int Size>
void Restrict(
  AbortCheck& abortCheck, const MultigridLevel<Real, Size>& level, std::vector<Real>& coarse)
{
  ForRows(abortCheck, level.Restriction.GetNumberOfRows(),
    [&](std::size_t begin, std::size_t end)
    {
      std::fill(coarse.begin() + static_cast<std::ptrdiff_t>(begin * PaddedSize<6>),
        coarse.begin() + static_cast<std::ptrdiff_t>(end * PaddedSize<6>), Real(0));
      level.Restriction.Add(begin, end, level.Work.data(), coarse.data());
    });
}

// Cholesky factorization below the diagonal, in groups of columns that take a few milliseconds
// each. Returns whether the matrix is positive definite up to rounding.
bool Factorize(AbortCheck& abortCheck, Eigen::MatrixXd& matrix)
{
  const Eigen::Index size = matrix.rows();
  for (Eigen::Index begin = 0; begin < size; begin += ColumnsAtOnce)
  {
    abortCheck.Check();
    const Eigen::Index columns = std::min(ColumnsAtOnce, size - begin);
    const Eigen::Index rest = size - begin - columns;
    auto own = matrix.block(begin, begin, columns, columns);
    auto below = matrix.block(begin + columns, begin, rest, columns);
    const Eigen::LLT<Eigen::MatrixXd> factor(own);
    if (factor.info() != Eigen::Success)
    {
      return false;
    }
    own = factor.matrixL();
    factor.matrixU().solveInPlace<Eigen::OnTheRight>(below);
    matrix.bottomRightCorner(rest, rest).selfadjointView<Eigen::Lower>().rankUpdate(below, -1.0);
  }
  return true;
}

// Returns the inverse of a matrix, by rows; empty if the matrix is not positive definite.
template <typename Real>
std::vector<Real> Invert(AbortCheck& abortCheck, const SparseBlocks<6, 6>& matrix)
{
  const Eigen::Index size = 6 * static_cast<Eigen::Index>(matrix.GetNumberOfRows());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
  for (std::int32_t row = 0; row < matrix.GetNumberOfRows(); ++row)
  {
    for (std::size_t block = matrix.GetStart(row); block < matrix.GetEnd(row); ++block)
    {
      dense.block<6, 6>(6 * row, 6 * matrix.ColumnOfBlock[block]) = matrix.Blocks[block];
    }
  }
  if (!Factorize(abortCheck, dense))
  {
    return {};
  }
  std::vector<Real> result(static_cast<std::size_t>(size * size));
  for (Eigen::Index begin = 0; begin < size; begin += ColumnsAtOnce)
  {
    abortCheck.Check();
    const Eigen::Index columns = std::min(ColumnsAtOnce, size - begin);
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(size, size).middleCols(begin, columns);
    dense.triangularView<Eigen::Lower>().solveInPlace(inverse);
    dense.triangularView<Eigen::Lower>().transpose().solveInPlace(inverse);
    for (Eigen::Index i = 0; i < size * columns; ++i)
    {
      result[static_cast<std::size_t>(size * begin + i)] = static_cast<Real>(inverse.data()[i]);
    }
  }
  return result;
}

} // namespace

template <typename Real>
void Multigrid<Real>::Build(AbortCheck& abortCheck, const BlockMatrix& matrix,
  const std::vector<unsigned char>& isFree, const std::vector<glm::dvec3>& positions)
{
  this->FreeNodes.clear();
  this->Coarse.clear();
  this->Positions = positions;
  for (std::size_t node = 0; node < isFree.size(); ++node)
  {
    if (isFree[node] != 0)
    {
      this->FreeNodes.push_back(static_cast<std::int32_t>(node));
    }
  }
  Coarsening<3> first =
    MakeLevel(abortCheck, ExtractFree(abortCheck, matrix, isFree, this->FreeNodes),
      MakeRigidModes(positions, this->FreeNodes), this->Fine);
  SparseBlocks<6, 6> coarse = std::move(first.Matrix);
  NearNullSpace<6> modes = std::move(first.Modes);
  while (coarse.GetNumberOfRows() > CoarsestAggregates)
  {
    this->Coarse.emplace_back();
    Coarsening<6> next = MakeLevel(abortCheck, coarse, modes, this->Coarse.back());
    if (next.Matrix.GetNumberOfRows() == coarse.GetNumberOfRows())
    {
      // Each aggregate is a disconnected part of the body, so coarsening cannot continue.
      this->Coarse.pop_back();
      break;
    }
    coarse = std::move(next.Matrix);
    modes = std::move(next.Modes);
  }
  this->Inverse = coarse.GetNumberOfRows() <= CoarsestAggregates ? Invert<Real>(abortCheck, coarse)
                                                                 : std::vector<Real>();
  // The coarsest level needs only its vectors.
  this->Coarse.emplace_back();
  const std::size_t length = static_cast<std::size_t>(coarse.GetNumberOfRows()) * PaddedSize<6>;
  if (this->Inverse.empty())
  {
    this->Coarse.back().Smoother =
      MakeSmoother<Real>(abortCheck, InvertDiagonal(abortCheck, coarse), 1.0);
  }
  this->Coarse.back().Right.assign(length, Real(0));
  this->Coarse.back().Solution.assign(length, Real(0));
}

template <typename Real>
void Multigrid<Real>::SetPositions(
  AbortCheck& abortCheck, const BlockPattern& pattern, const std::vector<glm::dvec3>& positions)
{
  FindNodeRotations(
    abortCheck, pattern, this->FreeNodes, this->Positions, positions, this->Rotations);
}

template <typename Real>
void Multigrid<Real>::SolveCoarsest(
  AbortCheck& abortCheck, const std::vector<Real>& right, std::vector<Real>& solution)
{
  const std::size_t aggregates = right.size() / PaddedSize<6>;
  const std::size_t size = 6 * aggregates;
  std::vector<Real> packed(size);
  for (std::size_t i = 0; i < size; ++i)
  {
    packed[i] = right[i / 6 * PaddedSize<6> + i % 6];
  }
  ForParts(abortCheck, (aggregates + 31) / 32, PartsAtOnce,
    [&](std::size_t part)
    {
      for (std::size_t i = part * 192; i < std::min(size, (part + 1) * 192); ++i)
      {
        const Real* const row = &this->Inverse[i * size];
        constexpr std::size_t lanes = 8;
        Real sums[lanes] = {};
        std::size_t j = 0;
        for (; j + lanes <= size; j += lanes)
        {
          for (std::size_t lane = 0; lane < lanes; ++lane)
          {
            sums[lane] += row[j + lane] * packed[j + lane];
          }
        }
        Real sum = Real(0);
        for (; j < size; ++j)
        {
          sum += row[j] * packed[j];
        }
        for (const Real value : sums)
        {
          sum += value;
        }
        solution[i / 6 * PaddedSize<6> + i % 6] = sum;
      }
    });
}

template <typename Real>
void Multigrid<Real>::SolveCoarse(AbortCheck& abortCheck, std::size_t level)
{
  MultigridLevel<Real, 6>& coarse = this->Coarse[level];
  if (level + 1 == this->Coarse.size())
  {
    if (this->Inverse.empty())
    {
      ForRows(abortCheck, coarse.Right.size() / PaddedSize<6>,
        [&](std::size_t begin, std::size_t end) { ApplySmoother(coarse, begin, end); });
      return;
    }
    this->SolveCoarsest(abortCheck, coarse.Right, coarse.Solution);
    return;
  }
  SmoothFirst(abortCheck, coarse);
  Restrict(abortCheck, coarse, this->Coarse[level + 1].Right);
  this->SolveCoarse(abortCheck, level + 1);
  SmoothLast(abortCheck, coarse, this->Coarse[level + 1].Solution);
}

template <typename Real>
void Multigrid<Real>::Apply(AbortCheck& abortCheck, const std::vector<glm::dvec3>& vector,
  double size, std::vector<glm::dvec3>& result)
{
  // Scale the vector: residuals become smaller than the smallest float.
  const double scale = 1.0 / size;
  std::fill(result.begin(), result.end(), glm::dvec3(0.0));
  const std::size_t rows = this->FreeNodes.size();
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t row = begin; row < end; ++row)
      {
        // glm: v * M is the transposed matrix times the vector.
        const glm::dvec3 value =
          scale * vector[static_cast<std::size_t>(this->FreeNodes[row])] * this->Rotations[row];
        Real* const right = &this->Fine.Right[row * PaddedSize<3>];
        right[0] = static_cast<Real>(value.x);
        right[1] = static_cast<Real>(value.y);
        right[2] = static_cast<Real>(value.z);
      }
    });
  SmoothFirst(abortCheck, this->Fine);
  Restrict(abortCheck, this->Fine, this->Coarse.front().Right);
  this->SolveCoarse(abortCheck, 0);
  SmoothLast(abortCheck, this->Fine, this->Coarse.front().Solution);
  ForRows(abortCheck, rows,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t row = begin; row < end; ++row)
      {
        const Real* const solution = &this->Fine.Solution[row * PaddedSize<3>];
        result[static_cast<std::size_t>(this->FreeNodes[row])] =
          size * (this->Rotations[row] * glm::dvec3(solution[0], solution[1], solution[2]));
      }
    });
}

template class Multigrid<float>;
template class Multigrid<double>;

} // namespace deformvolume
