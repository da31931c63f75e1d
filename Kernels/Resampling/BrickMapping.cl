// SPDX-License-Identifier: BSD-3-Clause
// The rows of vertices that ResampleBricks (BrickResampling.cl) works on: finds the positions of a row and puts
// them into memory, with the values of the arrays.
//
// Data: in ROW_MEMORY, a row: for even, then for odd vertices the position in output voxels relative to the
// first output voxel (x, y, z; float, exact multiples of 1/256), then the values of the arrays that are
// interpolated in single precision, HALF_ROW floats each.
//
// Vertices come sixteen at a time, with the operations of PositionOf (DeformationMapping.cl) in the same order;
// where one of these is missing, one at a time. The last ones of a row come with some before them, which then
// come twice.

#ifdef __x86_64__
#define PREFETCH(address) __builtin_prefetch((const void*)(size_t)(address));
#define PREFETCH_TO_WRITE(address) __builtin_prefetch((const void*)(size_t)(address), 1);
#else
#define PREFETCH(address)
#define PREFETCH_TO_WRITE(address)
#endif

#define HALF_ROW ((DEFORMVOLUME_BRICK_X / 2 / LANES + 1) * LANES)
#define SLOTS (3 + LANE_SLOTS)
#define ODD (SLOTS * HALF_ROW)   // from an even vertex to the odd one with the same place
#define ROW (2 * ODD)
#define ROWS (DEFORMVOLUME_BRICK_Y + 1)
#define NOT_THERE -1e30f // x of places beyond the volume
#define NO_SOURCE 1e30f  // x of vertices without position
#define STEP (1.0f / 256.0f) // of positions, in voxels

typedef ROW_MEMORY const float* LocalRow;

// What is known of the vertices of a row, eight of them a bit, the lowest first.
typedef struct
{
  uint Border;  // one is not interior
  uint Special; // one has a value that sums of products do not give back bit for bit
} RowFlags;

#define ROW_PLACES (DEFORMVOLUME_BRICK_X + 16) // of a row that is not split; vectors may reach beyond the end

#define LOAD_PLACED(place) *(ROW_MEMORY const PlacedFloat16*)(place)

#if MAPPING == MAPPING_RUNS

// The displacements of the vertices of a row from x to end, x, y and z apart, one after the other from
// place i: affine from one run's begin to the next.
static void DisplaceRow(const Mapping* m, int x, int end, int i, int y, int z,
  ROW_MEMORY float* places, const KernelParameters* p)
{
  const float16 steps = (float16)(0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f, 8.0f, 9.0f, 10.0f,
    11.0f, 12.0f, 13.0f, 14.0f, 15.0f);
  const size_t row = RowIndex(y, z, p);
  const uint first = m->RowBegins[row];
  const uint last = m->RowBegins[row + 1] - 1;
  __global const VertexRun* run =
    m->Runs + (x == 0 ? first : FindRun(m->Runs, first, last + 1, x));
  __global const VertexRun* const lastRun = m->Runs + last;
  places += i - x;
  while (x < end)
  {
    const int tetrahedron = run->Tetrahedron;
    const int runEnd = run < lastRun ? min(run[1].Begin, end) : end;
    ++run;
    if (tetrahedron >= 0)
    {
      __global const TetrahedronRecord* const record = m->Records + tetrahedron;
      const RunDisplacement d = MakeRunDisplacement(record, y, z);
      do
      {
        // From memory one number goes to all lanes at no cost, from another vector it does not.
        ROW_MEMORY float* const place = places + x;
        const float16 offset = ((float)x + steps) - record->Origin[0];
#define DISPLACE_AXIS(axis, across)                                                                \
  *(ROW_MEMORY PlacedFloat16*)(place + (axis)*ROW_PLACES) =                                        \
    record->Displacement[axis] + MULTIPLY_ADD((float16)record->AlongX[axis], offset, (float16)across);
        DISPLACE_AXIS(0, d.Across.x)
        DISPLACE_AXIS(1, d.Across.y)
        DISPLACE_AXIS(2, d.Across.z)
        x += 16;
      } while (x < runEnd);
    }
    x = runEnd;
  }
}

#define ROW_DISPLACEMENTS DisplaceRow(m, x, end, i, y, z, displaced, p);
#define ROW_DISPLACEMENT                                                                           \
  (float4)(displaced[i], displaced[i + ROW_PLACES], displaced[i + 2 * ROW_PLACES], 0.0f)
