// SPDX-License-Identifier: BSD-3-Clause
// The rows of vertices that ResampleBricks (BrickResampling.cl) works on: finds the positions of a row and puts
// them into local memory, with the values of the arrays.
//
// Data: in local memory, a row: for even, then for odd vertices the position in output voxels relative to the
// first output voxel (x, y, z; float, exact multiples of 1/256), then the values of the arrays that are
// interpolated in single precision, HALF_ROW floats each.
//
// Vertices come eight at a time, with the operations of PositionOf (DeformationMapping.cl) in the same order;
// where one of the eight is missing, one at a time.

#ifdef __x86_64__
#define PREFETCH(address) __builtin_prefetch((const void*)(size_t)(address));
#else
#define PREFETCH(address)
#endif

#define HALF_ROW ((DEFORMVOLUME_BRICK_X / 2 / LANES + 1) * LANES)
#define SLOTS (3 + LANE_SLOTS)
#define ODD (SLOTS * HALF_ROW)   // from an even vertex to the odd one with the same place
#define ROW (2 * ODD)
#define ROWS (DEFORMVOLUME_BRICK_Y + 1)
#define NOT_THERE -1e30f // x of places beyond the volume
#define NO_SOURCE 1e30f  // x of vertices without position

typedef __local const float* LocalRow;

// What is known of the vertices of a row, eight of them a bit, the lowest first.
typedef struct
{
  uint Border;  // one is not interior
  uint Special; // one has a value that sums of products do not give back bit for bit
} RowFlags;

#define ROW_PLACES (DEFORMVOLUME_BRICK_X + 16) // of a row that is not split; vectors may reach beyond the end

#if MAPPING == MAPPING_RUNS

// The displacements of the vertices of a row from x to end, x, y and z apart, one after the other from
// place i: affine from one run's begin to the next.
static void DisplaceRow(const Mapping* m, int x, int end, int i, int y, int z,
  __local float* places, const KernelParameters* p)
{
  const float8 steps = (float8)(0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f);
  const size_t row = RowIndex(y, z, p);
  const uint last = m->RowBegins[row + 1] - 1;
  uint run = FindRun(m->Runs, m->RowBegins[row], last + 1, x);
  int next = m->Runs[run].Tetrahedron;
  while (x < end)
  {
    const int tetrahedron = next;
    int runEnd = end;
    if (run < last)
    {
      const VertexRun following = m->Runs[++run];
      runEnd = min(following.Begin, end);
      next = following.Tetrahedron;
    }
    if (tetrahedron >= 0)
    {
      const RunDisplacement d = MakeRunDisplacement(m->Records + tetrahedron, y, z);
      float8 index = (float)x + steps;
      for (__local float* place = places + i; place < places + i + (runEnd - x); place += 8)
      {
        const float8 offset = index - d.OriginX;
        index += 8.0f;
        vstore8(d.Displacement.x + (d.Across.x + d.AlongX.x * offset), 0, place);
        vstore8(d.Displacement.y + (d.Across.y + d.AlongX.y * offset), 0, place + ROW_PLACES);
        vstore8(d.Displacement.z + (d.Across.z + d.AlongX.z * offset), 0, place + 2 * ROW_PLACES);
      }
    }
    i += runEnd - x;
    x = runEnd;
  }
}

#define ROW_DISPLACEMENTS DisplaceRow(m, x, end, i, y, z, displaced, p);
#define ROW_DISPLACEMENT                                                                           \
  (float4)(displaced[i], displaced[i + ROW_PLACES], displaced[i + 2 * ROW_PLACES], 0.0f)
#define EIGHT_ROW_DISPLACEMENTS                                                                    \
  const float8 xs = vload8(0, displaced + i);                                                      \
  const float8 ys = vload8(0, displaced + i + ROW_PLACES);                                         \
  const float8 zs = vload8(0, displaced + i + 2 * ROW_PLACES);                                     \
  const float8 dx = (float8)(xs.even, xs.odd);                                                     \
  const float8 dy = (float8)(ys.even, ys.odd);                                                     \
  const float8 dz = (float8)(zs.even, zs.odd);

