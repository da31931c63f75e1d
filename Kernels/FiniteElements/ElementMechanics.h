// SPDX-License-Identifier: BSD-3-Clause
// What a batch of tetrahedra does when it is deformed, for functions of lanes.
#ifndef DeformVolumeElementMechanics_h
#define DeformVolumeElementMechanics_h

#include "ElementBatches.h"
#include "Lanes.h"
#include "SingularValues.h"

#include <cstddef>

namespace deformvolume
{

DEFORMVOLUME_ALWAYS_INLINE LaneVector GatherNode(const std::int32_t* nodes, const double* vectors)
{
  LaneVector result;
  const double* const v[NumberOfLanes] = { vectors + 3 * static_cast<std::size_t>(nodes[0]),
    vectors + 3 * static_cast<std::size_t>(nodes[1]),
    vectors + 3 * static_cast<std::size_t>(nodes[2]),
    vectors + 3 * static_cast<std::size_t>(nodes[3]) };
  result.X = Lanes{ v[0][0], v[1][0], v[2][0], v[3][0] };
  result.Y = Lanes{ v[0][1], v[1][1], v[2][1], v[3][1] };
  result.Z = Lanes{ v[0][2], v[1][2], v[2][2], v[3][2] };
  return result;
}

/// F, from displacements: what is small in them is not lost beside the positions.
DEFORMVOLUME_ALWAYS_INLINE LaneMatrix FindDeformationGradient(
  const ElementBatch& batch, const double* displacements)
{
  const LaneVector origin = GatherNode(batch.Nodes[0], displacements);
  const LaneVector edges[3] = { Subtract(GatherNode(batch.Nodes[1], displacements), origin),
    Subtract(GatherNode(batch.Nodes[2], displacements), origin),
    Subtract(GatherNode(batch.Nodes[3], displacements), origin) };
  const LaneVector* g = batch.Gradients;
  LaneMatrix F;
  F.Columns[0] =
    Add(Add(Scale(edges[0], g[0].X), Scale(edges[1], g[1].X)), Scale(edges[2], g[2].X));
  F.Columns[1] =
    Add(Add(Scale(edges[0], g[0].Y), Scale(edges[1], g[1].Y)), Scale(edges[2], g[2].Y));
  F.Columns[2] =
    Add(Add(Scale(edges[0], g[0].Z), Scale(edges[1], g[1].Z)), Scale(edges[2], g[2].Z));
  F.Columns[0].X = F.Columns[0].X + 1.0;
  F.Columns[1].Y = F.Columns[1].Y + 1.0;
  F.Columns[2].Z = F.Columns[2].Z + 1.0;
  return F;
}

/// The first Piola-Kirchhoff stress, and the strain energy for each volume at rest.
struct LaneStress
{
  LaneMatrix Piola;
  Lanes EnergyDensity;
};

DEFORMVOLUME_ALWAYS_INLINE LaneStress FindStress(
  const ElementBatch& batch, const LaneMatrix& F, const SingularValues& values)
{
  const Lanes trace =
    (values.Values[0] - 1.0) + (values.Values[1] - 1.0) + (values.Values[2] - 1.0);
  const Lanes spherical = batch.Lambda * trace;
  const Lanes twiceMu = 2.0 * batch.Mu;
  const LaneMatrix& U = values.U;
  const LaneMatrix& V = values.V;
  // The columns of V^T.
  const LaneVector rows[3] = { { V.Columns[0].X, V.Columns[1].X, V.Columns[2].X },
    { V.Columns[0].Y, V.Columns[1].Y, V.Columns[2].Y },
    { V.Columns[0].Z, V.Columns[1].Z, V.Columns[2].Z } };
  LaneStress result;
  Lanes squared = MakeLanes(0.0);
  for (int j = 0; j < 3; ++j)
  {
    const LaneVector rotation = Multiply(U, rows[j]);
    const LaneVector stretch = Subtract(F.Columns[j], rotation);
    squared = squared + Dot(stretch, stretch);
    result.Piola.Columns[j] = Add(Scale(stretch, twiceMu), Scale(rotation, spherical));
  }
  result.EnergyDensity = batch.Mu * squared + 0.5 * spherical * trace;
  return result;
}

/// The blocks of the tangent of a batch: those of nodes 0 1, 0 2, 0 3, 1 2, 1 3, 2 3, by columns,
/// and those of each node with itself.
struct LaneTangent
{
  LaneMatrix Mixed[6];
  LaneMatrix Own[4];
};

DEFORMVOLUME_ALWAYS_INLINE void AddProduct(
  LaneMatrix& sum, const LaneVector& a, const LaneVector& b, const Lanes& factor)
{
  const LaneVector scaled = Scale(a, factor);
  sum.Columns[0] = Add(sum.Columns[0], Scale(scaled, b.X));
  sum.Columns[1] = Add(sum.Columns[1], Scale(scaled, b.Y));
  sum.Columns[2] = Add(sum.Columns[2], Scale(scaled, b.Z));
}

DEFORMVOLUME_ALWAYS_INLINE LaneMatrix AddMatrices(const LaneMatrix& a, const LaneMatrix& b)
{
  return { { Add(a.Columns[0], b.Columns[0]), Add(a.Columns[1], b.Columns[1]),
    Add(a.Columns[2], b.Columns[2]) } };
}

DEFORMVOLUME_ALWAYS_INLINE LaneMatrix Transpose(const LaneMatrix& a)
{
  return { { { a.Columns[0].X, a.Columns[1].X, a.Columns[2].X },
    { a.Columns[0].Y, a.Columns[1].Y, a.Columns[2].Y },
    { a.Columns[0].Z, a.Columns[1].Z, a.Columns[2].Z } } };
}

DEFORMVOLUME_ALWAYS_INLINE LaneMatrix Negate(const LaneMatrix& a)
{
  const Lanes minus = MakeLanes(-1.0);
  return { { Scale(a.Columns[0], minus), Scale(a.Columns[1], minus), Scale(a.Columns[2], minus) } };
}

/// The second derivatives of the strain energy by the positions of the nodes, whose eigenvalues are
/// made 0 where they are less. In the frames of the singular values those of the energy density by
/// F are known: 2 mu, but for the three twists, and for the dilatation, which lambda adds.
DEFORMVOLUME_ALWAYS_INLINE void FindTangent(
  const ElementBatch& batch, const SingularValues& values, LaneTangent& tangent)
{
  const Lanes* s = values.Values;
  const Lanes twiceMu = 2.0 * batch.Mu * batch.Volume;
  const Lanes lambda = batch.Lambda * batch.Volume;
  const Lanes pull = lambda * ((s[0] - 1.0) + (s[1] - 1.0) + (s[2] - 1.0)) - twiceMu;
  constexpr int first[3] = { 1, 2, 0 };
  constexpr int second[3] = { 2, 0, 1 };
  Lanes twists[3];
  for (int k = 0; k < 3; ++k)
  {
    const Lanes sum = Largest(s[first[k]] + s[second[k]], MakeLanes(1e-3));
    const Lanes eigenvalue = Largest(MakeLanes(0.0), twiceMu + pull * (2.0 / sum));
    twists[k] = 0.5 * (eigenvalue - twiceMu);
  }
  // Of nodes 1 to 3: the gradients turned with the tetrahedron, and what the twists make of them.
  LaneVector turned[3];
  LaneVector twisted[3][3];
  for (int a = 0; a < 3; ++a)
  {
    const LaneVector g = MultiplyTransposed(values.V, batch.Gradients[a]);
    const Lanes components[3] = { g.X, g.Y, g.Z };
    turned[a] = Multiply(values.U, g);
    for (int k = 0; k < 3; ++k)
    {
      twisted[a][k] = Subtract(Scale(values.U.Columns[first[k]], components[second[k]]),
        Scale(values.U.Columns[second[k]], components[first[k]]));
    }
  }
  const Lanes zero = MakeLanes(0.0);
  LaneMatrix blocks[3][3];
  for (int a = 0; a < 3; ++a)
  {
    for (int b = a; b < 3; ++b)
    {
      const Lanes same = twiceMu * Dot(batch.Gradients[a], batch.Gradients[b]);
      LaneMatrix& block = blocks[a][b];
      block = { { { same, zero, zero }, { zero, same, zero }, { zero, zero, same } } };
      AddProduct(block, turned[a], turned[b], lambda);
      for (int k = 0; k < 3; ++k)
      {
        AddProduct(block, twisted[a][k], twisted[b][k], twists[k]);
      }
    }
  }
  // A translation causes no force: what belongs to node 0 is minus the sum of the others.
  for (int b = 0; b < 3; ++b)
  {
    LaneMatrix sum = blocks[b][b];
    for (int a = 0; a < 3; ++a)
    {
      if (a != b)
      {
        sum = AddMatrices(sum, a < b ? blocks[a][b] : Transpose(blocks[b][a]));
      }
    }
    tangent.Mixed[b] = Negate(sum);
    tangent.Own[b + 1] = blocks[b][b];
  }
  tangent.Mixed[3] = blocks[0][1];
  tangent.Mixed[4] = blocks[0][2];
  tangent.Mixed[5] = blocks[1][2];
  tangent.Own[0] =
    Negate(AddMatrices(AddMatrices(tangent.Mixed[0], tangent.Mixed[1]), tangent.Mixed[2]));
}

} // namespace deformvolume

#endif
