// SPDX-License-Identifier: BSD-3-Clause
// The fill rule of CellCoverage.cl for a packet of cells in 32-bit integers, for samples that floats do not decide
// (BrickResampling.cl).

#define MAXIMUM_EXACT_EXTENT 3.99f // voxels: edge functions of larger cells need more than 32 bits

// The surroundings of the cells of a packet at the border of the sampling mesh.
typedef struct
{
  INTS Whole;    // whether all five tetrahedra are active and have positions
  INTS Interior; // masks as in CellState
  INTS Regular;
} PacketState;

// Loads the states of the vertices of a packet's cells in a row: the vertex of lower x in the lowest byte, that of
// higher x in the next byte.
static INTS LoadStates(__global const uchar* row)
{
#if LANES == 16
  return convert_int16((ushort16)(as_ushort8(vload16(0, row)), as_ushort8(vload16(1, row))));
#elif LANES == 8
  return convert_int8(as_ushort8(vload16(0, row)));
#elif LANES == 4
  return convert_int4(as_ushort4(vload8(0, row)));
#else
  return row[0] | row[1] << 8;
#endif
}

// Returns where the states of a packet's vertices begin; null if some lie outside the array of states. (For cells
// outside the volume, states of other vertices are read.)
static __global const uchar* BeginStates(const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  const long row = p->Size[0];
  const long plane = row * p->Size[1];
  const long first = (z - p->ChunkFirst) * plane + y * row + x;
  return first < 0 || first + plane + row + 2 * LANES > (p->PlanesEnd - p->PlanesBegin) * plane
    ? 0
    : mesh->State + first;
}

// Adds the vertices of a row to masks as in CellState. o: number of the lower vertex without mirroring.
static void AddStates(INTS row, int o, int mirror, PacketState* states)
{
  const int low = 1 << (o ^ mirror);
  const int high = 1 << ((o | 1) ^ mirror);
  states->Interior |= WHERE((row & DEFORMVOLUME_VERTEX_INTERIOR) != 0, low) |
    WHERE((row & DEFORMVOLUME_VERTEX_INTERIOR << 8) != 0, high);
  states->Regular |= WHERE((row & DEFORMVOLUME_VERTEX_REGULAR) != 0, low) |
    WHERE((row & DEFORMVOLUME_VERTEX_REGULAR << 8) != 0, high);
}

// Loads states vertex by vertex, if a packet extends beyond the array of states: memory outside the array must not be
// read.
static void StatesOfLanes(
  const SamplingMesh* mesh, int x, int y, int z, INTS inVolume, PacketState* states, const KernelParameters* p)
{
  Lanes whole, interior, regular;
  whole.Vector = inVolume;
  for (int lane = 0; lane < LANES; ++lane)
  {
    CellState state = { 0, 0 };
    if (whole.Lanes[lane])
    {
      const int cell = x + 2 * lane;
      whole.Lanes[lane] =
        mesh->State[VertexInChunk(cell, y, z, p)] & DEFORMVOLUME_CELL_WHOLE ? -1 : 0;
      state = CellStateOf(mesh, cell, y, z, p);
    }
    interior.Lanes[lane] = state.Interior;
    regular.Lanes[lane] = state.Regular;
  }
  states->Whole = whole.Vector;
  states->Interior = interior.Vector;
  states->Regular = regular.Vector;
}

static COLD void StatesOfPacket(const SamplingMesh* mesh, int x, int y, int z,
  PacketState* states, const KernelParameters* p)
{
  const INTS cellX = x + 2 * LANE_INDEX;
  const INTS inVolume = (cellX >= 0) & (cellX < p->Size[0] - 1);
  if (!p->HasState)
  {
    // Without states, all vertices inside the volume are interior.
    const int mirror = Mirror(x, y, z, p);
    const int lowX = LOW_SIDE(0, mirror), lowZ = LOW_SIDE(1, mirror), lowY = LOW_SIDE(2, mirror);
    const int outer = (y == 0 ? lowY : 0) | (y == p->Size[1] - 2 ? 255 ^ lowY : 0) |
      (z == 0 ? lowZ : 0) | (z == p->Size[2] - 2 ? 255 ^ lowZ : 0);
    states->Whole = inVolume;
    states->Regular = 255;
    states->Interior =
      ~(outer | WHERE(cellX == 0, lowX) | WHERE(cellX == p->Size[0] - 2, 255 ^ lowX)) & 255;
    return;
  }
  __global const uchar* const state = BeginStates(mesh, x, y, z, p);
  if (!state)
  {
    StatesOfLanes(mesh, x, y, z, inVolume, states, p);
    return;
  }
  const int mirror = Mirror(x, y, z, p);
  const long row = p->Size[0];
  const long plane = row * p->Size[1];
  const INTS here = LoadStates(state);
  states->Interior = 0;
  states->Regular = 0;
  AddStates(here, 0, mirror, states);
  AddStates(LoadStates(state + plane), 2, mirror, states);
  AddStates(LoadStates(state + row), 4, mirror, states);
  AddStates(LoadStates(state + plane + row), 6, mirror, states);
  states->Whole = inVolume & ((here & DEFORMVOLUME_CELL_WHOLE) != 0);
  states->Interior = WHERE(inVolume, states->Interior);
  states->Regular = WHERE(inVolume, states->Regular);
}

