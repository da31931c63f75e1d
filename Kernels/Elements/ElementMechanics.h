// SPDX-License-Identifier: BSD-3-Clause
// Elasticity of batches of ten-node tetrahedra, as inline functions of lanes (Lanes.h).
#ifndef DeformVolumeElementMechanics_h
#define DeformVolumeElementMechanics_h

#include "ElementBatches.h"
#include "Lanes.h"
#include "MaterialModel.h"
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

/// The barycentric coordinate of a corner at a Gauss point.
constexpr double GetGaussCoordinate(int point, int corner)
{
  return point == corner ? QuadraticTetrahedron::NearCoordinate
                         : QuadraticTetrahedron::FarCoordinate;
}

constexpr double FarFactor = 4.0 * QuadraticTetrahedron::FarCoordinate;
constexpr double NearFactor =
  4.0 * (QuadraticTetrahedron::NearCoordinate - QuadraticTetrahedron::FarCoordinate);

/// The deformation of a batch at one Gauss point.
struct LanePoint
{
  /// F - 1, where F is the deformation gradient. Storing F itself would lose small displacements to
  /// rounding.
  LaneMatrix Gradient;
  /// The cofactors of F minus 1. The cofactors are the derivatives of det F.
  LaneMatrix Cofactors;
  /// det F - 1, and the part of it that is not linear in F - 1.
  Lanes Dilatation;
  Lanes NonlinearDilatation;
};

DEFORMVOLUME_ALWAYS_INLINE LaneMatrix Transpose(const LaneMatrix& a)
{
  return { { { a.Columns[0].X, a.Columns[1].X, a.Columns[2].X },
    { a.Columns[0].Y, a.Columns[1].Y, a.Columns[2].Y },
    { a.Columns[0].Z, a.Columns[1].Z, a.Columns[2].Z } } };
}

/// Adds a multiple of the identity to a matrix.
DEFORMVOLUME_ALWAYS_INLINE LaneMatrix AddToDiagonal(const LaneMatrix& a, const Lanes& value)
{
  return { { { a.Columns[0].X + value, a.Columns[0].Y, a.Columns[0].Z },
    { a.Columns[1].X, a.Columns[1].Y + value, a.Columns[1].Z },
    { a.Columns[2].X, a.Columns[2].Y, a.Columns[2].Z + value } } };
}

DEFORMVOLUME_ALWAYS_INLINE LanePoint MakePoint(const LaneMatrix& gradient)
{
  const LaneVector* const c = gradient.Columns;
  const LaneMatrix cofactors = { { Cross(c[1], c[2]), Cross(c[2], c[0]), Cross(c[0], c[1]) } };
  const Lanes trace = c[0].X + c[1].Y + c[2].Z;
  const LaneMatrix transposed = Transpose(gradient);
  LanePoint point;
  point.Gradient = gradient;
  for (int j = 0; j < 3; ++j)
  {
    point.Cofactors.Columns[j] = Subtract(cofactors.Columns[j], transposed.Columns[j]);
  }
  point.Cofactors = AddToDiagonal(point.Cofactors, trace);
  point.NonlinearDilatation = cofactors.Columns[0].X + cofactors.Columns[1].Y +
    cofactors.Columns[2].Z + Dot(c[0], cofactors.Columns[0]);
  point.Dilatation = trace + point.NonlinearDilatation;
  return point;
}

/// The deformation of a batch at all of its Gauss points.
struct LaneElement
{
  LanePoint Points[ElementBatch::NumberOfGaussPoints];
  /// The mean of det F - 1 over the volume at rest, and MeanLambda times this mean.
  Lanes MeanDilatation;
  Lanes MeanPressure;
};

