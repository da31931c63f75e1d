// SPDX-License-Identifier: BSD-3-Clause
// Vectors of integers of 64 bits, for arithmetic that is exact.

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
