// SPDX-License-Identifier: BSD-3-Clause
// Vectors of 64-bit integers, for exact arithmetic.

typedef struct
{
  long x, y, z;
} Vector;

static Vector Difference(int4 a, int4 b)
{
  const Vector r = { (long)a.x - b.x, (long)a.y - b.y, (long)a.z - b.z };
  return r;
}

static Vector Subtract(Vector a, Vector b)
{
  const Vector r = { a.x - b.x, a.y - b.y, a.z - b.z };
  return r;
}

static Vector Cross(Vector a, Vector b)
{
  const Vector r = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
  return r;
}

static long Dot(Vector a, Vector b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Computes the inward normals of the faces of a tetrahedron with the edges u, v and w from one vertex. normals: of the
// faces opposite the ends of u, v and w; last: of the face opposite the common vertex. The length of a normal is twice
// the area of its face; the four normals add up to 0. Returns six times the volume.
static long FindFaceNormals(Vector u, Vector v, Vector w, Vector* normals, Vector* last)
{
  normals[0] = Cross(v, w);
  normals[1] = Cross(w, u);
  normals[2] = Cross(u, v);
  long volume = Dot(u, normals[0]);
  if (volume < 0)
  {
    volume = -volume;
    for (int k = 0; k < 3; ++k)
    {
      normals[k].x = -normals[k].x;
      normals[k].y = -normals[k].y;
      normals[k].z = -normals[k].z;
    }
  }
  last->x = -(normals[0].x + normals[1].x + normals[2].x);
  last->y = -(normals[0].y + normals[1].y + normals[2].y);
  last->z = -(normals[0].z + normals[1].z + normals[2].z);
  return volume;
}

// Whether a shift by (e, e^2, e^3), for an infinitesimal e, moves a sample on the face to the inside (symbolic
// perturbation). Bit k of signs reverses the sign of component k of the shift.
static int ShiftsInside(Vector normal, int signs)
{
  const long along = normal.x ? (signs & 1 ? -normal.x : normal.x)
    : normal.y                ? (signs & 2 ? -normal.y : normal.y)
                              : (signs & 4 ? -normal.z : normal.z);
  return along > 0;
}