DEFORMVOLUME_ALWAYS_INLINE void FindElement(
  const ElementBatch& batch, const double* displacements, LaneElement& element)
{
  constexpr int points = ElementBatch::NumberOfGaussPoints;
  LaneVector u[ElementBatch::NumberOfNodes];
  for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
  {
    u[a] = GatherNode(batch.Nodes[a], displacements);
  }
  // The derivative of the displacement with respect to the coordinate of corner i is linear in the
  // barycentric coordinates. The coefficient of coordinate q is proportional to the difference of
  // two neighboring nodes. Each coordinate has one of two values at the Gauss points, so all
  // derivatives follow from one sum and these differences.
  LaneVector slopes[points][3];
  for (int i = 1; i < 4; ++i)
  {
    LaneVector differences[4];
    for (int q = 0; q < 4; ++q)
    {
      const int ahead = q == i ? i : BatchMiddle[i][q];
      const int behind = q == 0 ? 0 : BatchMiddle[0][q];
      differences[q] = Subtract(u[ahead], u[behind]);
    }
    const LaneVector sum =
      Add(Add(differences[0], differences[1]), Add(differences[2], differences[3]));
    const LaneVector base = Add(Subtract(u[0], u[i]), Scale(sum, MakeLanes(FarFactor)));
    for (int point = 0; point < points; ++point)
    {
      slopes[point][i - 1] = Add(base, Scale(differences[point], MakeLanes(NearFactor)));
    }
  }
  Lanes dilatation = MakeLanes(0.0);
  for (int point = 0; point < points; ++point)
  {
    const LaneVector* const g = batch.Gradients[point];
    const LaneVector* const s = slopes[point];
    LaneMatrix H;
    H.Columns[0] = Add(Add(Scale(s[0], g[0].X), Scale(s[1], g[1].X)), Scale(s[2], g[2].X));
    H.Columns[1] = Add(Add(Scale(s[0], g[0].Y), Scale(s[1], g[1].Y)), Scale(s[2], g[2].Y));
    H.Columns[2] = Add(Add(Scale(s[0], g[0].Z), Scale(s[1], g[1].Z)), Scale(s[2], g[2].Z));
    element.Points[point] = MakePoint(H);
    dilatation = dilatation + batch.Volumes[point] * element.Points[point].Dilatation;
  }
  element.MeanDilatation = dilatation * batch.InverseVolume;
  element.MeanPressure = batch.MeanLambda * element.MeanDilatation;
}

/// The first Piola-Kirchhoff stress at a Gauss point, and the strain energy per volume at rest,
/// without the energy of the mean dilatation.
struct LaneStress
{
  LaneMatrix Piola;
  Lanes EnergyDensity;
};

/// The stable neo-Hookean model without a logarithmic term. Its energy density is
/// mu/2 (|F|^2 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2, where J = det F.
DEFORMVOLUME_ALWAYS_INLINE LaneStress FindNeoHookeanStress(
  const ElementBatch& batch, const LanePoint& point, const Lanes& meanPressure)
{
  const Lanes stiffness = batch.Lambda + batch.Mu;
  const Lanes pressure = stiffness * point.Dilatation + meanPressure;
  LaneStress result;
  Lanes squared = MakeLanes(0.0);
  for (int j = 0; j < 3; ++j)
  {
    const LaneVector& h = point.Gradient.Columns[j];
    const LaneVector& c = point.Cofactors.Columns[j];
    squared = squared + Dot(h, h);
    result.Piola.Columns[j] = Add(Scale(Subtract(h, c), batch.Mu), Scale(c, pressure));
  }
  result.Piola = AddToDiagonal(result.Piola, pressure);
  result.EnergyDensity = batch.Mu * (0.5 * squared - point.NonlinearDilatation) +
    0.5 * stiffness * point.Dilatation * point.Dilatation;
  return result;
}

/// The corotational model. Its energy density is mu |F - R|^2 + lambda/2 tr(S - 1)^2, where F = R
/// S.
DEFORMVOLUME_ALWAYS_INLINE LaneStress FindCorotationalStress(
  const ElementBatch& batch, const LanePoint& point, const Lanes& meanPressure)
{
  const LaneMatrix F = AddToDiagonal(point.Gradient, MakeLanes(1.0));
  const SingularValues values = FindSingularValues(F);
  const Lanes trace =
    (values.Values[0] - 1.0) + (values.Values[1] - 1.0) + (values.Values[2] - 1.0);
  const Lanes spherical = batch.Lambda * trace;
  const Lanes twiceMu = 2.0 * batch.Mu;
  const LaneMatrix rows = Transpose(values.V);
  LaneStress result;
  Lanes squared = MakeLanes(0.0);
  for (int j = 0; j < 3; ++j)
  {
    const LaneVector rotation = Multiply(values.U, rows.Columns[j]);
    const LaneVector stretch = Subtract(F.Columns[j], rotation);
    squared = squared + Dot(stretch, stretch);
    result.Piola.Columns[j] = Add(Add(Scale(stretch, twiceMu), Scale(rotation, spherical)),
      Scale(point.Cofactors.Columns[j], meanPressure));
  }
  result.Piola = AddToDiagonal(result.Piola, meanPressure);
  result.EnergyDensity = batch.Mu * squared + 0.5 * spherical * trace;
  return result;
}

