// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSingularValues_h
#define DeformVolumeSingularValues_h

#include "Lanes.h"

namespace deformvolume
{

/// The singular value decomposition F = U diag(Values) V^T, where U and V are rotations. The values
/// are in descending order. The last one has the sign of det F, so that U V^T is the rotation
/// nearest to F.
struct SingularValues
{
  LaneMatrix U;
  LaneMatrix V;
  Lanes Values[3];
};

/// The scalar products of the columns of a matrix.
struct LaneProducts
{
  Lanes XX, YY, ZZ, XY, YZ, XZ;
};

/// A Jacobi rotation of the columns p and q that makes their product 0. The angle is at most 45
/// degrees.
DEFORMVOLUME_ALWAYS_INLINE void RotateColumns(
  Lanes& pp, Lanes& qq, Lanes& pq, Lanes& pr, Lanes& qr, LaneVector& p, LaneVector& q)
{
  const Lanes difference = qq - pp;
  const Lanes twice = 2.0 * pq;
  const Lanes root = SquareRoot(difference * difference + twice * twice);
  // If difference and root are both 0, the columns are not rotated. The minimum avoids a division
  // by 0.
  const Lanes denominator = Largest(Absolute(difference) + root, MakeLanes(1e-300));
  const Lanes tangent = (difference < 0.0 ? -twice : twice) / denominator;
  const Lanes cosine = 1.0 / SquareRoot(1.0 + tangent * tangent);
  const Lanes sine = tangent * cosine;
  pp = pp - tangent * pq;
  qq = qq + tangent * pq;
  pq = MakeLanes(0.0);
  const Lanes turned = cosine * pr - sine * qr;
  qr = sine * pr + cosine * qr;
  pr = turned;
  const LaneVector turnedColumn = Subtract(Scale(p, cosine), Scale(q, sine));
  q = Add(Scale(p, sine), Scale(q, cosine));
  p = turnedColumn;
}

DEFORMVOLUME_ALWAYS_INLINE LaneVector Choose(
  const Lanes& a, const Lanes& b, const LaneVector& whereLess, const LaneVector& otherwise)
{
  return { a < b ? whereLess.X : otherwise.X, a < b ? whereLess.Y : otherwise.Y,
    a < b ? whereLess.Z : otherwise.Z };
}

/// Exchanges two columns if the first one is shorter. One of the two changes its sign, so that V
/// stays a rotation.
DEFORMVOLUME_ALWAYS_INLINE void SortColumns(
  Lanes& a, Lanes& b, LaneVector& p, LaneVector& q, LaneVector& v, LaneVector& w)
{
  const LaneVector minusP = Scale(p, MakeLanes(-1.0));
  const LaneVector minusV = Scale(v, MakeLanes(-1.0));
  const LaneVector first = Choose(a, b, q, p);
  q = Choose(a, b, minusP, q);
  p = first;
  const LaneVector firstOfV = Choose(a, b, w, v);
  w = Choose(a, b, minusV, w);
  v = firstOfV;
  const Lanes larger = Largest(a, b);
  b = a < b ? a : b;
  a = larger;
}

DEFORMVOLUME_ALWAYS_INLINE SingularValues FindSingularValues(const LaneMatrix& matrix)
{
  // Jacobi's method converges quadratically: after four sweeps, often earlier, the off-diagonal
  // elements are below rounding.
  constexpr int sweeps = 4;
  constexpr double rounding = 1e-33;
  SingularValues result;
  const Lanes zero = MakeLanes(0.0);
  const Lanes one = MakeLanes(1.0);
  LaneMatrix& V = result.V;
  V = { { { one, zero, zero }, { zero, one, zero }, { zero, zero, one } } };
  const LaneVector* columns = matrix.Columns;
  LaneProducts s = { Dot(columns[0], columns[0]), Dot(columns[1], columns[1]),
    Dot(columns[2], columns[2]), Dot(columns[0], columns[1]), Dot(columns[1], columns[2]),
    Dot(columns[0], columns[2]) };
  for (int sweep = 0; sweep < sweeps; ++sweep)
  {
    RotateColumns(s.XX, s.YY, s.XY, s.XZ, s.YZ, V.Columns[0], V.Columns[1]);
    RotateColumns(s.YY, s.ZZ, s.YZ, s.XY, s.XZ, V.Columns[1], V.Columns[2]);
    RotateColumns(s.XX, s.ZZ, s.XZ, s.XY, s.YZ, V.Columns[0], V.Columns[2]);
    const Lanes rest = s.XY * s.XY + s.YZ * s.YZ + s.XZ * s.XZ;
    const Lanes trace = s.XX + s.YY + s.ZZ;
    const Lanes limit = rounding * trace * trace;
    if (rest[0] <= limit[0] && rest[1] <= limit[1] && rest[2] <= limit[2] && rest[3] <= limit[3])
    {
      break;
    }
  }
  LaneVector b[3] = { Multiply(matrix, V.Columns[0]), Multiply(matrix, V.Columns[1]),
    Multiply(matrix, V.Columns[2]) };
  Lanes n[3] = { Dot(b[0], b[0]), Dot(b[1], b[1]), Dot(b[2], b[2]) };
  SortColumns(n[0], n[1], b[0], b[1], V.Columns[0], V.Columns[1]);
  SortColumns(n[0], n[2], b[0], b[2], V.Columns[0], V.Columns[2]);
  SortColumns(n[1], n[2], b[1], b[2], V.Columns[1], V.Columns[2]);

  // U by Gram-Schmidt orthogonalization. The last column of U is a cross product.
  LaneMatrix& U = result.U;
  const Lanes least = MakeLanes(1e-290);
  result.Values[0] = SquareRoot(n[0]);
  U.Columns[0] =
    Choose(n[0], least, V.Columns[0], Scale(b[0], one / SquareRoot(Largest(n[0], least))));
  LaneVector second = Subtract(b[1], Scale(U.Columns[0], Dot(U.Columns[0], b[1])));
  second = Subtract(second, Scale(U.Columns[0], Dot(U.Columns[0], second)));
  const Lanes squared = Dot(second, second);
  // If the second column is only rounding error, it has no direction: take any direction normal to
  // the first column.
  const LaneVector& u = U.Columns[0];
  const LaneVector across = Choose(
    Absolute(u.X), MakeLanes(0.6), LaneVector{ zero, -u.Z, u.Y }, LaneVector{ u.Z, zero, -u.X });
  const Lanes limit = Largest(1e-28 * n[0], least);
  const LaneVector direction = Choose(squared, limit, across, second);
  U.Columns[1] = Scale(direction, one / SquareRoot(Dot(direction, direction)));
  result.Values[1] = Dot(U.Columns[1], b[1]);
  U.Columns[2] = Cross(U.Columns[0], U.Columns[1]);
  result.Values[2] = Dot(U.Columns[2], b[2]);
  return result;
}

} // namespace deformvolume

#endif
