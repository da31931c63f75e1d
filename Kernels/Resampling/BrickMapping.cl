// SPDX-License-Identifier: BSD-3-Clause
// Maps the rows of vertices that ResampleBricks (BrickResampling.cl) works on. Positions (PacketVertices.cl) and
// values of the arrays are written to memory.
//
// Vertices are mapped sixteen at a time, with the operations of PositionOf (DeformationMapping.cl) in the same order.
// If one of the sixteen has no position, the vertices are mapped one at a time. The last sixteen vertices of a row may
// include vertices that were mapped before.

// Properties of the vertices of a row: one bit for each eight vertices, the lowest first.
typedef struct
{
  uint Border;  // one of the eight is not interior
  uint Special; // one has a value that IS_SPECIAL (PacketVertices.cl)
#if HAS_CUT
  uint Split; // one has different positions for the two sides of a smooth cut
#endif
} RowFlags;

// A bit of the states of eight vertices, which are eight bytes.
#define OF_EIGHT(bit) ((bit) * 0x0101010101010101UL)
#define SOURCES OF_EIGHT(DEFORMVOLUME_VERTEX_SOURCE)
#define INTERIORS OF_EIGHT(DEFORMVOLUME_VERTEX_INTERIOR)
#define TOGETHER OF_EIGHT(DEFORMVOLUME_VERTEX_UNSPLIT)

// Returns the states of sixteen vertices of a row as eight bytes. Byte k has the bits that vertices k and k + 8 have in
// common. rowInside: whether the row is not at the border of the volume.
static ulong StatesOf(
  __global const uchar* rowState, int x, int rowInside, const KernelParameters* p)
{
  if (p->HasState)
  {
    const ulong2 states = as_ulong2(vload16(0, rowState + x));
    return states.x & states.y;
  }
  return SOURCES | TOGETHER | (rowInside && x > 0 && x + 16 < p->Size[0] ? INTERIORS : 0);
}

#define STORE_EIGHT(v, slot) *(ROW_MEMORY UnalignedFloat8*)(slot) = v;
#define FLAGS_OF_SIXTEEN 7u // the RowFlags bits that sixteen vertices can belong to

#define PUT_VALUE(index, TYPE, BITS, SLOT)                                                         \
  {                                                                                                \
    const float value = (float)source##index[row->Chunk + x];                                      \
    slot[(3 + SLOT) * HALF_ROW] = value;                                                          \
    if (BITS == 32 && IS_SPECIAL(as_int(value)))                                                   \
    {                                                                                              \
      flags->Special |= 1u << (i >> 3);                                                            \
    }                                                                                              \
  }
