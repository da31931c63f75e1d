// SPDX-License-Identifier: BSD-3-Clause
// Resampling for processors: LANES cells of a row side by side in the lanes of vector registers.
// It comes after Resampling.cl and gives the same voxels; cells that it is not sure of it leaves to
// ResampleCell.
//
// Why it is shaped so: compilers do not turn a kernel with data-dependent loops over candidates
// into vector code, so the lanes are written out. Cells of equal parity are taken together, every
// second one of a row, so that no lane needs another 5T split than its neighbour.
//
// The method. The central tetrahedron has the vertices 0, 3, 5, 6 of the cell; l0, l3, l5, l6 are a
// sample's barycentric coordinates in it. The corner tetrahedra replace one of them by the vertex
// 1 (for 6), 2 (for 5), 4 (for 3) or 7 (for 0). In a cell that is not too bent a sample has at most
// one negative coordinate li, and lies behind that face: in the corner's coordinates the corner
// vertex c has the weight u = li / bi, where bi < 0 is the corner's own coordinate, and the others
// have tj = lj - u bj. For samples of the central tetrahedron u is 0 and tj = lj. So
//   u = min(li, 0) / bi for each corner,  tj = max(lj, 0) - sum of u bj
// are the weights of all eight vertices without a branch, and the sample is in the cell where
// no tj is negative.
//
// The fill rule stays exact. Positions are exact in float (cells under 8 voxels, steps of 1/256),
// and the error of tj is at most d = 8.5e-5 (3.4e-5 where -1 <= bi <= -0.35) times the cell's
// extent times the largest 1-norm of the gradients of the lj: with u = 2^-24 and k = extent times
// that norm >= 1, the error of lj is at most (7 + 5 |lj|) u k, that of l0 (30 + 5 |1 - l0|) u k,
// and that of tj no more than (2 M + 1) times their sum with M = max |bj / bi|. When three of the
// tj exceed d, the sample is inside; when one is under -d, outside. In between the cell is left
// to ResampleCell, which repeats it in integers.
//
// What the host puts in front of this text, besides that of Resampling.cl:
//   LANES                16, 8 or 4: floats in a vector
//   LANE_ARRAYS(DO)      DO(index, type, bits) for each array, bits 32 for float, else 8 or 16

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define FLOATS JOIN(float, LANES)
#define INTS JOIN(int, LANES)
#define LOAD(p) JOIN(vload, LANES)(0, p)
#define TO_FLOATS JOIN(convert_float, LANES)
#define TO_INTS JOIN(convert_int, LANES)
#define AS_INTS JOIN(as_int, LANES)

#define MAXIMUM_EXTENT 7.99f  // voxels: the normals of larger cells are not exact in float
#define ALMOST_ONE (255.0f / 256.0f) // ceil(v) = trunc(v + ALMOST_ONE) for multiples of 1/256
#define ROUND_TO_INTEGER 12582912.0f // 1.5 * 2^23: added to v, the low bits are v rounded

static FLOATS Least(FLOATS a, FLOATS b)
{
  return a < b ? a : b;
}

static FLOATS Most(FLOATS a, FLOATS b)
{
  return a > b ? a : b;
}

#if LANES == 16
#define LANE_INDEX ((INTS)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#elif LANES == 8
#define LANE_INDEX ((INTS)(0, 1, 2, 3, 4, 5, 6, 7))
#else
#define LANE_INDEX ((INTS)(0, 1, 2, 3))
#endif
#define LANE_BITS ((INTS)(1) << LANE_INDEX)

// A vector that is read back lane by lane.
typedef union
{
  INTS Vector;
  int Lanes[LANES];
} Lanes;

// A bit for each lane that is set.
static uint LaneBits(INTS mask)
{
  const INTS bits = mask & LANE_BITS;
#if LANES == 16
  const int8 a = bits.lo | bits.hi;
  const int4 b = a.lo | a.hi;
#elif LANES == 8
  const int4 b = bits.lo | bits.hi;
#else
  const int4 b = bits;
#endif
  const long2 c = as_long2(b);
  const long d = c.x | c.y;
  return (uint)d | (uint)(d >> 32);
}