template <MaterialModel Model>
DEFORMVOLUME_ALWAYS_INLINE LaneStress FindStress(
  const ElementBatch& batch, const LanePoint& point, const Lanes& meanPressure)
{
  if constexpr (Model == MaterialModel::Corotational)
  {
    return FindCorotationalStress(batch, point, meanPressure);
  }
  return FindNeoHookeanStress(batch, point, meanPressure);
}

/// Computes the forces on the nodes of a batch from the stresses at its Gauss points. This is the
/// transpose of the linear map from displacements to F - 1 in FindElement.
DEFORMVOLUME_ALWAYS_INLINE void FindNodeForces(const ElementBatch& batch,
  const LaneMatrix (&stresses)[ElementBatch::NumberOfGaussPoints],
  LaneVector (&forces)[ElementBatch::NumberOfNodes])
{
  constexpr int points = ElementBatch::NumberOfGaussPoints;
  const Lanes zero = MakeLanes(0.0);
  for (LaneVector& force : forces)
  {
    force = { zero, zero, zero };
  }
  for (int i = 1; i < 4; ++i)
  {
    LaneVector pulls[points];
    LaneVector sum = { zero, zero, zero };
    for (int point = 0; point < points; ++point)
    {
      pulls[point] =
        Scale(Multiply(stresses[point], batch.Gradients[point][i - 1]), batch.Volumes[point]);
      sum = Add(sum, pulls[point]);
    }
    forces[0] = Add(forces[0], sum);
    forces[i] = Subtract(forces[i], sum);
    for (int q = 0; q < 4; ++q)
    {
      const int ahead = q == i ? i : BatchMiddle[i][q];
      const int behind = q == 0 ? 0 : BatchMiddle[0][q];
      const LaneVector pull =
        Add(Scale(sum, MakeLanes(FarFactor)), Scale(pulls[q], MakeLanes(NearFactor)));
      forces[ahead] = Add(forces[ahead], pull);
      forces[behind] = Subtract(forces[behind], pull);
    }
  }
}

/// The blocks of the tangent matrix of a batch, each by columns, in the order of node pairs 0 0, 0
/// 1, ..., 0 9, 1 1, 1 2, ..., 9 9.
struct LaneTangent
{
  static constexpr int NumberOfBlocks =
    ElementBatch::NumberOfNodes * (ElementBatch::NumberOfNodes + 1) / 2;
  LaneMatrix Blocks[NumberOfBlocks];
};

DEFORMVOLUME_ALWAYS_INLINE void AddProduct(
  LaneMatrix& sum, const LaneVector& scaled, const LaneVector& b)
{
  sum.Columns[0] = Add(sum.Columns[0], Scale(scaled, b.X));
  sum.Columns[1] = Add(sum.Columns[1], Scale(scaled, b.Y));
  sum.Columns[2] = Add(sum.Columns[2], Scale(scaled, b.Z));
}

/// A vector for each node of a batch.
struct LaneNodes
{
  LaneVector Vectors[ElementBatch::NumberOfNodes];
};

/// Adds factor * v_a v_b^T to the block of each pair of nodes a and b.
DEFORMVOLUME_ALWAYS_INLINE void AddProducts(
  LaneTangent& tangent, const LaneNodes& nodes, const Lanes& factor)
{
  LaneMatrix* block = tangent.Blocks;
  for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
  {
    const LaneVector scaled = Scale(nodes.Vectors[a], factor);
    for (int b = a; b < ElementBatch::NumberOfNodes; ++b, ++block)
    {
      AddProduct(*block, scaled, nodes.Vectors[b]);
    }
  }
}