#if HAS_CUT
// The same as FindDivided, vertex by vertex, like StatesOfLanes.
static uint FindDividedLanes(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  uint divided = 0;
  for (int lane = 0; lane < LANES; ++lane)
  {
    const int cell = x + 2 * lane;
    if (cell < 0 || cell >= p->Size[0] - 1)
    {
      continue;
    }
    int all = DEFORMVOLUME_VERTEX_UNSPLIT;
    for (int o = 0; o < 8; ++o)
    {
      all &= mesh->State[VertexInChunk(cell + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), p)];
    }
    const int crossed =
      !(mesh->State[VertexInChunk(cell, y, z, p)] & DEFORMVOLUME_CELL_UNCROSSED);
    divided |= (uint)(crossed && !all) << lane;
  }
  return divided;
}

// Returns the bits of cells of a packet that a smooth cut may divide (CutCells.cl): crossed cells with a vertex that
// has different positions for the two sides.
static COLD uint FindDivided(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  __global const uchar* const state = BeginStates(mesh, x, y, z, p);
  if (!state)
  {
    return FindDividedLanes(mesh, x, y, z, p);
  }
  const long row = p->Size[0];
  const long plane = row * p->Size[1];
  const INTS here = LoadStates(state);
  const INTS all = here & LoadStates(state + row) & LoadStates(state + plane) & LoadStates(state + plane + row);
  const INTS together = (INTS)(DEFORMVOLUME_VERTEX_UNSPLIT * 257); // both vertices of a row
  return LaneBits(((here & DEFORMVOLUME_CELL_UNCROSSED) == 0) & ((all & together) != together));
}
#endif

// Returns which lanes own a sample by the fill rule, from edge functions in 32-bit integers. All tetrahedra of a cell
// must be upright, or all inverted, and smaller than MAXIMUM_EXACT_EXTENT; edge functions are then at most 2 (256
// extent)^3. Normals are at most 2 (256 extent)^2 each, and three times that in total. They are exact in float, in
// which products are cheaper. sample: in voxels relative to vertex 0 of the cell. inverted: lanes with inverted
// tetrahedra. simplex: the vertices of the simplex that contains the sample, 0 if it is not in the cell.
static COLD INTS HoldSample(
  const Packet* packet, const FLOATS* sample, int odd, INTS inverted, INTS* simplex)
{
#if LANES > 1
  FLOATS q[8][3];
  for (int v = 0; v < 8; ++v)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      q[v][axis] = VERTEX(v, axis) - VERTEX(0, axis);
    }
  }
#define RELATIVE(v, axis) q[v][axis]
#else
  // To save registers, vertices are loaded again.