#define ROW_DISPLACEMENTS_TOGETHER                                                                 \
  const float16 xs = LOAD_PLACED(displaced + i);                                                   \
  const float16 ys = LOAD_PLACED(displaced + i + ROW_PLACES);                                      \
  const float16 zs = LOAD_PLACED(displaced + i + 2 * ROW_PLACES);                                  \
  const float16 dx = (float16)(xs.even, xs.odd);                                                   \
  const float16 dy = (float16)(ys.even, ys.odd);                                                   \
  const float16 dz = (float16)(zs.even, zs.odd);

#elif MAPPING == MAPPING_FIELD_IN_PLACE

#define ROW_DISPLACEMENTS                                                                          \
  __global const float* const rowVectors = m->Vectors + 3 * PointOf(&m->Field, 0, y, z);
#define ROW_DISPLACEMENT Displacement(m, x, y, z, p)
#define MAP_VECTORS(row) ROW_PRODUCT(&m->Field, row, float16, double16, vx, vy, vz)
// Three floats a vertex: the x of the even vertices are every sixth, from the first one on, and so on.
#define ROW_DISPLACEMENTS_TOGETHER                                                                 \
  const float16 v0 = vload16(0, rowVectors + 3 * x);                                               \
  const float16 v1 = vload16(1, rowVectors + 3 * x);                                               \
  const float16 v2 = vload16(2, rowVectors + 3 * x);                                               \
  const float16 vx = (float16)(v0.s06c, v1.s28e, v2.s4a, v0.s39f, v1.s5b, v2.s17d);                \
  const float16 vy = (float16)(v0.s17d, v1.s39f, v2.s5b, v0.s4a, v1.s06c, v2.s28e);                \
  const float16 vz = (float16)(v0.s28e, v1.s4a, v2.s06c, v0.s5b, v1.s17d, v2.s39f);                \
  float16 dx = vx;                                                                                 \
  float16 dy = vy;                                                                                 \
  float16 dz = vz;                                                                                 \
  if (m->Field.IsMapped)                                                                           \
  {                                                                                                \
    dx = MAP_VECTORS(0);                                                                           \
    dy = MAP_VECTORS(1);                                                                           \
    dz = MAP_VECTORS(2);                                                                           \
  }

#else

#if MAPPING == MAPPING_LINKS

// The element i of each four, to all of these.
#ifdef __clang__
#define OF_EACH_FOUR(v, i)                                                                         \
  __builtin_shufflevector(v, v, i, i, i, i, i + 4, i + 4, i + 4, i + 4, i + 8, i + 8, i + 8,       \
    i + 8, i + 12, i + 12, i + 12, i + 12)
#else
#define OF_EACH_FOUR(v, i)                                                                         \
  shuffle(v, (uint16)(i, i, i, i, i + 4, i + 4, i + 4, i + 4, i + 8, i + 8, i + 8, i + 8, i + 12,  \
               i + 12, i + 12, i + 12))
#endif