/// Returns the gradients of the shape functions of all nodes at a Gauss point.
DEFORMVOLUME_ALWAYS_INLINE LaneNodes FindShapeGradients(const ElementBatch& batch, int point)
{
  const LaneVector* const g = batch.Gradients[point];
  const LaneVector corners[4] = { Scale(Add(Add(g[0], g[1]), g[2]), MakeLanes(-1.0)), g[0], g[1],
    g[2] };
  LaneNodes result;
  for (int a = 0; a < 4; ++a)
  {
    result.Vectors[a] = Scale(corners[a], MakeLanes(4.0 * GetGaussCoordinate(point, a) - 1.0));
  }
  for (int edge = 0; edge < 6; ++edge)
  {
    const int a = BatchEdges[edge][0];
    const int b = BatchEdges[edge][1];
    result.Vectors[4 + edge] = Add(Scale(corners[a], MakeLanes(4.0 * GetGaussCoordinate(point, b))),
      Scale(corners[b], MakeLanes(4.0 * GetGaussCoordinate(point, a))));
  }
  return result;
}

DEFORMVOLUME_ALWAYS_INLINE LaneNodes MultiplyNodes(const LaneMatrix& matrix, const LaneNodes& nodes)
{
  LaneNodes result;
  for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
  {
    result.Vectors[a] = Multiply(matrix, nodes.Vectors[a]);
  }
  return result;
}

/// Adds the second derivatives of same/2 |F|^2 + cross det F + outer/2 (det F - 1)^2. For the last
/// term, only the product of first derivatives of det F is added; `cross` must include the rest.
/// cofactors: the cofactors of F times the gradients.
DEFORMVOLUME_ALWAYS_INLINE void AddInvariants(LaneTangent& tangent, const LaneNodes& gradients,
  const LaneMatrix& F, const LaneNodes& cofactors, const Lanes& same, const Lanes& cross,
  const Lanes& outer)
{
  LaneMatrix* block = tangent.Blocks;
  for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
  {
    const LaneVector scaled = Scale(cofactors.Vectors[a], outer);
    const LaneVector& g = gradients.Vectors[a];
    for (int b = a; b < ElementBatch::NumberOfNodes; ++b, ++block)
    {
      LaneMatrix sum = *block;
      AddProduct(sum, scaled, cofactors.Vectors[b]);
      const Lanes diagonal = same * Dot(g, gradients.Vectors[b]);
      const LaneVector v = Scale(Multiply(F, Cross(g, gradients.Vectors[b])), cross);
      sum.Columns[0] = { sum.Columns[0].X + diagonal, sum.Columns[0].Y - v.Z,
        sum.Columns[0].Z + v.Y };
      sum.Columns[1] = { sum.Columns[1].X + v.Z, sum.Columns[1].Y + diagonal,
        sum.Columns[1].Z - v.X };
      sum.Columns[2] = { sum.Columns[2].X - v.Y, sum.Columns[2].Y + v.X,
        sum.Columns[2].Z + diagonal };
      *block = sum;
    }
  }
}

DEFORMVOLUME_ALWAYS_INLINE bool HasPositive(const Lanes& a)
{
  return a[0] > 0.0 || a[1] > 0.0 || a[2] > 0.0 || a[3] > 0.0;
}

/// Returns max(0, -value): the amount that raises a negative value to 0.
DEFORMVOLUME_ALWAYS_INLINE Lanes MissingToZero(const Lanes& value)
{
  return Largest(MakeLanes(0.0), -value);
}

/// The second derivatives of the energy density with respect to F, in the basis of the singular
/// vectors of F: twists and shears in three planes, and stretches along three axes.
struct LaneEigenvalues
{
  Lanes Twists[3];
  Lanes Shears[3];
  Lanes Stretches[3]; // second derivatives with respect to one stretch
  Lanes Mixed[3];     // mixed second derivatives with respect to the two other stretches
};

// The two axes that span the plane normal to each axis.
constexpr int FirstOfPlane[3] = { 1, 2, 0 };
constexpr int SecondOfPlane[3] = { 2, 0, 1 };

/// Returns the twist (sign -1) or shear (sign 1) mode of a plane for each node.
DEFORMVOLUME_ALWAYS_INLINE LaneNodes FindPlaneModes(
  const LaneMatrix& U, const LaneNodes& gradientsInFrame, int plane, double sign)
{
  LaneNodes result;
  const LaneVector& first = U.Columns[FirstOfPlane[plane]];
  const LaneVector& second = U.Columns[SecondOfPlane[plane]];
  for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
  {
    const LaneVector& g = gradientsInFrame.Vectors[a];
    const Lanes components[3] = { g.X, g.Y, g.Z };
    result.Vectors[a] = Add(Scale(first, components[SecondOfPlane[plane]]),
      Scale(second, sign * components[FirstOfPlane[plane]]));
  }
  return result;
}