#define RELATIVE(v, axis) (VERTEX(v, axis) - VERTEX(0, axis))
#endif
  INTS held = 0;
  *simplex = 0;
  NOT_UNROLLED
  for (int t = 0; t < 5; ++t)
  {
    FLOATS e[3][3]; // edges from the first vertex to the others
    FLOATS n[4][3]; // normals of the faces opposite each vertex
    INTS r[3]; // the sample, in 1/256 voxel
    UNROLLED
    for (int axis = 0; axis < 3; ++axis)
    {
      const FLOATS first = RELATIVE(Tetrahedra[t][0], axis);
      r[axis] = TO_INTS((sample[axis] - first) * 256.0f);
      UNROLLED
      for (int k = 0; k < 3; ++k)
      {
        e[k][axis] = RELATIVE(Tetrahedra[t][k + 1], axis) - first;
      }
    }
    // Orient the normals inwards, according to the parity of the cell.
    const INTS negative = odd != (t == 4) ? !inverted : inverted;
#define NORMAL_OF(k, u, v)                                                                         \
  {                                                                                                \
    const FLOATS normal = fma(e[u][a], e[v][b], -(e[u][b] * e[v][a]));                             \
    n[k][axis] = negative ? -normal : normal;                                                      \
  }
    UNROLLED
    for (int axis = 0; axis < 3; ++axis)
    {
      const int a = (axis + 1) % 3;
      const int b = (axis + 2) % 3;
      NORMAL_OF(1, 1, 2)
      NORMAL_OF(2, 2, 0)
      NORMAL_OF(3, 0, 1)
      n[0][axis] = -(n[1][axis] + n[2][axis] + n[3][axis]);
    }
#undef NORMAL_OF
    // The product of a normal, in 1/65536 square voxel, and a vector in 1/256 voxel.
#define PRODUCT(k, v) (TO_INTS(n[k][0] * 65536.0f) * (v)[0] + TO_INTS(n[k][1] * 65536.0f) * (v)[1] + \
  TO_INTS(n[k][2] * 65536.0f) * (v)[2])
    const INTS edge[3] = { TO_INTS(e[0][0] * 256.0f), TO_INTS(e[0][1] * 256.0f),
      TO_INTS(e[0][2] * 256.0f) };
    INTS first = PRODUCT(1, edge);
    INTS inside = -1;
    INTS closed = -1;
    INTS vertices = 0;
    UNROLLED
    for (int k = 3; k >= 0; --k)
    {
      const INTS f = k ? PRODUCT(k, r) : first;
      first -= f;
      // The same rule as ShiftsInside.
      inside &= (f > 0) |
        ((f == 0) &
          ((n[k][0] > 0.0f) |
            ((n[k][0] == 0.0f) &
              ((n[k][1] > 0.0f) | ((n[k][1] == 0.0f) & (n[k][2] > 0.0f))))));
      closed &= f >= 0;
      vertices |= WHERE(f > 0, 1 << Tetrahedra[t][k]);
    }
#undef PRODUCT
    held |= inside;
    *simplex |= WHERE(closed, vertices);
  }
#undef RELATIVE
  return held;
}

// Returns the bits of lanes whose sample lies in the output. x, y, z: in output voxels.
static __attribute__((always_inline)) uint InOutput(
  FLOATS x, FLOATS y, FLOATS z, const KernelParameters* p)
{
  const INTS ix = TO_INTS(x), iy = TO_INTS(y), iz = TO_INTS(z);
  return LaneBits((ix >= 0) & (ix < p->OutputSize[0]) & (iy >= 0) & (iy < p->OutputSize[1]) &
    (iz >= 0) & (iz < p->OutputSize[2]));
}

// Marks the samples that lanes, given by bits, hold but do not own. x, y, z: in output voxels.
static COLD void TouchHeld(
  uint lanes, FLOATS x, FLOATS y, FLOATS z, Output* output, const KernelParameters* p)
{
  Lanes voxel[3];
  voxel[0].Vector = TO_INTS(x);
  voxel[1].Vector = TO_INTS(y);
  voxel[2].Vector = TO_INTS(z);
  // Part of a cell may lie outside the output.
  uint bits = lanes & InOutput(x, y, z, p);
  FOR_EACH_LANE(lane, bits)
  {
    Touch(voxel[0].Lanes[lane], voxel[1].Lanes[lane], voxel[2].Lanes[lane], output, p);
  }
}

// Returns the lanes whose cell owns a simplex at the border of the volume, if all cells exist there: the rule of
// IsOwnerByIndex.
static __attribute__((always_inline)) INTS OwnByIndex(
  const Packet* packet, INTS simplex, int mirror, const KernelParameters* p)
{
  const INTS isLastX = packet->X + 2 * LANE_INDEX == p->Size[0] - 2;
  const INTS isLastY = packet->Y == p->Size[1] - 2 ? -1 : 0;
  const INTS isLastZ = packet->Z == p->Size[2] - 2 ? -1 : 0;
  return (((simplex & LOW_SIDE(0, mirror)) != 0) | isLastX) &
    (((simplex & LOW_SIDE(1, mirror)) != 0) | isLastZ) &
    (((simplex & LOW_SIDE(2, mirror)) != 0) | isLastY);
}