// The nodes of four tetrahedra that two places, read as one number, name first and second: loads are what takes
// longest here.
#ifdef __ENDIAN_LITTLE__
#define FIRST_NODE(m, places) NODE((m)->Nodes, (ulong)(uint)(places))
#define SECOND_NODE(m, places) NODE((m)->Nodes, (places) >> 32)
#else
#define FIRST_NODE(m, places) NODE((m)->Nodes, (places) >> 32)
#define SECOND_NODE(m, places) NODE((m)->Nodes, (ulong)(uint)(places))
#endif
#define FOUR_NODES(WHICH, m, places)                                                               \
  (float16)(WHICH##_NODE(m, places##0), WHICH##_NODE(m, places##1), WHICH##_NODE(m, places##2),    \
    WHICH##_NODE(m, places##3))

// The displacements of four vertices with links behind one another, with the operations of FollowLink.
static float16 FollowFourLinks(const Mapping* m, __global const VertexLink* links)
{
  const float16 four = *(__global const PlacedFloat16*)links;
  const float16 a = OF_EACH_FOUR(four, 1);
  const float16 b = OF_EACH_FOUR(four, 2);
  const float16 c = OF_EACH_FOUR(four, 3);
  const float16 d = 1.0f - a - b - c;
#define PLACES_OF(k)                                                                               \
  __global const ulong* const tetrahedron##k =                                                     \
    (__global const ulong*)(m->Tetrahedra + links[k].Tetrahedron);                                 \
  const ulong xy##k = tetrahedron##k[0];                                                           \
  const ulong zw##k = tetrahedron##k[1];
  PLACES_OF(0)
  PLACES_OF(1)
  PLACES_OF(2)
  PLACES_OF(3)
  return MULTIPLY_ADD(FOUR_NODES(SECOND, m, zw), d,
    MULTIPLY_ADD(FOUR_NODES(FIRST, m, zw), c,
      MULTIPLY_ADD(FOUR_NODES(SECOND, m, xy), b, FOUR_NODES(FIRST, m, xy) * a)));
}

#define ROW_DISPLACEMENTS                                                                          \
  __global const VertexLink* const rowLinks = m->Links + VertexInChunk(0, y, z, p);
#define ROW_DISPLACEMENT FollowLink(m, rowLinks + x)
#define FOUR_DISPLACEMENTS(x) FollowFourLinks(m, rowLinks + (x))
// Links are most of what is read, each once: they are fetched ahead.
#define FETCH_AHEAD                                                                                \
  PREFETCH(rowLinks + p->Size[0] + x)                                                              \
  PREFETCH(rowLinks + p->Size[0] + x + 4)                                                          \
  PREFETCH(rowLinks + p->Size[0] + x + 8)                                                          \
  PREFETCH(rowLinks + p->Size[0] + x + 12)

#else

#define ROW_DISPLACEMENTS
#define ROW_DISPLACEMENT Displacement(m, x, y, z, p)
#define FOUR_DISPLACEMENTS(x)                                                                      \
  (float16)(Displacement(m, x, y, z, p), Displacement(m, (x) + 1, y, z, p),                        \
    Displacement(m, (x) + 2, y, z, p), Displacement(m, (x) + 3, y, z, p))
#define FETCH_AHEAD

#endif

// Of two vectors at a time: that is one instruction.
#define ROW_DISPLACEMENTS_TOGETHER                                                                 \
  FETCH_AHEAD                                                                                      \
  const float16 d0 = FOUR_DISPLACEMENTS(x);                                                        \
  const float16 d4 = FOUR_DISPLACEMENTS(x + 4);                                                    \
  const float16 d8 = FOUR_DISPLACEMENTS(x + 8);                                                    \
  const float16 d12 = FOUR_DISPLACEMENTS(x + 12);                                                  \
  const float16 xyLow =                                                                            \
    (float16)(d0.s08, d4.s08, d0.s4c, d4.s4c, d0.s19, d4.s19, d0.s5d, d4.s5d);                     \
  const float16 xyHigh =                                                                           \
    (float16)(d8.s08, d12.s08, d8.s4c, d12.s4c, d8.s19, d12.s19, d8.s5d, d12.s5d);                 \
  const float16 zLow =                                                                             \
    (float16)(d0.s2a, d4.s2a, d0.s6e, d4.s6e, d0.s2a, d4.s2a, d0.s6e, d4.s6e);                     \
  const float16 zHigh =                                                                            \
    (float16)(d8.s2a, d12.s2a, d8.s6e, d12.s6e, d8.s2a, d12.s2a, d8.s6e, d12.s6e);                 \
  const float16 dx = (float16)(xyLow.s0123, xyHigh.s0123, xyLow.s4567, xyHigh.s4567);              \
  const float16 dy = (float16)(xyLow.s89ab, xyHigh.s89ab, xyLow.scdef, xyHigh.scdef);              \
  const float16 dz = (float16)(zLow.s0123, zHigh.s0123, zLow.s4567, zHigh.s4567);

#endif

#define SOURCES 0x0101010101010101UL
#define INTERIORS 0x0202020202020202UL

// The bits that both eights of sixteen vertices of a row have; rowInside: whether the row is not on the border
// of the volume.
static ulong StatesOf(
  __global const uchar* rowState, int x, int rowInside, const KernelParameters* p)
{
  if (p->HasState)
  {
    const ulong2 states = as_ulong2(vload16(0, rowState + x));
    return states.x & states.y;
  }
  return SOURCES | (rowInside && x > 0 && x + 16 < p->Size[0] ? INTERIORS : 0);
}

#define STORE_EIGHT(v, place) *(ROW_MEMORY PlacedFloat8*)(place) = v;
#define FLAGS_TOGETHER 7u // those of RowFlags that sixteen vertices may be in

// A value, by its bits, that the sum of products would not give back: -0, not finite, or so large (2^115) that the
// sum may overflow, as weights add up to the determinant, which is under 2^11.
#define IS_SPECIAL(bits) ((((bits)&0x7f800000) >= 0x79000000) | ((bits) == INT_MIN))

#define PUT_VALUE(index, TYPE, BITS, SLOT)                                                         \
  {                                                                                                \
    const float value = (float)source##index[chunk + x];                                           \
    place[(3 + SLOT) * HALF_ROW] = value;                                                          \
    if (BITS == 32 && IS_SPECIAL(as_int(value)))                                                   \
    {                                                                                              \
      flags.Special |= 1u << (i >> 3);                                                             \
    }                                                                                              \
  }
#define PUT_VALUES_TOGETHER(index, TYPE, BITS, SLOT)                                               \
  {                                                                                                \
    const float16 value = convert_float16(vload16(0, source##index + chunk + x));                  \
    STORE_EIGHT(value.even, place + (3 + SLOT) * HALF_ROW)                                         \
    STORE_EIGHT(value.odd, place + ODD + (3 + SLOT) * HALF_ROW)                                    \
    if (BITS == 32)                                                                                \
    {                                                                                              \
      if (any(IS_SPECIAL(as_int16(value))))                                                        \
      {                                                                                            \
        flags.Special |= FLAGS_TOGETHER << (i >> 3);                                               \
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
  ROW_MEMORY float* row, ROW_MEMORY const float* restX, ROW_MEMORY float* displaced,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const Mapping* m = &mesh->Map;
  const RestPosition ry = m->Rest[p->Size[0] + y];
  const RestPosition rz = m->Rest[p->Size[0] + p->Size[1] + z];
  const float wholeY = (ry.Whole - p->OutputFirst[1] * 256) * STEP;
  const float wholeZ = (rz.Whole - p->OutputFirst[2] * 256) * STEP;
  const float fractionY = ry.Fraction * STEP;
  const float fractionZ = rz.Fraction * STEP;
  const size_t chunk = VertexInChunk(0, y, z, p);
  ROW_DISPLACEMENTS
  LANE_ARRAYS(FETCH_NEXT_ROW)
  RowFlags flags = { 0, 0 };
  const int begin = x;
  const int rowInside = y > 0 && y < p->Size[1] - 1 && z > 0 && z < p->Size[2] - 1;
  __global const uchar* const rowState = mesh->State + chunk;
  while (x < end)
  {
    // How many to take again.
    int again = 0;
    if (x + 1 < end && x + 16 > end)
    {
      again = x + 16 - end;
      again += (i - again) & 1;
      again = again > x - begin ? 0 : again;
    }
    const ulong states = x - again + 16 <= end ? StatesOf(rowState, x - again, rowInside, p) : 0;
    if (((i - again) & 1) || (states & SOURCES) != SOURCES)
    {
      // One vertex.
      ROW_MEMORY float* place = row + (i >> 1) + (i & 1 ? ODD : 0);
      ROW_MEMORY const float* rest = restX + (i >> 1) + (i & 1 ? 2 * HALF_ROW : 0);
      const int state = StateOf(mesh->State, x, y, z, p);
      float4 position = (float4)(NO_SOURCE, 0.0f, 0.0f, 0.0f);
      if (state & DEFORMVOLUME_VERTEX_SOURCE)
      {
        const float4 moved =
          ROW_DISPLACEMENT + (float4)(rest[HALF_ROW], fractionY, fractionZ, 0.0f);
        position = RoundSteps_float4(moved, STEP) + (float4)(rest[0], wholeY, wholeZ, 0.0f);
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
    x -= again;
    i -= again;
    ROW_MEMORY float* place = row + (i >> 1);
    ROW_MEMORY const float* rest = restX + (i >> 1);
    ROW_DISPLACEMENTS_TOGETHER
#define POSITIONS(C, OFFSET, WHOLE_EVEN, WHOLE_ODD, FRACTION_EVEN, FRACTION_ODD)                   \
  {                                                                                                \
    const float16 moved = d##C + (float16)(FRACTION_EVEN, FRACTION_ODD);                           \
    const float16 position =                                                                       \
      RoundSteps_float16(moved, STEP) + (float16)(WHOLE_EVEN, WHOLE_ODD);                          \
    STORE_EIGHT(position.lo, place + (OFFSET)*HALF_ROW)                                            \
    STORE_EIGHT(position.hi, place + ODD + (OFFSET)*HALF_ROW)                                      \
  }
    POSITIONS(x, 0, vload8(0, rest), vload8(0, rest + 2 * HALF_ROW), vload8(0, rest + HALF_ROW),
      vload8(0, rest + 3 * HALF_ROW))
    POSITIONS(y, 1, (float8)wholeY, (float8)wholeY, (float8)fractionY, (float8)fractionY)
    POSITIONS(z, 2, (float8)wholeZ, (float8)wholeZ, (float8)fractionZ, (float8)fractionZ)
    if ((states & INTERIORS) != INTERIORS)
    {
      flags.Border |= FLAGS_TOGETHER << (i >> 3);
    }
    LANE_ARRAYS(PUT_VALUES_TOGETHER)
    x += 16;
    i += 16;
  }
  return flags;
}
