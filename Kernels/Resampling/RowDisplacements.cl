// SPDX-License-Identifier: BSD-3-Clause
// The displacements of the vertices of a row (BrickMapping.cl), one or sixteen at a time, with the operations of
// Displacement (DeformationMapping.cl) in the same order. The results for sixteen vertices are the displacements of the
// vertices in even slots, then of those in odd slots.

#ifdef __x86_64__
#define PREFETCH(address) __builtin_prefetch((const void*)(size_t)(address));
#define PREFETCH_TO_WRITE(address) __builtin_prefetch((const void*)(size_t)(address), 1);
#else
#define PREFETCH(address)
#define PREFETCH_TO_WRITE(address)
#endif

#define ROW_SLOTS (DEFORMVOLUME_BRICK_X + 16) // number of slots of a row; vectors may extend beyond its end

#define LOAD_UNALIGNED(slot) *(ROW_MEMORY const UnalignedFloat16*)(slot)

// A row, and the source of its displacements.
typedef struct
{
  const Mapping* Map;
  int Y, Z;
#if MAPPING == MAPPING_RUNS
  ROW_MEMORY const float* Displaced; // by slots of the row; x, y and z in separate rows
#elif MAPPING == MAPPING_FIELD_IN_PLACE
  __global const float* Vectors;
#elif MAPPING == MAPPING_LINKS
  __global const VertexLink* Links;
#endif
} DisplacedRow;

#if MAPPING == MAPPING_RUNS