// Returns which cells of undecidedByFloats, as bits, own their sample. state: of the packet, if it is at the border
// of the mesh. onVertex: lanes whose sample is a vertex. needsInt64: output: cells for ResampleCell are added. Other
// parameters are as for HoldSample.
static __attribute__((always_inline)) uint DecideByIntegers(const Packet* packet, uint undecidedByFloats,
  const FLOATS* sample, INTS inverted, const PacketState* state, INTS* onVertex, uint* needsInt64,
  Output* output, const KernelParameters* p)
{
  INTS simplex;
  INTS held = HoldSample(packet, sample, packet->Parity, inverted, &simplex);
  if (packet->Border)
  {
    // The same rule as RoleOf.
    const INTS outer = (simplex != 0) & ((simplex & state->Interior) == 0);
    const INTS regular = (simplex & ~state->Regular) == 0;
    held = outer ? OwnByIndex(packet, simplex, Mirror(packet->X, packet->Y, packet->Z, p), p) & regular
                 : held;
    *needsInt64 |= undecidedByFloats & LaneBits(outer & ~regular);
    output->Assumed |= (undecidedByFloats & LaneBits(outer)) != 0;
  }
  if (p->Pass == DEFORMVOLUME_PASS_OWNERS)
  {
    TouchHeld(undecidedByFloats & LaneBits(~held & (simplex != 0)), sample[0] + VERTEX(0, 0),
      sample[1] + VERTEX(0, 1), sample[2] + VERTEX(0, 2), output, p);
  }
#if LANES > 1
  *onVertex = LanesOf(undecidedByFloats) & ((simplex & (simplex - 1)) == 0);
#else
  // Oclgrind lacks a function that its compiler would use for the expression above.
  *onVertex = undecidedByFloats && popcount(simplex) < 2;
#endif
  return undecidedByFloats & LaneBits(held);
}

// Whether a cell owns a sample on one of its vertices at the border of the sampling mesh. The cell must be aligned,
// with all of its tetrahedra and coordinates that grow with the indices. Of its tetrahedra at the vertex, the candidate
// is the one at the edge along x, into which a shift away from the vertex leads.
static COLD int OwnsVertex(
  const SamplingMesh* mesh, int x, int y, int z, int vertex, const KernelParameters* p)
{
  const int edge = 1 << vertex | 1 << (vertex ^ 1);
  int tetrahedron = 0;
  while ((VerticesOf(tetrahedron) & edge) != edge)
  {
    ++tetrahedron;
  }
#if HAS_CUT
  long weights[4];
  for (int k = 0; k < 4; ++k)
  {
    weights[k] = Tetrahedra[tetrahedron][k] == vertex;
  }
  const int side = SideOfSample(mesh, x, y, z, tetrahedron, weights, p);
#else
  const int side = 0;
#endif
  const int high = vertex ^ Mirror(x, y, z, p); // bits of the axes on whose high side the vertex is
  const int shift = (high & 1) | (high >> 2 & 1) << 1 | (high >> 1 & 1) << 2;
  Neighbors near;
  const SamplingMesh keeping = KeepNeighbors(mesh, x, y, z, &near);
  return IsOwnerOnBorder(&keeping, x, y, z, tetrahedron, 1 << vertex, shift, side, p);
}

// Returns which of the given cells, as bits, own their sample, which is a vertex. The cells are as for OwnsVertex.
// simplex: the vertex as a mask. x, y, z: the sample, in output voxels.
static COLD uint DecideOnVertices(const Packet* packet, uint cells, INTS simplex,
  const PacketState* state, FLOATS x, FLOATS y, FLOATS z, const SamplingMesh* mesh, Output* output,
  const KernelParameters* p)
{
  const int mirror = Mirror(packet->X, packet->Y, packet->Z, p);
  const INTS lowest = simplex == 1 << mirror;
  const INTS outer = (simplex & state->Interior) == 0;
  const INTS regular = (simplex & state->Regular) != 0;
  // A cell owns its lowest vertex: the shift +++ leads into the cell.
  uint held = cells & LaneBits((outer & regular) ? OwnByIndex(packet, simplex, mirror, p) : lowest);
  output->Assumed |= (cells & LaneBits(outer)) != 0;
  uint open = cells & LaneBits(outer & ~regular & ~lowest);
  Lanes vertices;
  vertices.Vector = simplex;
  FOR_EACH_LANE(lane, open)
  {
    const int vertex = 31 - clz((uint)vertices.Lanes[lane]);
    held |= (uint)OwnsVertex(mesh, packet->X + 2 * lane, packet->Y, packet->Z, vertex, p) << lane;
  }
  if (p->Pass == DEFORMVOLUME_PASS_OWNERS)
  {
    TouchHeld(cells & ~held, x, y, z, output, p);
  }
  return held;
}
