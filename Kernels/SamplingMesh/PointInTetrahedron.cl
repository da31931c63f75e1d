// SPDX-License-Identifier: BSD-3-Clause
// Location of a point of the volume at rest in the five tetrahedra of its cell. This text comes after
// IntegerVectors.cl.

// Whether a point lies in tetrahedron t of a cell, or on its surface. point: position in the cell, from 0 to `one` on
// each axis, mirrored by the parity of the cell. weights: if so, barycentric weights times a common factor.
static int IsInTetrahedron(int t, Vector point, long one, long* weights)
{
  const long x = point.x;
  const long y = point.y;
  const long z = point.z;
  switch (t)
  {
    case 0:
      weights[0] = one - z;
      weights[1] = z - x - y;
      weights[2] = x;
      weights[3] = y;
      return weights[1] >= 0;
    case 1:
      weights[0] = one - x;
      weights[1] = x + y + z - 2 * one;
      weights[2] = one - y;
      weights[3] = one - z;
      return weights[1] >= 0;
    case 2:
      weights[0] = z;
      weights[1] = x - y - z;
      weights[2] = one - x;
      weights[3] = y;
      return weights[1] >= 0;
    case 3:
      weights[0] = one - y;
      weights[1] = y - x - z;
      weights[2] = z;
      weights[3] = x;
      return weights[1] >= 0;
    default:
      weights[0] = y + z - x;
      weights[1] = x + z - y;
      weights[2] = x + y - z;
      weights[3] = 2 * one - x - y - z;
      return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0 && weights[3] >= 0;
  }
}