#else

#if MAPPING == MAPPING_LINKS
#define ROW_DISPLACEMENTS                                                                          \
  __global const VertexLink* const rowLinks = m->Links + VertexInChunk(0, y, z, p);
#define VERTEX_DISPLACEMENT(x) FollowLink(m, rowLinks + (x))
// Links are most of what is read, each once: they are fetched ahead.
#define FETCH_AHEAD PREFETCH(rowLinks + x + 256) PREFETCH(rowLinks + x + 260)
#else
#define ROW_DISPLACEMENTS
#define VERTEX_DISPLACEMENT(x) Displacement(m, x, y, z, p)
#define FETCH_AHEAD
#endif
#define ROW_DISPLACEMENT VERTEX_DISPLACEMENT(x)
#define EIGHT_ROW_DISPLACEMENTS                                                                    \
  FETCH_AHEAD                                                                                      \
  const float4 d0 = VERTEX_DISPLACEMENT(x);                                                        \
  const float4 d2 = VERTEX_DISPLACEMENT(x + 2);                                                    \
  const float4 d4 = VERTEX_DISPLACEMENT(x + 4);                                                    \
  const float4 d6 = VERTEX_DISPLACEMENT(x + 6);                                                    \
  const float4 d1 = VERTEX_DISPLACEMENT(x + 1);                                                    \
  const float4 d3 = VERTEX_DISPLACEMENT(x + 3);                                                    \
  const float4 d5 = VERTEX_DISPLACEMENT(x + 5);                                                    \
  const float4 d7 = VERTEX_DISPLACEMENT(x + 7);                                                    \
  const float8 dx = (float8)(d0.x, d2.x, d4.x, d6.x, d1.x, d3.x, d5.x, d7.x);                      \
  const float8 dy = (float8)(d0.y, d2.y, d4.y, d6.y, d1.y, d3.y, d5.y, d7.y);                      \
  const float8 dz = (float8)(d0.z, d2.z, d4.z, d6.z, d1.z, d3.z, d5.z, d7.z);

#endif

#define SOURCES 0x0101010101010101UL
#define INTERIORS 0x0202020202020202UL

// The states of eight vertices; without a state the bits of SOURCES and INTERIORS only.
static ulong StatesOf(__global const uchar* state, int x, int y, int z, const KernelParameters* p)
{
  if (p->HasState)
  {
    return as_ulong(vload8(0, state + VertexInChunk(x, y, z, p)));
  }
  const int inside = x > 0 && x + 8 < p->Size[0] && y > 0 && y < p->Size[1] - 1 && z > 0 &&
    z < p->Size[2] - 1;
  return SOURCES | (inside ? INTERIORS : 0);
}

// A value, by its bits, that the sum of products would not give back: -0, not finite, or so large that the
// sum may overflow.
#define IS_SPECIAL(bits) ((((bits)&0x7f800000) >= 0x7e000000) | ((bits) == INT_MIN))

#define PUT_VALUE(index, TYPE, BITS, SLOT)                                                         \
  {                                                                                                \
    const float value = (float)source##index[chunk + x];                                           \
    place[(3 + SLOT) * HALF_ROW] = value;                                                          \
    if (BITS == 32 && IS_SPECIAL(as_int(value)))                                                   \
    {                                                                                              \
      flags.Special |= 1u << (i >> 3);                                                             \
    }                                                                                              \
  }