// For each set bit, the highest first: lane is its number.
#define FOR_EACH_LANE(lane, bits)                                                                  \
  for (int lane = 31 - clz(bits); lane >= 0; bits ^= 1u << lane, lane = 31 - clz(bits))

// The largest of each byte over all lanes.
static int MostOfBytes(INTS v)
{
#if LANES == 16
  const uchar16 a = max(max(as_uchar16(v.s0123), as_uchar16(v.s4567)),
    max(as_uchar16(v.s89ab), as_uchar16(v.scdef)));
#elif LANES == 8
  const uchar16 a = max(as_uchar16(v.s0123), as_uchar16(v.s4567));
#else
  const uchar16 a = as_uchar16(v);
#endif
  const uchar8 b = max(a.lo, a.hi);
  return as_int(max(b.lo, b.hi));
}

// Every second element of two loads: the low sides of LANES cells, and their high sides.
#define SPLIT(low, high, p, CONVERT)                                                               \
  {                                                                                                \
    const FLOATS first = CONVERT(LOAD(p));                                                         \
    const FLOATS second = CONVERT(LOAD((p) + LANES));                                              \
    low = (FLOATS)(first.even, second.even);                                                       \
    high = (FLOATS)(first.odd, second.odd);                                                        \
  }

// Positions of the vertices of LANES cells in voxels relative to the output's first voxel, exact.
// v0 to v7 by the parity of their structured indices, as in CellCoverage.cl.
typedef struct
{
  FLOATS V[8];
} Coordinate;

static void LoadCoordinate(__global const int* const* rows, int offset, int origin, int odd,
  Coordinate* c)
{
#define POSITION(v) (TO_FLOATS((v)-origin) * (1.0f / 256.0f))
#pragma unroll
  for (int r = 0; r < 4; ++r)
  {
    FLOATS low;
    FLOATS high;
    SPLIT(low, high, rows[r] + offset, POSITION)
    c->V[2 * r] = odd ? high : low;
    c->V[2 * r + 1] = odd ? low : high;
  }
}

// 1-norm of a vector.
#define NORM(v) (fabs(v##x) + fabs(v##y) + fabs(v##z))
// Barycentric coordinates of vertex c relative to the central tetrahedron.
#define COORDINATES(c)                                                                             \
  FLOATS b##c##3, b##c##5, b##c##6, b##c##0;                                                       \
  {                                                                                                \
    const FLOATS rx = X.V[c] - X.V[0];                                                             \
    const FLOATS ry = Y.V[c] - Y.V[0];                                                             \
    const FLOATS rz = Z.V[c] - Z.V[0];                                                             \
    b##c##3 = fma(rx, n3x, fma(ry, n3y, rz * n3z));                                                \
    b##c##5 = fma(rx, n5x, fma(ry, n5y, rz * n5z));                                                \
    b##c##6 = fma(rx, n6x, fma(ry, n6y, rz * n6z));                                                \
    b##c##0 = ((1.0f - b##c##3) - b##c##5) - b##c##6;                                              \
  }
#define EIGHT(OP, c)                                                                               \
  OP(OP(OP(c.V[0], c.V[1]), OP(c.V[2], c.V[3])), OP(OP(c.V[4], c.V[5]), OP(c.V[6], c.V[7])))

