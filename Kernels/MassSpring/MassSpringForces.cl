// SPDX-License-Identifier: BSD-3-Clause
// The forces of tetrahedra on their nodes. Their edges are springs, and their volume has an energy. The host defines
// before this text:
//   LANES  tetrahedra of a work-item: 16, 8 or 4 on CPUs, with LaneVectors.cl; otherwise 1
// Tetrahedra are stored in packets of LANES. A packet has the first values of all of its tetrahedra, then the second
// values, and so on.

#if LANES == 1
#define FLOATS float
#define INTS int
#endif

typedef struct
{
  FLOATS X, Y, Z;
} Vectors;

// Gathers p[i] for an index i in each lane.
#if LANES == 16 && defined(__AVX512F__)
#define GATHER(p, i)                                                                               \
  as_float16(__builtin_ia32_gathersiv16sf((FLOATS)0.0f, (const void*)(size_t)(p), i, (ushort)0xffff, 4))
#elif LANES == 16
#define GATHER(p, i)                                                                               \
  (float16)(p[i.s0], p[i.s1], p[i.s2], p[i.s3], p[i.s4], p[i.s5], p[i.s6], p[i.s7], p[i.s8],       \
    p[i.s9], p[i.sa], p[i.sb], p[i.sc], p[i.sd], p[i.se], p[i.sf])
#elif LANES == 8
#define GATHER(p, i)                                                                               \
  (float8)(p[i.s0], p[i.s1], p[i.s2], p[i.s3], p[i.s4], p[i.s5], p[i.s6], p[i.s7])
#elif LANES == 4
#define GATHER(p, i) (float4)(p[i.s0], p[i.s1], p[i.s2], p[i.s3])
#else
#define GATHER(p, i) p[i]
#endif

// The vectors that begin at given indices.
static Vectors GetVectors(__global const float* p, INTS begin)
{
  Vectors v;
  v.X = GATHER(p, begin);
  v.Y = GATHER((p + 1), begin);
  v.Z = GATHER((p + 2), begin);
  return v;
}

static Vectors Plus(Vectors a, Vectors b)
{
  a.X += b.X;
  a.Y += b.Y;
  a.Z += b.Z;
  return a;
}

static Vectors Minus(Vectors a, Vectors b)
{
  a.X -= b.X;
  a.Y -= b.Y;
  a.Z -= b.Z;
  return a;
}

static Vectors Times(Vectors a, FLOATS factor)
{
  a.X *= factor;
  a.Y *= factor;
  a.Z *= factor;
  return a;
}

static FLOATS Dot(Vectors a, Vectors b)
{
  return a.X * b.X + a.Y * b.Y + a.Z * b.Z;
}

static Vectors Cross(Vectors a, Vectors b)
{
  Vectors c;
  c.X = a.Y * b.Z - a.Z * b.Y;
  c.Y = a.Z * b.X - a.X * b.Z;
  c.Z = a.X * b.Y - a.Y * b.X;
  return c;
}

// The force of a spring on its first end. It is computed from the displacement, which can be far smaller than the
// coordinates. Therefore the force is exactly 0 at rest, and accurate near it.
static Vectors SpringForce(Vectors rest, Vectors displacement, FLOATS stiffness)
{
  const Vectors now = Plus(rest, displacement);
  const FLOATS restLength = sqrt(Dot(rest, rest));
  // A spring of length 0 has no direction and exerts no force.
  const FLOATS length = sqrt(Dot(now, now)) + 1e-30f;
  const FLOATS lengthening = Dot(displacement, Plus(Plus(rest, rest), displacement)) / (length + restLength);
  return Times(now, stiffness * lengthening / length);
}

static void StoreForce(Vectors force, __global FLOATS* target)
{
  target[0] = force.X;
  target[1] = force.Y;
  target[2] = force.Z;
}

// Six times the signed volume of a tetrahedron; negative if the order of nodes is reversed.
static FLOATS Determinant(Vectors a, Vectors b, Vectors c)
{
  return Dot(a, Cross(b, c));
}