/// Adds the terms that raise negative eigenvalues to 0, multiplied by a volume.
DEFORMVOLUME_ALWAYS_INLINE void AddMissing(LaneTangent& tangent, const SingularValues& values,
  const LaneNodes& gradientsInFrame, const LaneEigenvalues& e, const Lanes& volume)
{
  for (int k = 0; k < 3; ++k)
  {
    const Lanes twist = MissingToZero(e.Twists[k]);
    if (HasPositive(twist))
    {
      AddProducts(
        tangent, FindPlaneModes(values.U, gradientsInFrame, k, -1.0), 0.5 * volume * twist);
    }
    const Lanes shear = MissingToZero(e.Shears[k]);
    if (HasPositive(shear))
    {
      AddProducts(
        tangent, FindPlaneModes(values.U, gradientsInFrame, k, 1.0), 0.5 * volume * shear);
    }
  }
  // Diagonalize the 3 x 3 matrix of stretches by Jacobi rotations, as in FindSingularValues.
  constexpr int sweeps = 4;
  const Lanes zero = MakeLanes(0.0);
  const Lanes one = MakeLanes(1.0);
  LaneProducts s = { e.Stretches[0], e.Stretches[1], e.Stretches[2], e.Mixed[2], e.Mixed[0],
    e.Mixed[1] };
  LaneMatrix axes = { { { one, zero, zero }, { zero, one, zero }, { zero, zero, one } } };
  for (int sweep = 0; sweep < sweeps; ++sweep)
  {
    RotateColumns(s.XX, s.YY, s.XY, s.XZ, s.YZ, axes.Columns[0], axes.Columns[1]);
    RotateColumns(s.YY, s.ZZ, s.YZ, s.XY, s.XZ, axes.Columns[1], axes.Columns[2]);
    RotateColumns(s.XX, s.ZZ, s.XZ, s.XY, s.YZ, axes.Columns[0], axes.Columns[2]);
  }
  const Lanes stretches[3] = { s.XX, s.YY, s.ZZ };
  for (int k = 0; k < 3; ++k)
  {
    const Lanes stretch = MissingToZero(stretches[k]);
    if (HasPositive(stretch))
    {
      LaneNodes modes;
      const LaneVector& axis = axes.Columns[k];
      for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
      {
        const LaneVector& g = gradientsInFrame.Vectors[a];
        modes.Vectors[a] = Multiply(values.U, { axis.X * g.X, axis.Y * g.Y, axis.Z * g.Z });
      }
      AddProducts(tangent, modes, volume * stretch);
    }
  }
}

DEFORMVOLUME_ALWAYS_INLINE LaneNodes TurnIntoFrame(
  const SingularValues& values, const LaneNodes& gradients)
{
  LaneNodes result;
  for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
  {
    result.Vectors[a] = MultiplyTransposed(values.V, gradients.Vectors[a]);
  }
  return result;
}

/// The eigenvalues for same/2 |F|^2 + cross det F + outer/2 (det F - 1)^2, with the last term
/// treated as in AddInvariants.
DEFORMVOLUME_ALWAYS_INLINE LaneEigenvalues FindInvariantEigenvalues(
  const SingularValues& values, const Lanes& same, const Lanes& cross, const Lanes& outer)
{
  const Lanes* s = values.Values;
  LaneEigenvalues e;
  const Lanes products[3] = { s[1] * s[2], s[2] * s[0], s[0] * s[1] };
  for (int k = 0; k < 3; ++k)
  {
    e.Twists[k] = same + cross * s[k];
    e.Shears[k] = same - cross * s[k];
    e.Stretches[k] = same + outer * products[k] * products[k];
    e.Mixed[k] = cross * s[k] + outer * products[FirstOfPlane[k]] * products[SecondOfPlane[k]];
  }
  return e;
}

DEFORMVOLUME_ALWAYS_INLINE void AddNeoHookeanPoint(LaneTangent& tangent, const ElementBatch& batch,
  const LanePoint& point, const LaneNodes& gradients, const LaneNodes& cofactors,
  const Lanes& volume, const Lanes& meanPressure, bool isClamped)
{
  const LaneMatrix F = AddToDiagonal(point.Gradient, MakeLanes(1.0));
  const Lanes outer = batch.Lambda + batch.Mu;
  const Lanes cross = outer * point.Dilatation + meanPressure - batch.Mu;
  AddInvariants(
    tangent, gradients, F, cofactors, volume * batch.Mu, volume * cross, volume * outer);
  if (isClamped)
  {
    const SingularValues values = FindSingularValues(F);
    AddMissing(tangent, values, TurnIntoFrame(values, gradients),
      FindInvariantEigenvalues(values, batch.Mu, cross, outer), volume);
  }
}