// The values of an array at the vertices. Lanes with a value that the sum of products would not
// give back bit for bit (-0, not finite, or so large that the sum may overflow) are unsure.
#define LANE_VALUES(index, TYPE, BITS)                                                             \
  FLOATS values##index[8];                                                                         \
  _Pragma("unroll") for (int r = 0; r < 4; ++r)                                                    \
  {                                                                                                \
    FLOATS low;                                                                                    \
    FLOATS high;                                                                                   \
    SPLIT(low, high, source##index + sources[r], TO_FLOATS)                                        \
    values##index[2 * r] = odd ? high : low;                                                       \
    values##index[2 * r + 1] = odd ? low : high;                                                   \
    if (BITS == 32)                                                                                \
    {                                                                                              \
      unsure |= ((AS_INTS(low) & 0x7f800000) >= 0x7e000000) | (AS_INTS(low) == INT_MIN) |          \
        ((AS_INTS(high) & 0x7f800000) >= 0x7e000000) | (AS_INTS(high) == INT_MIN);                 \
    }                                                                                              \
  }

#define LANE_RANGE_LOW_char -128.0f
#define LANE_RANGE_HIGH_char 127.0f
#define LANE_RANGE_LOW_uchar 0.0f
#define LANE_RANGE_HIGH_uchar 255.0f
#define LANE_RANGE_LOW_short -32768.0f
#define LANE_RANGE_HIGH_short 32767.0f
#define LANE_RANGE_LOW_ushort 0.0f
#define LANE_RANGE_HIGH_ushort 65535.0f
#define LANE_RANGE_LOW_float 0.0f
#define LANE_RANGE_HIGH_float 0.0f
#define LANE_CONVERT_32(TYPE, bits) as_float(bits)
#define LANE_CONVERT_16(TYPE, bits) ((TYPE)(bits))
#define LANE_CONVERT_8(TYPE, bits) ((TYPE)(bits))

// The interpolated values of an array, rounded where it holds integers.
#define LANE_RESULTS(index, TYPE, BITS)                                                            \
  Lanes results##index;                                                                            \
  {                                                                                                \
    FLOATS v = t0 * values##index[0];                                                              \
    v = fma(t3, values##index[3], v);                                                              \
    v = fma(t5, values##index[5], v);                                                              \
    v = fma(t6, values##index[6], v);                                                              \
    v = fma(u1, values##index[1], v);                                                              \
    v = fma(u2, values##index[2], v);                                                              \
    v = fma(u4, values##index[4], v);                                                              \
    v = fma(u7, values##index[7], v);                                                              \
    if (BITS != 32)                                                                                \
    {                                                                                              \
      v = Least(Most(v, LANE_RANGE_LOW_##TYPE), LANE_RANGE_HIGH_##TYPE) + ROUND_TO_INTEGER;        \
    }                                                                                              \
    results##index.Vector = AS_INTS(v);                                                            \
  }

#define LANE_STORE(index, TYPE, BITS)                                                              \
  target##index[place] = LANE_CONVERT_##BITS(TYPE, results##index.Lanes[lane]);

// LANES cells: from x on every second one. Returns the cells that must be repeated, as bits, and
// adds to the writes those of the others.
static __attribute__((noinline)) uint ResampleLanes(SamplingMesh mesh, int x, int y, int z,
  __global char* coverage, uint* writes, const KernelParameters* p ARRAY_PARAMETERS)
{
  const int odd = (p->First[0] + x) & 1;
  const int oddY = (p->First[1] + y) & 1;
  const int oddZ = (p->First[2] + z) & 1;
  // The rows of vertices: bit 0 odd z, bit 1 odd y.
  __global const int* rows[4];
  size_t sources[4];
  INTS state = -1; // what the vertices of a cell have in common
  INTS some = 0;   // what at least one of them has
#pragma unroll
  for (int r = 0; r < 4; ++r)
  {
    const int rowY = y + ((r >> 1) ^ oddY);
    const int rowZ = z + ((r & 1) ^ oddZ);
    rows[r] = mesh.Positions + PositionIndex(x, rowY, rowZ, p);
    sources[r] = VertexInChunk(x, rowY, rowZ, p);
    const JOIN(uchar, LANES) first = LOAD(mesh.State + sources[r]);
    const JOIN(uchar, LANES) second = LOAD(mesh.State + sources[r] + LANES);
    const JOIN(uchar, LANES) low = (JOIN(uchar, LANES))(first.even, second.even);
    const JOIN(uchar, LANES) high = (JOIN(uchar, LANES))(first.odd, second.odd);
    state &= TO_INTS(low & high);
    some |= TO_INTS(low | high);
  }
  // Cells outside the deformation mesh have nothing to give.
  const INTS there = (x + 2 * LANE_INDEX < p->Size[0] - 1) & ((some & DEFORMVOLUME_VERTEX_SOURCE) != 0);
  if (!LaneBits(there))
  {
    return 0;
  }
  const INTS interior = (state & DEFORMVOLUME_VERTEX_INTERIOR) != 0;
  const JOIN(uchar, LANES) whole = (JOIN(uchar, LANES))(LOAD(mesh.State + VertexInChunk(x, y, z, p)).even,
    LOAD(mesh.State + VertexInChunk(x, y, z, p) + LANES).even);
  Coordinate X, Y, Z;
  LoadCoordinate(rows, 0, p->OutputFirst[0] * 256, odd, &X);
  LoadCoordinate(rows, p->Size[0], p->OutputFirst[1] * 256, odd, &Y);
  LoadCoordinate(rows, 2 * p->Size[0], p->OutputFirst[2] * 256, odd, &Z);

  // The box of the cell, and the candidates: half-open for all cells inside the mesh.
  FLOATS lowX = EIGHT(Least, X), lowY = EIGHT(Least, Y), lowZ = EIGHT(Least, Z);
  const FLOATS highX = EIGHT(Most, X), highY = EIGHT(Most, Y),
               highZ = EIGHT(Most, Z);
  const FLOATS extent = Most(highX - lowX, Most(highY - lowY, highZ - lowZ));
  const INTS small = extent <= MAXIMUM_EXTENT;
#define FIRST_OF(low, size) TO_INTS(Least(Most(low, 0.0f), (float)(size)) + ALMOST_ONE)
  const FLOATS toEnd = interior ? (FLOATS)(ALMOST_ONE) : (FLOATS)(1.0f);
#define END_OF(high, size) TO_INTS(Most(Least((high) + toEnd, (float)(size)), 0.0f))
  const INTS firstX = FIRST_OF(lowX, p->OutputSize[0]);
  const INTS firstY = FIRST_OF(lowY, p->OutputSize[1]);
  const INTS firstZ = FIRST_OF(lowZ, p->OutputSize[2]);
  const INTS countX = END_OF(highX, p->OutputSize[0]) - firstX;
  const INTS countY = END_OF(highY, p->OutputSize[1]) - firstY;
  const INTS countZ = END_OF(highZ, p->OutputSize[2]) - firstZ;

  // Gradients of l3, l5 and l6.
#define EDGE(a, v) const FLOATS a##x = X.V[v] - X.V[0], a##y = Y.V[v] - Y.V[0], a##z = Z.V[v] - Z.V[0];
  EDGE(e3, 3)
  EDGE(e5, 5)
  EDGE(e6, 6)
#define NORMAL(n, a, b)                                                                            \
  FLOATS n##x = fma(a##y, b##z, -(a##z * b##y)), n##y = fma(a##z, b##x, -(a##x * b##z)),           \
         n##z = fma(a##x, b##y, -(a##y * b##x));
  NORMAL(n3, e5, e6)
  NORMAL(n5, e6, e3)
  NORMAL(n6, e3, e5)
  const FLOATS determinant = fma(e3z, n3z, fma(e3y, n3y, e3x * n3x));
  const FLOATS inverse = 1.0f / determinant;
#define SCALE(n) n##x *= inverse; n##y *= inverse; n##z *= inverse;
  SCALE(n3)
  SCALE(n5)
  SCALE(n6)
  COORDINATES(1)
  COORDINATES(2)
  COORDINATES(4)
  COORDINATES(7)
  const FLOATS leastOther =
    Least(Least(Least(Least(b13, b15), Least(b10, b45)),
                  Least(Least(b46, b40), Least(b23, b26))),
      Least(Least(b20, b73), Least(b75, b76)));
  const FLOATS mostOwn = Most(Most(b16, b43), Most(b25, b70));
  const FLOATS leastOwn = Least(Least(b16, b43), Least(b25, b70));
  const INTS tame = (mostOwn <= -0.35f) & (leastOwn >= -1.0f);
  const FLOATS bound = (tame ? (FLOATS)(3.4e-5f) : (FLOATS)(8.5e-5f)) * extent *
    Most(Most(NORM(n3), NORM(n5)), NORM(n6));
  const INTS upright = (odd ^ oddY ^ oddZ) ? determinant < 0.0f : determinant > 0.0f;
  const INTS nice = there & ((TO_INTS(whole) & DEFORMVOLUME_CELL_WHOLE) != 0) & small & upright & (leastOther >= 0.015625f) &
    (mostOwn <= -0.125f) & (leastOwn >= -2.0f) & (bound <= 0.0078125f);
  INTS unsure = there & ~nice;
  INTS count = 0; // writes
  const INTS candidates = nice & (countX > 0) & (countY > 0) & (countZ > 0);
  const int counts = MostOfBytes((countX | countY << 8 | countZ << 16) & candidates);
  if (counts)
  {
    // Cells that are boxes take all their candidates: all faces of the box are on the upper side of
    // no candidate. These are the cells of an undeformed, shifted or axis-wise scaled volume.
#define DIFFER(c, a, b) (AS_INTS(c.V[a]) ^ AS_INTS(c.V[b]))
    const INTS box = candidates & interior &
      ((DIFFER(X, 0, 2) | DIFFER(X, 4, 6) | DIFFER(X, 0, 4) | DIFFER(X, 1, 3) | DIFFER(X, 5, 7) |
         DIFFER(X, 1, 5) | DIFFER(Y, 0, 1) | DIFFER(Y, 2, 3) | DIFFER(Y, 0, 2) | DIFFER(Y, 4, 5) |
         DIFFER(Y, 6, 7) | DIFFER(Y, 4, 6) | DIFFER(Z, 0, 1) | DIFFER(Z, 4, 5) | DIFFER(Z, 0, 4) |
         DIFFER(Z, 2, 3) | DIFFER(Z, 6, 7) | DIFFER(Z, 2, 6)) == 0);
    // Where a vertex of a box lies on a sample, on its first candidate then, its value is taken bit
    // for bit: the weights, which rounding may have touched, are made 0 and 1.
#define STARTS_ON_SAMPLE(low) (((low) >= 0.0f) & (floor(low) == (low)))
    const INTS vertexOnSample =
      box & STARTS_ON_SAMPLE(lowX) & STARTS_ON_SAMPLE(lowY) & STARTS_ON_SAMPLE(lowZ);
#define SNAP(weight) weight = vertexOnSample ? rint(weight) : weight;
    LANE_ARRAYS(LANE_VALUES)
    const FLOATS s1 = 1.0f / b16, s2 = 1.0f / b25, s4 = 1.0f / b43, s7 = 1.0f / b70;
    const FLOATS startX = TO_FLOATS(firstX) - X.V[0];
    const FLOATS startY = TO_FLOATS(firstY) - Y.V[0];
    const FLOATS startZ = TO_FLOATS(firstZ) - Z.V[0];
    const INTS first = (firstZ * p->OutputSize[1] + firstY) * p->OutputSize[0] + firstX;
    for (int dz = 0; dz < (counts >> 16 & 255); ++dz)
    {
      for (int dy = 0; dy < (counts >> 8 & 255); ++dy)
      {
        const INTS row = candidates & (countZ > dz) & (countY > dy);
        const FLOATS ry = startY + (float)dy;
        const FLOATS rz = startZ + (float)dz;
        const FLOATS g3 = fma(ry, n3y, rz * n3z);
        const FLOATS g5 = fma(ry, n5y, rz * n5z);
        const FLOATS g6 = fma(ry, n6y, rz * n6z);
        for (int dx = 0; dx < (counts & 255); ++dx)
        {
          const FLOATS rx = startX + (float)dx;
          const FLOATS l3 = fma(rx, n3x, g3);
          const FLOATS l5 = fma(rx, n5x, g5);
          const FLOATS l6 = fma(rx, n6x, g6);
          const FLOATS l0 = ((1.0f - l3) - l5) - l6;
          FLOATS u1 = Least(l6, 0.0f) * s1;
          FLOATS u2 = Least(l5, 0.0f) * s2;
          FLOATS u4 = Least(l3, 0.0f) * s4;
          FLOATS u7 = Least(l0, 0.0f) * s7;
          FLOATS t3 = fma(-u7, b73, fma(-u2, b23, fma(-u1, b13, Most(l3, 0.0f))));
          FLOATS t5 = fma(-u7, b75, fma(-u4, b45, fma(-u1, b15, Most(l5, 0.0f))));
          FLOATS t6 = fma(-u7, b76, fma(-u2, b26, fma(-u4, b46, Most(l6, 0.0f))));
          FLOATS t0 = fma(-u2, b20, fma(-u4, b40, fma(-u1, b10, Most(l0, 0.0f))));
          if ((dx | dy | dz) == 0)
          {
            SNAP(t0) SNAP(t3) SNAP(t5) SNAP(t6) SNAP(u1) SNAP(u2) SNAP(u4) SNAP(u7)
          }
          const FLOATS lowA = Least(t3, t5), highA = Most(t3, t5);
          const FLOATS lowB = Least(t6, t0), highB = Most(t6, t0);
          const INTS maybe = (Least(lowA, lowB) >= -bound) & row & (countX > dx);
          // The second smallest weight decides: that opposite the corner may be 0.
          const FLOATS second =
            Least(Most(lowA, lowB), Least(highA, highB));
          const INTS hit = maybe & ((second > bound) | box);
          unsure |= maybe & ~hit;
          uint bits = LaneBits(hit);
          if (bits)
          {
            LANE_ARRAYS(LANE_RESULTS)
            count -= hit;
            Lanes places;
            places.Vector = first + ((dz * p->OutputSize[1] + dy) * p->OutputSize[0] + dx);
            FOR_EACH_LANE(lane, bits)
            {
              const uint place = places.Lanes[lane];
              coverage[place] = 1;
              LANE_ARRAYS(LANE_STORE)
            }
          }
        }
      }
    }
  }
  // What an unsure cell wrote so far is written again with it, and must not count twice.
  Lanes written;
  written.Vector = unsure ? (INTS)(0) : count;
  for (int k = 0; k < LANES; ++k)
  {
    *writes += written.Lanes[k];
  }
  return LaneBits(unsure & there);
}

// As the kernel Resample, for the direct pass.
__kernel void ResampleByLanes(__global const int* positions, __global const uchar* state,
  __global const uchar* active, __global char* coverage, __global KEY* winners,
  __global uint* counters, const KernelParameters p ARRAY_PARAMETERS)
{
  const SamplingMesh mesh = { positions, state, active };
  Output output = { coverage, winners, 0, 0, 0 };
  const int y = get_global_id(1);
  const int z = p.LayersBegin + (int)get_global_id(2);
  for (int x = 2 * LANES * get_global_id(0); x < p.Size[0] - 1;
       x += 2 * LANES * get_global_size(0))
  {
    for (int side = 0; side < 2 && x + side < p.Size[0] - 1; ++side)
    {
      uint unsure =
        ResampleLanes(mesh, x + side, y, z, coverage, &output.Writes, &p ARRAY_ARGUMENTS);
      FOR_EACH_LANE(lane, unsure)
      {
        ResampleCell(mesh, x + side + 2 * lane, y, z, &output, &p ARRAY_ARGUMENTS);
      }
    }
  }
  AddCounts(&output, y, z, counters, &p);
}