// Counts the inverted tetrahedra.
__kernel void CountInverted(__global const INTS* tetrahedra, __global const float* restPoints,
  __global const float* displacements, __global int* count, uint numberOfPackets)
{
  const size_t packet = get_global_id(0);
  if (packet >= numberOfPackets)
  {
    return;
  }
  Vectors rest[4];
  Vectors now[4];
  for (int i = 0; i < 4; ++i)
  {
    rest[i] = GetVectors(restPoints, tetrahedra[4 * packet + i]);
    now[i] = Plus(rest[i], GetVectors(displacements, tetrahedra[4 * packet + i]));
  }
  const FLOATS volume =
    Determinant(Minus(now[1], now[0]), Minus(now[2], now[0]), Minus(now[3], now[0]));
  const FLOATS volumeAtRest =
    Determinant(Minus(rest[1], rest[0]), Minus(rest[2], rest[0]), Minus(rest[3], rest[0]));
  const float* const each = (const float*)&volume;
  const float* const eachAtRest = (const float*)&volumeAtRest;
  int inverted = 0;
  for (int lane = 0; lane < LANES; ++lane)
  {
    // The product of the two underflows for edges of less than a micrometer.
    inverted += each[lane] < 0.0f && eachAtRest[lane] > 0.0f || each[lane] > 0.0f && eachAtRest[lane] < 0.0f;
  }
  if (inverted > 0)
  {
    atomic_add(count, inverted);
  }
}

// Computes the forces of each tetrahedron on its four nodes, in N. tetrahedra: the numbers of the nodes, times 3.
// materials: the stiffness of each edge, in N/m, and the modulus of the volume, in Pa.
__kernel void ComputeForces(__global const INTS* tetrahedra, __global const FLOATS* materials,
  __global const float* restPoints, __global const float* displacements, __global FLOATS* forces, uint numberOfPackets)
{
  const size_t packet = get_global_id(0);
  if (packet >= numberOfPackets)
  {
    return;
  }
  const INTS n0 = tetrahedra[4 * packet];
  const INTS n1 = tetrahedra[4 * packet + 1];
  const INTS n2 = tetrahedra[4 * packet + 2];
  const INTS n3 = tetrahedra[4 * packet + 3];
  const FLOATS stiffness = materials[2 * packet];
  const Vectors origin = GetVectors(restPoints, n0);
  const Vectors a1 = Minus(GetVectors(restPoints, n1), origin);
  const Vectors a2 = Minus(GetVectors(restPoints, n2), origin);
  const Vectors a3 = Minus(GetVectors(restPoints, n3), origin);
  const Vectors moved = GetVectors(displacements, n0);
  const Vectors e1 = Minus(GetVectors(displacements, n1), moved);
  const Vectors e2 = Minus(GetVectors(displacements, n2), moved);
  const Vectors e3 = Minus(GetVectors(displacements, n3), moved);

  // The relative change of the volume, and the gradients of the volume with respect to the positions of the nodes.
  const Vectors b1 = Plus(a1, e1);
  const Vectors b2 = Plus(a2, e2);
  const Vectors b3 = Plus(a3, e3);
  const Vectors area1 = Cross(b2, b3);
  const Vectors area2 = Cross(b3, b1);
  const Vectors area3 = Cross(b1, b2);
  const FLOATS restDeterminant = Determinant(a1, a2, a3);
  const FLOATS growth = Dot(e1, area1) + Dot(a1, Plus(Cross(e2, b3), Cross(a2, e3)));
  const FLOATS ratio = growth / restDeterminant;
  const FLOATS pressure = copysign(materials[2 * packet + 1] * (1.0f / 6.0f), restDeterminant) * -ratio;
  Vectors f1 = Times(area1, pressure);
  Vectors f2 = Times(area2, pressure);
  Vectors f3 = Times(area3, pressure);
  Vectors f0 = Times(Plus(Plus(area1, area2), area3), -pressure);

  Vectors spring = SpringForce(a1, e1, stiffness);
  f0 = Plus(f0, spring);
  f1 = Minus(f1, spring);
  spring = SpringForce(a2, e2, stiffness);
  f0 = Plus(f0, spring);
  f2 = Minus(f2, spring);
  spring = SpringForce(a3, e3, stiffness);
  f0 = Plus(f0, spring);
  f3 = Minus(f3, spring);
  spring = SpringForce(Minus(a2, a1), Minus(e2, e1), stiffness);
  f1 = Plus(f1, spring);
  f2 = Minus(f2, spring);
  spring = SpringForce(Minus(a3, a1), Minus(e3, e1), stiffness);
  f1 = Plus(f1, spring);
  f3 = Minus(f3, spring);
  spring = SpringForce(Minus(a3, a2), Minus(e3, e2), stiffness);
  f2 = Plus(f2, spring);
  f3 = Minus(f3, spring);

  StoreForce(f0, forces + 12 * packet);
  StoreForce(f1, forces + 12 * packet + 3);
  StoreForce(f2, forces + 12 * packet + 6);
  StoreForce(f3, forces + 12 * packet + 9);
}