#define PUT_EIGHT_VALUES(index, TYPE, BITS, SLOT)                                                  \
  {                                                                                                \
    const float8 value = convert_float8(vload8(0, source##index + chunk + x));                     \
    vstore4(value.even, 0, place + (3 + SLOT) * HALF_ROW);                                         \
    vstore4(value.odd, 0, place + ODD + (3 + SLOT) * HALF_ROW);                                    \
    if (BITS == 32)                                                                                \
    {                                                                                              \
      if (any(IS_SPECIAL(as_int8(value))))                                                         \
      {                                                                                            \
        flags.Special |= 3u << (i >> 3);                                                           \
      }                                                                                            \
    }                                                                                              \
  }

// The values of a row are few, and the next row lies far away.
#define FETCH_NEXT_ROW(index, TYPE, BITS, SLOT)                                                    \
  for (int k = x; k < end; k += 512 / BITS)                                                        \
  {                                                                                                \
    PREFETCH(source##index + chunk + p->Size[0] + k)                                               \
  }

// Maps the vertices of a row from x to end; i: place of x in the brick.
static RowFlags MapRow(const SamplingMesh* mesh, int x, int end, int i, int y, int z,
  __local float* row, __local const float* restX, __local float* displaced,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const Mapping* m = &mesh->Map;
  const RestPosition ry = m->Rest[p->Size[0] + y];
  const RestPosition rz = m->Rest[p->Size[0] + p->Size[1] + z];
  const float wholeY = ry.Whole - p->OutputFirst[1] * 256;
  const float wholeZ = rz.Whole - p->OutputFirst[2] * 256;
  const size_t chunk = VertexInChunk(0, y, z, p);
  ROW_DISPLACEMENTS
  LANE_ARRAYS(FETCH_NEXT_ROW)
  RowFlags flags = { 0, 0 };
  while (x < end)
  {
    __local float* place = row + (i >> 1) + (i & 1 ? ODD : 0);
    __local const float* rest = restX + (i >> 1) + (i & 1 ? 2 * HALF_ROW : 0);
    const ulong states = x + 8 <= end ? StatesOf(mesh->State, x, y, z, p) : 0;
    if ((i & 1) || (states & SOURCES) != SOURCES)
    {
      // One vertex.
      const int state = StateOf(mesh->State, x, y, z, p);
      float4 position = (float4)(NO_SOURCE, 0.0f, 0.0f, 0.0f);
      if (state & DEFORMVOLUME_VERTEX_SOURCE)
      {
        const float4 steps = RoundSteps_float4(ROW_DISPLACEMENT * 256.0f +
          (float4)(rest[HALF_ROW], ry.Fraction, rz.Fraction, 0.0f));
        position = (steps + (float4)(rest[0], wholeY, wholeZ, 0.0f)) * (1.0f / 256.0f);
      }
      place[0] = position.x;
      place[HALF_ROW] = position.y;
      place[2 * HALF_ROW] = position.z;
      if (!(state & DEFORMVOLUME_VERTEX_INTERIOR))
      {
        flags.Border |= 1u << (i >> 3);
      }
      LANE_ARRAYS(PUT_VALUE)
      ++x;
      ++i;
      continue;
    }
    // Eight vertices.
    EIGHT_ROW_DISPLACEMENTS
#define POSITIONS(C, OFFSET, WHOLE_EVEN, WHOLE_ODD, FRACTION_EVEN, FRACTION_ODD)                   \
  {                                                                                                \
    const float8 steps =                                                                           \
      RoundSteps_float8(d##C * 256.0f + (float8)(FRACTION_EVEN, FRACTION_ODD));                    \
    const float8 position = (steps + (float8)(WHOLE_EVEN, WHOLE_ODD)) * (1.0f / 256.0f);           \
    vstore4(position.lo, 0, place + (OFFSET)*HALF_ROW);                                            \
    vstore4(position.hi, 0, place + ODD + (OFFSET)*HALF_ROW);                                      \
  }
    POSITIONS(x, 0, vload4(0, rest), vload4(0, rest + 2 * HALF_ROW), vload4(0, rest + HALF_ROW),
      vload4(0, rest + 3 * HALF_ROW))
    POSITIONS(y, 1, (float4)wholeY, (float4)wholeY, (float4)ry.Fraction, (float4)ry.Fraction)
    POSITIONS(z, 2, (float4)wholeZ, (float4)wholeZ, (float4)rz.Fraction, (float4)rz.Fraction)
    if ((states & INTERIORS) != INTERIORS)
    {
      flags.Border |= 3u << (i >> 3);
    }
    LANE_ARRAYS(PUT_EIGHT_VALUES)
    x += 8;
    i += 8;
  }
  return flags;
}