DEFORMVOLUME_ALWAYS_INLINE void AddCorotationalPoint(LaneTangent& tangent,
  const ElementBatch& batch, const LanePoint& point, const LaneNodes& gradients,
  const LaneNodes& cofactors, const Lanes& volume, const Lanes& meanPressure, bool isClamped)
{
  const LaneMatrix F = AddToDiagonal(point.Gradient, MakeLanes(1.0));
  const SingularValues values = FindSingularValues(F);
  const LaneNodes inFrame = TurnIntoFrame(values, gradients);
  const Lanes twiceMu = 2.0 * batch.Mu;
  AddInvariants(
    tangent, gradients, F, cofactors, volume * twiceMu, volume * meanPressure, MakeLanes(0.0));
  AddProducts(tangent, MultiplyNodes(values.U, inFrame), volume * batch.Lambda);
  const Lanes* s = values.Values;
  const Lanes pull = batch.Lambda * ((s[0] - 1.0) + (s[1] - 1.0) + (s[2] - 1.0)) - twiceMu;
  LaneEigenvalues e = FindInvariantEigenvalues(values, twiceMu, meanPressure, MakeLanes(0.0));
  for (int k = 0; k < 3; ++k)
  {
    // The rotation R changes without bounds as two singular values approach opposite values, in
    // nearly flat or inverted tetrahedra. The denominator and the result are limited.
    const Lanes sum = Largest(s[FirstOfPlane[k]] + s[SecondOfPlane[k]], MakeLanes(1e-3));
    const Lanes more = Largest(-twiceMu, pull * (2.0 / sum));
    AddProducts(tangent, FindPlaneModes(values.U, inFrame, k, -1.0), 0.5 * volume * more);
    e.Twists[k] = e.Twists[k] + more;
    e.Stretches[k] = e.Stretches[k] + batch.Lambda;
    e.Mixed[k] = e.Mixed[k] + batch.Lambda;
  }
  if (isClamped)
  {
    AddMissing(tangent, values, inFrame, e, volume);
  }
}

/// Computes the second derivatives of the strain energy with respect to the positions of the nodes.
/// isClamped: at each Gauss point, negative eigenvalues are replaced by 0 (Smith, de Goes and Kim
/// 2019), so that the tangent has no negative eigenvalues.
template <MaterialModel Model>
DEFORMVOLUME_ALWAYS_INLINE void FindTangent(
  const ElementBatch& batch, const LaneElement& element, bool isClamped, LaneTangent& tangent)
{
  const Lanes zero = MakeLanes(0.0);
  for (LaneMatrix& block : tangent.Blocks)
  {
    block = { { { zero, zero, zero }, { zero, zero, zero }, { zero, zero, zero } } };
  }
  LaneNodes dilatation; // derivatives of the mean dilatation, times the volume
  for (LaneVector& vector : dilatation.Vectors)
  {
    vector = { zero, zero, zero };
  }
  for (int i = 0; i < ElementBatch::NumberOfGaussPoints; ++i)
  {
    const LanePoint& point = element.Points[i];
    const LaneNodes gradients = FindShapeGradients(batch, i);
    const LaneNodes cofactors =
      MultiplyNodes(AddToDiagonal(point.Cofactors, MakeLanes(1.0)), gradients);
    for (int a = 0; a < ElementBatch::NumberOfNodes; ++a)
    {
      dilatation.Vectors[a] =
        Add(dilatation.Vectors[a], Scale(cofactors.Vectors[a], batch.Volumes[i]));
    }
    if constexpr (Model == MaterialModel::Corotational)
    {
      AddCorotationalPoint(tangent, batch, point, gradients, cofactors, batch.Volumes[i],
        element.MeanPressure, isClamped);
    }
    else
    {
      AddNeoHookeanPoint(tangent, batch, point, gradients, cofactors, batch.Volumes[i],
        element.MeanPressure, isClamped);
    }
  }
  AddProducts(tangent, dilatation, batch.MeanLambda * batch.InverseVolume);
}

} // namespace deformvolume

#endif