// Finds the displacements of the vertices of a row from x to end, and stores them from slot i on, with x, y and z in
// separate rows. Displacements are affine within each run.
static void DisplaceRow(const Mapping* m, int x, int end, int i, int y, int z,
  ROW_MEMORY float* slots, const KernelParameters* p)
{
  const float16 steps = (float16)(0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f, 8.0f, 9.0f, 10.0f,
    11.0f, 12.0f, 13.0f, 14.0f, 15.0f);
  const uint2 range = RangeOf(m, y, z, p);
  const uint first = range.x;
  const uint last = range.y - 1;
  __global const VertexRun* run =
    m->Runs + (x == 0 ? first : FindRun(m->Runs, first, last + 1, x));
  __global const VertexRun* const lastRun = m->Runs + last;
  slots += i - x;
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
        // A broadcast is free if its operand is loaded from memory, but not if it is an element of a vector.
        ROW_MEMORY float* const slot = slots + x;
        const float16 offset = ((float)x + steps) - record->Origin[0];
#define DISPLACE_AXIS(axis, across)                                                                \
  *(ROW_MEMORY UnalignedFloat16*)(slot + (axis)*ROW_SLOTS) =                                        \
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

// Prepares the vertices from x to end. i: slot of vertex x. displaced: memory for their displacements.
static __attribute__((always_inline)) void BeginRow(DisplacedRow* row, int x, int end, int i,
  ROW_MEMORY float* displaced, const KernelParameters* p)
{
  row->Displaced = displaced;
  DisplaceRow(row->Map, x, end, i, row->Y, row->Z, displaced, p);
}

// Returns the displacement of vertex x, in slot i of the row.
static __attribute__((always_inline)) float4 DisplaceOne(
  const DisplacedRow* row, int x, int i, const KernelParameters* p)
{
  ROW_MEMORY const float* const slot = row->Displaced + i;
  return (float4)(slot[0], slot[ROW_SLOTS], slot[2 * ROW_SLOTS], 0.0f);
}

static __attribute__((always_inline)) void DisplaceSixteen(const DisplacedRow* row, int x, int i,
  float16* dx, float16* dy, float16* dz, const KernelParameters* p)
{
  const float16 xs = LOAD_UNALIGNED(row->Displaced + i);
  const float16 ys = LOAD_UNALIGNED(row->Displaced + i + ROW_SLOTS);
  const float16 zs = LOAD_UNALIGNED(row->Displaced + i + 2 * ROW_SLOTS);
  *dx = (float16)(xs.even, xs.odd);
  *dy = (float16)(ys.even, ys.odd);
  *dz = (float16)(zs.even, zs.odd);
}

#elif MAPPING == MAPPING_FIELD_IN_PLACE

static __attribute__((always_inline)) void BeginRow(DisplacedRow* row, int x, int end, int i,
  ROW_MEMORY float* displaced, const KernelParameters* p)
{
  row->Vectors = row->Map->Vectors + 3 * PointOf(&row->Map->Field, 0, row->Y, row->Z);
}

static __attribute__((always_inline)) float4 DisplaceOne(
  const DisplacedRow* row, int x, int i, const KernelParameters* p)
{
  return Displacement(row->Map, x, row->Y, row->Z, p);
}

static __attribute__((always_inline)) void DisplaceSixteen(const DisplacedRow* row, int x, int i,
  float16* dx, float16* dy, float16* dz, const KernelParameters* p)
{
  // Three floats per vertex: the x of even vertices are every sixth value from the first one on, and so on.
  const float16 v0 = vload16(0, row->Vectors + 3 * x);
  const float16 v1 = vload16(1, row->Vectors + 3 * x);
  const float16 v2 = vload16(2, row->Vectors + 3 * x);
  const float16 vx = (float16)(v0.s06c, v1.s28e, v2.s4a, v0.s39f, v1.s5b, v2.s17d);
  const float16 vy = (float16)(v0.s17d, v1.s39f, v2.s5b, v0.s4a, v1.s06c, v2.s28e);
  const float16 vz = (float16)(v0.s28e, v1.s4a, v2.s06c, v0.s5b, v1.s17d, v2.s39f);
  *dx = vx;
  *dy = vy;
  *dz = vz;
  if (row->Map->Field.IsMapped)
  {
#define MAP_VECTORS(axis) ROW_PRODUCT(&row->Map->Field, axis, float16, double16, vx, vy, vz)
    *dx = MAP_VECTORS(0);
    *dy = MAP_VECTORS(1);
    *dz = MAP_VECTORS(2);
  }
}

#else

#if MAPPING == MAPPING_LINKS

// Broadcasts element i of each group of four to the whole group.
#ifdef __clang__
#define OF_EACH_FOUR(v, i)                                                                         \
  __builtin_shufflevector(v, v, i, i, i, i, i + 4, i + 4, i + 4, i + 4, i + 8, i + 8, i + 8,       \
    i + 8, i + 12, i + 12, i + 12, i + 12)
#else
#define OF_EACH_FOUR(v, i)                                                                         \
  shuffle(v, (uint16)(i, i, i, i, i + 4, i + 4, i + 4, i + 4, i + 8, i + 8, i + 8, i + 8, i + 12,  \
               i + 12, i + 12, i + 12))
#endif

// The offsets of two nodes are read as one 64-bit number, because loads take most of the time here. These macros load
// the node with the first or with the second offset.
#ifdef __ENDIAN_LITTLE__
#define FIRST_NODE(m, offsets) NODE((m)->Nodes, (ulong)(uint)(offsets))
#define SECOND_NODE(m, offsets) NODE((m)->Nodes, (offsets) >> 32)
#else
#define FIRST_NODE(m, offsets) NODE((m)->Nodes, (offsets) >> 32)
#define SECOND_NODE(m, offsets) NODE((m)->Nodes, (ulong)(uint)(offsets))
#endif
#define FOUR_NODES(WHICH, m, offsets)                                                              \
  (float16)(WHICH##_NODE(m, offsets##0), WHICH##_NODE(m, offsets##1), WHICH##_NODE(m, offsets##2), \
    WHICH##_NODE(m, offsets##3))

// Returns the displacements of four vertices with consecutive links, with the operations of FollowLink.
static float16 FollowFourLinks(const Mapping* m, __global const VertexLink* links)
{
  const float16 four = *(__global const UnalignedFloat16*)links;
  const float16 a = OF_EACH_FOUR(four, 1);
  const float16 b = OF_EACH_FOUR(four, 2);
  const float16 c = OF_EACH_FOUR(four, 3);
  const float16 d = 1.0f - a - b - c;
#define LOAD_NODE_OFFSETS(k)                                                                       \
  __global const ulong* const tetrahedron##k =                                                     \
    (__global const ulong*)(m->Tetrahedra + links[k].Tetrahedron);                                 \
  const ulong xy##k = tetrahedron##k[0];                                                           \
  const ulong zw##k = tetrahedron##k[1];
  LOAD_NODE_OFFSETS(0)
  LOAD_NODE_OFFSETS(1)
  LOAD_NODE_OFFSETS(2)
  LOAD_NODE_OFFSETS(3)
  return MULTIPLY_ADD(FOUR_NODES(SECOND, m, zw), d,
    MULTIPLY_ADD(FOUR_NODES(FIRST, m, zw), c,
      MULTIPLY_ADD(FOUR_NODES(SECOND, m, xy), b, FOUR_NODES(FIRST, m, xy) * a)));
}

static __attribute__((always_inline)) void BeginRow(DisplacedRow* row, int x, int end, int i,
  ROW_MEMORY float* displaced, const KernelParameters* p)
{
  row->Links = row->Map->Links + VertexInChunk(0, row->Y, row->Z, p);
}

static __attribute__((always_inline)) float4 DisplaceOne(
  const DisplacedRow* row, int x, int i, const KernelParameters* p)
{
  return FollowLink(row->Map, row->Links + x);
}

static __attribute__((always_inline)) float16 DisplaceFour(
  const DisplacedRow* row, int x, const KernelParameters* p)
{
  return FollowFourLinks(row->Map, row->Links + x);
}

// Prefetches the links of the next row. Most of the memory that is read holds links, and each link is read once.
static __attribute__((always_inline)) void FetchAhead(
  const DisplacedRow* row, int x, const KernelParameters* p)
{
  __global const VertexLink* const next = row->Links + p->Size[0] + x;
  PREFETCH(next)
  PREFETCH(next + 4)
  PREFETCH(next + 8)
  PREFETCH(next + 12)
}

#else

static __attribute__((always_inline)) void BeginRow(DisplacedRow* row, int x, int end, int i,
  ROW_MEMORY float* displaced, const KernelParameters* p)
{
}

static __attribute__((always_inline)) float4 DisplaceOne(
  const DisplacedRow* row, int x, int i, const KernelParameters* p)
{
  return Displacement(row->Map, x, row->Y, row->Z, p);
}

static __attribute__((always_inline)) float16 DisplaceFour(
  const DisplacedRow* row, int x, const KernelParameters* p)
{
  return (float16)(Displacement(row->Map, x, row->Y, row->Z, p),
    Displacement(row->Map, x + 1, row->Y, row->Z, p),
    Displacement(row->Map, x + 2, row->Y, row->Z, p),
    Displacement(row->Map, x + 3, row->Y, row->Z, p));
}

static __attribute__((always_inline)) void FetchAhead(
  const DisplacedRow* row, int x, const KernelParameters* p)
{
}

#endif

static __attribute__((always_inline)) void DisplaceSixteen(const DisplacedRow* row, int x, int i,
  float16* dx, float16* dy, float16* dz, const KernelParameters* p)
{
  FetchAhead(row, x, p);
  const float16 d0 = DisplaceFour(row, x, p);
  const float16 d4 = DisplaceFour(row, x + 4, p);
  const float16 d8 = DisplaceFour(row, x + 8, p);
  const float16 d12 = DisplaceFour(row, x + 12, p);
  // Combine two vectors at a time: this is a single instruction.
  const float16 xyLow =
    (float16)(d0.s08, d4.s08, d0.s4c, d4.s4c, d0.s19, d4.s19, d0.s5d, d4.s5d);
  const float16 xyHigh =
    (float16)(d8.s08, d12.s08, d8.s4c, d12.s4c, d8.s19, d12.s19, d8.s5d, d12.s5d);
  const float16 zLow = (float16)(d0.s2a, d4.s2a, d0.s6e, d4.s6e, d0.s2a, d4.s2a, d0.s6e, d4.s6e);
  const float16 zHigh =
    (float16)(d8.s2a, d12.s2a, d8.s6e, d12.s6e, d8.s2a, d12.s2a, d8.s6e, d12.s6e);
  *dx = (float16)(xyLow.s0123, xyHigh.s0123, xyLow.s4567, xyHigh.s4567);
  *dy = (float16)(xyLow.s89ab, xyHigh.s89ab, xyLow.scdef, xyHigh.scdef);
  *dz = (float16)(zLow.s0123, zHigh.s0123, zLow.s4567, zHigh.s4567);
}

#endif