#define PUT_SIXTEEN_VALUES(index, TYPE, BITS, SLOT)                                                \
  {                                                                                                \
    const float16 value = convert_float16(vload16(0, source##index + row->Chunk + x));             \
    STORE_EIGHT(value.even, slot + (3 + SLOT) * HALF_ROW)                                         \
    STORE_EIGHT(value.odd, slot + ODD + (3 + SLOT) * HALF_ROW)                                    \
    if (BITS == 32)                                                                                \
    {                                                                                              \
      if (any(IS_SPECIAL(as_int16(value))))                                                        \
      {                                                                                            \
        flags->Special |= FLAGS_OF_SIXTEEN << (i >> 3);                                            \
      }                                                                                            \
    }                                                                                              \
  }

// A row has few values, and the next row is far away in memory: prefetch it.
#define FETCH_NEXT_ROW(index, TYPE, BITS, SLOT)                                                    \
  for (int k = x; k < end; k += 512 / BITS)                                                        \
  {                                                                                                \
    PREFETCH(source##index + row.Chunk + p->Size[0] + k)                                           \
  }

// The part of the rest positions that depends on x: whole steps of 1/256 voxel relative to the output, then the
// remainders, HALF_ROW each, for even and then for odd vertices. If the axes of the volume are those of the output,
// there is one component x, in voxels. Otherwise there are summands for x, y and z, with the whole steps as integers.
#if HAS_TURNED_AXES
#define REST_ODD (6 * HALF_ROW)
#else
#define REST_ODD (2 * HALF_ROW)
#endif

// A row of vertices while it is mapped.
typedef struct
{
  DisplacedRow Displaced;
  size_t Chunk; // index of the row's first vertex in the chunk
  ROW_MEMORY const float* RestX;
  // The part of the rest positions that depends on y and z: whole steps relative to the output, and remainders.
#if HAS_TURNED_AXES
  int Whole[3];
  float Fraction[3];
#else
  float WholeY, WholeZ;
  float FractionY, FractionZ;
#endif
  ROW_MEMORY float* Slots; // output: positions and values
} MappedRow;

// The rest position of the vertex in slot i of the row: whole steps, in voxels, and the remainder.
#if HAS_TURNED_AXES
#define REST_WHOLE(axis)                                                                           \
  ((float)(((ROW_MEMORY const int*)rest)[2 * (axis)*HALF_ROW] + row->Whole[axis]) * STEP)
#define REST_FRACTION(axis) (rest[(2 * (axis) + 1) * HALF_ROW] + row->Fraction[axis])
#define REST_WHOLES (float4)(REST_WHOLE(0), REST_WHOLE(1), REST_WHOLE(2), 0.0f)
#define REST_FRACTIONS (float4)(REST_FRACTION(0), REST_FRACTION(1), REST_FRACTION(2), 0.0f)
#else
#define REST_WHOLES (float4)(rest[0], row->WholeY, row->WholeZ, 0.0f)
#define REST_FRACTIONS (float4)(rest[HALF_ROW], row->FractionY, row->FractionZ, 0.0f)
#endif

// Maps vertex x to slot i of the row.
static __attribute__((always_inline)) void MapOne(const MappedRow* row, int x, int i, int state,
  RowFlags* flags, const KernelParameters* p ARRAY_PARAMETERS)
{
  ROW_MEMORY float* const slot = row->Slots + (i >> 1) + (i & 1 ? ODD : 0);
  ROW_MEMORY const float* const rest = row->RestX + (i >> 1) + (i & 1 ? REST_ODD : 0);
  float4 position = (float4)(NO_SOURCE, 0.0f, 0.0f, 0.0f);
  if (state & DEFORMVOLUME_VERTEX_SOURCE)
  {
    const float4 moved = DisplaceOne(&row->Displaced, x, i, p) + REST_FRACTIONS;
    position = RoundSteps_float4(moved, STEP) + REST_WHOLES;
  }
  slot[0] = position.x;
  slot[HALF_ROW] = position.y;
  slot[2 * HALF_ROW] = position.z;
  if (!(state & DEFORMVOLUME_VERTEX_INTERIOR))
  {
    flags->Border |= 1u << (i >> 3);
  }
#if HAS_CUT
  if (!(state & DEFORMVOLUME_VERTEX_UNSPLIT))
  {
    flags->Split |= 1u << (i >> 3);
  }
#endif
  LANE_ARRAYS(PUT_VALUE)
}

// Maps sixteen vertices from x on, all of which have a position, to the slots from i on. states: from StatesOf.
static __attribute__((always_inline)) void MapSixteen(const MappedRow* row, int x, int i,
  ulong states, RowFlags* flags, const KernelParameters* p ARRAY_PARAMETERS)
{
  ROW_MEMORY float* const slot = row->Slots + (i >> 1);
  ROW_MEMORY const float* const rest = row->RestX + (i >> 1);
  float16 dx, dy, dz;
  DisplaceSixteen(&row->Displaced, x, i, &dx, &dy, &dz, p);
#define POSITIONS(d, OFFSET, WHOLE, FRACTION)                                                       \
  {                                                                                                \
    const float16 moved = d + FRACTION;                                                            \
    const float16 position = RoundSteps_float16(moved, STEP) + WHOLE;                              \
    STORE_EIGHT(position.lo, slot + (OFFSET)*HALF_ROW)                                            \
    STORE_EIGHT(position.hi, slot + ODD + (OFFSET)*HALF_ROW)                                      \
  }
#if HAS_TURNED_AXES
#define POSITIONS_ALONG(d, AXIS)                                                                   \
  {                                                                                                \
    ROW_MEMORY const int* const whole = (ROW_MEMORY const int*)rest + 2 * AXIS * HALF_ROW;         \
    const int16 steps = (int16)(vload8(0, whole), vload8(0, whole + REST_ODD)) + row->Whole[AXIS]; \
    const float16 fraction = (float16)(vload8(0, rest + (2 * AXIS + 1) * HALF_ROW),                \
                               vload8(0, rest + REST_ODD + (2 * AXIS + 1) * HALF_ROW)) +           \
      row->Fraction[AXIS];                                                                         \
    POSITIONS(d, AXIS, convert_float16(steps) * STEP, fraction)                                    \
  }
  POSITIONS_ALONG(dx, 0)
  POSITIONS_ALONG(dy, 1)
  POSITIONS_ALONG(dz, 2)
#else
  POSITIONS(dx, 0, (float16)(vload8(0, rest), vload8(0, rest + REST_ODD)),
    (float16)(vload8(0, rest + HALF_ROW), vload8(0, rest + REST_ODD + HALF_ROW)))
  POSITIONS(dy, 1, row->WholeY, row->FractionY)
  POSITIONS(dz, 2, row->WholeZ, row->FractionZ)
#endif
  if ((states & INTERIORS) != INTERIORS)
  {
    flags->Border |= FLAGS_OF_SIXTEEN << (i >> 3);
  }
#if HAS_CUT
  if ((states & TOGETHER) != TOGETHER)
  {
    flags->Split |= FLAGS_OF_SIXTEEN << (i >> 3);
  }
#endif
  LANE_ARRAYS(PUT_SIXTEEN_VALUES)
}

// Returns how many vertices must be mapped again so that the last sixteen vertices end at `end`. The first of these
// must have an even slot.
static int CountRepeated(int x, int begin, int end, int i)
{
  if (x + 1 >= end || x + 16 <= end)
  {
    return 0;
  }
  int repeated = x + 16 - end;
  repeated += (i - repeated) & 1;
  return repeated > x - begin ? 0 : repeated;
}

// Maps the vertices of a row from x to end. i: slot of vertex x in the row.
static RowFlags MapRow(const SamplingMesh* mesh, int x, int end, int i, int y, int z,
  ROW_MEMORY float* slots, ROW_MEMORY const float* restX, ROW_MEMORY float* displaced,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  MappedRow row;
  row.Displaced.Map = &mesh->Map;
  row.Displaced.Y = y;
  row.Displaced.Z = z;
  row.Chunk = VertexInChunk(0, y, z, p);
  row.RestX = restX;
#if HAS_TURNED_AXES
  const RestVector ry = mesh->Map.Rest[p->Size[0] + y];
  const RestVector rz = mesh->Map.Rest[p->Size[0] + p->Size[1] + z];
  for (int axis = 0; axis < 3; ++axis)
  {
    row.Whole[axis] = ry.Whole[axis] + rz.Whole[axis];
    row.Fraction[axis] = (ry.Fraction[axis] + rz.Fraction[axis]) * STEP;
  }
#else
  const RestPosition ry = mesh->Map.Rest[p->Size[0] + y];
  const RestPosition rz = mesh->Map.Rest[p->Size[0] + p->Size[1] + z];
  row.WholeY = (ry.Whole - p->OutputFirst[1] * 256) * STEP;
  row.WholeZ = (rz.Whole - p->OutputFirst[2] * 256) * STEP;
  row.FractionY = ry.Fraction * STEP;
  row.FractionZ = rz.Fraction * STEP;
#endif
  row.Slots = slots;
  BeginRow(&row.Displaced, x, end, i, displaced, p);
  LANE_ARRAYS(FETCH_NEXT_ROW)
  RowFlags flags = { 0 };
  const int begin = x;
  const int rowInside = y > 0 && y < p->Size[1] - 1 && z > 0 && z < p->Size[2] - 1;
  __global const uchar* const rowState = mesh->State + row.Chunk;
  while (x < end)
  {
    const int repeated = CountRepeated(x, begin, end, i);
    const ulong states = x - repeated + 16 <= end ? StatesOf(rowState, x - repeated, rowInside, p) : 0;
    if (((i - repeated) & 1) || (states & SOURCES) != SOURCES)
    {
      MapOne(&row, x, i, StateOf(mesh->State, x, y, z, p), &flags, p ARRAY_ARGUMENTS);
      ++x;
      ++i;
    }
    else
    {
      x -= repeated;
      i -= repeated;
      MapSixteen(&row, x, i, states, &flags, p ARRAY_ARGUMENTS);
      x += 16;
      i += 16;
    }
  }
  return flags;
}
