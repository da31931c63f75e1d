// SPDX-License-Identifier: BSD-3-Clause
// Resamples the cells of the sampling mesh that the boundary of the deformation mesh crosses. It uses pieces:
// tetrahedra of the deformation mesh, or parts of them (MeshBoundary). It runs after all other cells were resampled.
//
// An uncovered output voxel is written if two conditions hold. A deformed piece holds the voxel. Its rest coordinate
// lies in a cell at the boundary (DEFORMVOLUME_CELL_AT_BOUNDARY), in one of the cell's five tetrahedra that is active,
// has no blanked vertex and has no negative boundary distance there. If several pieces meet these conditions, an
// upright piece wins before an inverted one, then the lowest cell, then the lowest tetrahedron of the cell, then the
// lowest piece. The values are those of that tetrahedron at the rest coordinate, so they continue the values of
// neighboring cells.
//
// A work-group handles one tile of the output. If work-items are lanes, each takes one row of the tile at a time;
// otherwise one work-item takes all rows (ROWS_AT_ONCE).
//
// The host defines before this text, in addition to the macros of SampleStoring.cl and VoxelWinners.cl:
//   ROWS_AT_ONCE  number of rows of a tile that a work-item takes at once
//
// Data: positions and displacements of the corners of pieces, from BoundaryCorners.cl.

// The number of fractional bits of rest coordinates, which are structured indices.
#define REST_BITS 24

typedef struct
{
  __global const uchar* Cells;     // of the sampling mesh, with DEFORMVOLUME_CELL_AT_BOUNDARY
  __global const uchar* Active;    // one byte per cell; bit i: tetrahedron i is active
  __global const uchar* Blanked;   // one byte per voxel
  __global const float* Distances; // boundary distances of a carved volume, one float per voxel
} BoundaryMasks;

// The linear map from edge functions to the displacement of a piece in a tile, in output voxels.
typedef struct
{
  REAL Last[3];         // displacement of the last corner
  REAL Gradients[3][3]; // by edge function, by axis
} PieceMap;

// A tetrahedron of a cell, and the weights of a point in it.
typedef struct
{
  int Cell[3]; // local index
  int Tetrahedron;
  long Weights[4];
} RestLocation;

// Returns the key of a piece for a voxel; the piece with the least key wins. Upright pieces come before inverted ones,
// then the order is by cell (x varies fastest, 20 bits for each index), then by tetrahedron.
static ulong KeyOf(const RestLocation* location, int isInverted)
{
  return (ulong)isInverted << 63 | (ulong)location->Cell[2] << 43 | (ulong)location->Cell[1] << 23 |
    (ulong)location->Cell[0] << 3 | (ulong)location->Tetrahedron;
}

// Returns a rest coordinate relative to a cell, from 0 to `1 << REST_BITS` on each axis, mirrored according to the
// parity of the cell.
static Vector InCell(const long* rest, const int* cell, const KernelParameters* p)
{
  long point[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const int index = cell[axis] + p->First[axis];
    point[axis] = rest[axis] - ((long)index << REST_BITS);
    point[axis] = index & 1 ? (1L << REST_BITS) - point[axis] : point[axis];
  }
  const Vector r = { point[0], point[1], point[2] };
  return r;
}

// Whether a tetrahedron has no blanked vertex, and a point in it has no negative boundary distance.
static int IsUnmasked(
  const RestLocation* location, const BoundaryMasks* masks, const RasterParameters* r, const KernelParameters* p)
{
  const int mirror = Mirror(location->Cell[0], location->Cell[1], location->Cell[2], p);
  REAL distance = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int o = Tetrahedra[location->Tetrahedron][k] ^ mirror;
    const size_t voxel =
      VertexInChunk(
        location->Cell[0] + OFFSET_X(o), location->Cell[1] + OFFSET_Y(o), location->Cell[2] + OFFSET_Z(o), p);
    if (r->HasBlanked && masks->Blanked[voxel])
    {
      return 0;
    }
    distance = r->HasDistances && location->Weights[k]
      ? MULTIPLY_ADD_REAL((REAL)location->Weights[k], (REAL)masks->Distances[voxel], distance)
      : distance;
  }
  return !(distance < 0);
}

// Finds the lowest cell at the boundary that contains a rest coordinate, surface included, and its lowest unmasked
// tetrahedron that contains it. Returns 0 if there is none. last: index of the last voxel of the volume.
static int FindLocation(const long* rest, const int* last, RestLocation* location, const BoundaryMasks* masks,
  const RasterParameters* r, const KernelParameters* p)
{
  int cell[3];
  int below = 0; // bits of the axes on which the coordinate is on the lower side of the cell
  for (int axis = 0; axis < 3; ++axis)
  {
    const int index = min((int)(rest[axis] >> REST_BITS), last[axis] - 1);
    cell[axis] = index - p->First[axis];
    below |= (rest[axis] == (long)index << REST_BITS) << axis;
  }
  for (int neighbor = below;; neighbor = (neighbor - 1) & below)
  {
    int isCell = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      location->Cell[axis] = cell[axis] - (neighbor >> axis & 1);
      isCell &= location->Cell[axis] >= 0 && location->Cell[axis] < p->Size[axis] - 1;
    }
    isCell &= location->Cell[2] >= p->LayersBegin && location->Cell[2] < p->LayersEnd;
    const size_t number = isCell ? CellInChunk(location->Cell[0], location->Cell[1], location->Cell[2], p) : 0;
    if (isCell && (masks->Cells[number] & DEFORMVOLUME_CELL_AT_BOUNDARY))
    {
      const int active = r->HasActive ? masks->Active[number] : DEFORMVOLUME_ALL_TETRAHEDRA;
      const Vector point = InCell(rest, location->Cell, p);
      for (int t = 0; t < 5; ++t)
      {
        location->Tetrahedron = t;
        if ((active >> t & 1) && IsInTetrahedron(t, point, 1L << REST_BITS, location->Weights) &&
          (!(r->HasBlanked || r->HasDistances) || IsUnmasked(location, masks, r, p)))
        {
          return 1;
        }
      }
    }
    if (neighbor == 0)
    {
      return 0;
    }
  }
}

// Returns the edge functions of a piece at a voxel.
static long4 FindEdges(const TileTetrahedron* t, int x, int y, int z)
{
  const long dx = x - t->Box.Low.x;
  const long dy = y - t->Box.Low.y;
  const long dz = z - t->Box.Low.z;
  long edges[4];
  for (int k = 0; k < 4; ++k)
  {
    edges[k] = t->Start[k] + dx * t->Steps[k].x + dy * t->Steps[k].y + dz * t->Steps[k].z;
  }
  return (long4)(edges[0], edges[1], edges[2], edges[3]);
}

// Returns the voxels of a row of the tile that lie in a piece, as bits. first: x of the first voxel of the tile.
static uint FindInside(const TileTetrahedron* t, int first, int y, int z)
{
  const long4 step = (long4)(t->Steps[0].x, t->Steps[1].x, t->Steps[2].x, t->Steps[3].x);
  long4 edges = FindEdges(t, t->Box.Low.x, y, z);
  uint inside = 0;
  for (int x = t->Box.Low.x; x <= t->Box.High.x; ++x)
  {
    inside |= (any(edges < 0) ? 0u : 1u) << (x - first);
    edges += step;
  }
  return inside;
}

// Finds the rest coordinate of a voxel that a piece holds. Returns 0 if it lies outside the volume by more than
// rounding errors.
static int FindRest(const PieceMap* map, const TileTetrahedron* t, const int* voxel, const int* first,
  const int* last, long* rest, const RasterParameters* r)
{
  const long4 all = FindEdges(t, voxel[0], voxel[1], voxel[2]);
  const long edges[3] = { all.x, all.y, all.z };
  int isInside = 1;
  REAL moved[3]; // the position of the voxel minus its displacement
  for (int axis = 0; axis < 3; ++axis)
  {
    REAL d = map->Last[axis];
    for (int k = 0; k < 3; ++k)
    {
      d = MULTIPLY_ADD_REAL((REAL)edges[k], map->Gradients[k][axis], d);
    }
    moved[axis] = (REAL)voxel[axis] - d;
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const REAL scale = INVERSE_ELEMENT(r, axis, axis);
    REAL at = MULTIPLY_ADD_REAL(moved[axis], scale, -OFFSET_ELEMENT(r, axis));
    REAL absoluteSum = fabs(scale);
    for (int k = 0; r->HasTurnedAxes && k < 3; ++k)
    {
      const REAL element = k == axis ? 0 : INVERSE_ELEMENT(r, axis, k);
      at = MULTIPLY_ADD_REAL(moved[k], element, at);
      absoluteSum += fabs(element);
    }
    // Corners are rounded to 1/256 output voxel.
    const REAL tolerance = min((REAL)1, absoluteSum / 256);
    isInside &= at >= (REAL)first[axis] - tolerance && at <= (REAL)last[axis] + tolerance;
    rest[axis] = convert_long_rte(clamp(at, (REAL)first[axis], (REAL)last[axis]) * (REAL)(1 << REST_BITS));
  }
  return isInside;
}

static void SetMap(
  const TileTetrahedron* t, __global const float4* displacements, int4 corners, PieceMap* map)
{
  const float4 d = displacements[corners.w];
  const float last[3] = { d.x, d.y, d.z };
  const int others[3] = { corners.x, corners.y, corners.z };
  for (int k = 0; k < 3; ++k)
  {
    const float4 o = displacements[others[k]];
    const float other[3] = { o.x, o.y, o.z };
    for (int axis = 0; axis < 3; ++axis)
    {
      map->Gradients[k][axis] = ((REAL)other[axis] - (REAL)last[axis]) * t->InverseVolume;
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    map->Last[axis] = (REAL)last[axis];
  }
}

static size_t TargetOf(const int* voxel, const RasterParameters* r)
{
  return ((size_t)(voxel[2] - r->OutputFirst[2]) * r->OutputSize[1] + voxel[1] - r->OutputFirst[1]) *
    r->OutputSize[0] +
    voxel[0] - r->OutputFirst[0];
}

static int IsCovered(__global const char* coverage, size_t target)
{
#if COVERAGE_IS_BITS
  // Other work-items may set other bits of the word at the same time.
  return atomic_or((volatile __global uint*)coverage + (target >> 5), 0u) >> (target & 31) & 1;
#else
  return coverage[target];
#endif
}

static uint BitsBetween(int first, int last)
{
  return last < first ? 0u : (0xffffffffu >> (31 - (last - first))) << first;
}

static void MarkCovered(const int* voxel, __global char* coverage, __global uint* counts, const RasterParameters* r,
  const KernelParameters* p)
{
  const size_t target = TargetOf(voxel, r);
#if COVERAGE_IS_BITS
  atomic_or((volatile __global uint*)coverage + (target >> 5), 1u << (target & 31));
#else
  coverage[target] = 1;
#endif
  const size_t patch = PatchRow(voxel[1] - r->OutputFirst[1], voxel[2] - r->OutputFirst[2], p) +
    (voxel[0] - r->OutputFirst[0]) / DEFORMVOLUME_PATCH;
  atomic_inc(counts + patch);
}

// Writes the values at a location in the volume to a voxel.
static void StoreSample(const RestLocation* location, const int* voxel, const RasterParameters* r,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const long sum = location->Weights[0] + location->Weights[1] + location->Weights[2] + location->Weights[3];
  Sample s;
  BeginSamples(&s, location->Cell[0], location->Cell[1], location->Cell[2], location->Tetrahedron, sum, p);
  SetSample(&s, location->Weights, TargetOf(voxel, r));
  StoreArrays(&s ARRAY_ARGUMENTS);
}

// orientation: 1 for upright pieces, 2 for inverted ones, 3 for both. first, last: structured indices of the first
// and the last voxel of the whole volume. counts: the number of voxels written in each patch.
__kernel void ResampleBoundary(__global const int4* tetrahedra, __global const int4* positions,
  __global const float4* displacements, __global const uint* listBegins, __global const int* lists,
  __global const uint* tiles, __global const uchar* cells, __global const uchar* active,
  __global const uchar* blanked, __global const float* distances, __global char* coverage, __global uint* counts,
  const int4 firstVoxel, const int4 lastVoxel, const int orientation, const RasterParameters r,
  const KernelParameters p ARRAY_PARAMETERS)
{
  const uint tile = tiles[get_group_id(0)];
  const uint listBegin = listBegins[tile];
  const uint listEnd = listBegins[tile + 1];
  if (listBegin == listEnd)
  {
    return;
  }
  const BoundaryMasks masks = { cells, active, blanked, distances };
  const int first[3] = { firstVoxel.x, firstVoxel.y, firstVoxel.z };
  const int last[3] = { lastVoxel.x, lastVoxel.y, lastVoxel.z };
  int origin[3];
  const VoxelBox box = GetTile(tile, origin, &r);
  for (int begin = get_local_id(0) * ROWS_AT_ONCE; begin < DEFORMVOLUME_TILE_ROWS;
       begin += get_local_size(0) * ROWS_AT_ONCE)
  {
    uint open[ROWS_AT_ONCE]; // voxels that are not covered by cells
    uint taken[ROWS_AT_ONCE];
    ulong keys[ROWS_AT_ONCE][32];
    uint anyOpen = 0;
    for (int i = 0; i < ROWS_AT_ONCE; ++i)
    {
      int voxel[3];
      FindFirstOfRow(begin + i, origin, voxel);
      open[i] = taken[i] = 0;
      if (voxel[1] >= box.Low.y && voxel[1] <= box.High.y && voxel[2] >= box.Low.z && voxel[2] <= box.High.z)
      {
        voxel[0] = box.Low.x;
        const size_t target = TargetOf(voxel, &r);
        const int count = box.High.x - box.Low.x + 1;
        for (int x = 0; x < count; ++x)
        {
          open[i] |= (IsCovered(coverage, target + x) ? 0u : 1u) << x;
        }
        open[i] <<= box.Low.x - origin[0];
      }
      anyOpen |= open[i];
    }
    for (uint i = anyOpen ? listBegin : listEnd; i < listEnd; ++i)
    {
      const int4 corners = tetrahedra[lists[i]];
      const int4 a = positions[corners.x];
      const int4 b = positions[corners.y];
      const int4 c = positions[corners.z];
      const int4 d = positions[corners.w];
      VoxelBox near = FindVoxels(min(min(a, b), min(c, d)), max(max(a, b), max(c, d)), &r);
      near.Low = max(near.Low, box.Low);
      near.High = min(near.High, box.High);
      const uint voxelsOfRow = BitsBetween(near.Low.x - origin[0], near.High.x - origin[0]);
      uint wanted = 0;
      for (int z = near.Low.z; z <= near.High.z; ++z)
      {
        for (int y = near.Low.y; y <= near.High.y; ++y)
        {
          const int row = ((z - origin[2]) << DEFORMVOLUME_TILE_BITS_Y) + y - origin[1] - begin;
          wanted |= row >= 0 && row < ROWS_AT_ONCE ? open[row] & voxelsOfRow : 0;
        }
      }
      TileTetrahedron t;
      if (!wanted || !SetUpTetrahedron(corners, positions, box, &t, &r))
      {
        continue;
      }
      const int isInverted = Dot(Difference(b, a), Cross(Difference(c, a), Difference(d, a))) < 0;
      if (!(orientation >> isInverted & 1))
      {
        continue;
      }
      PieceMap map;
      SetMap(&t, displacements, corners, &map);
      for (int z = t.Box.Low.z; z <= t.Box.High.z; ++z)
      {
        for (int y = t.Box.Low.y; y <= t.Box.High.y; ++y)
        {
          const int row = ((z - origin[2]) << DEFORMVOLUME_TILE_BITS_Y) + y - origin[1] - begin;
          const uint here = row >= 0 && row < ROWS_AT_ONCE ? open[row] & voxelsOfRow : 0;
          for (uint left = here ? here & FindInside(&t, origin[0], y, z) : 0; left; left &= left - 1)
          {
            const int x = popcount((left & -left) - 1);
            const int voxel[3] = { origin[0] + x, y, z };
            long rest[3];
            RestLocation location;
            if (!FindRest(&map, &t, voxel, first, last, rest, &r) ||
              !FindLocation(rest, last, &location, &masks, &r, &p))
            {
              continue;
            }
            const ulong key = KeyOf(&location, isInverted);
            const int isTaken = taken[row] >> x & 1;
            if (isTaken && keys[row][x] <= key)
            {
              continue;
            }
            keys[row][x] = key;
            taken[row] |= 1u << x;
            // A piece that wins later overwrites the values. Few voxels have several pieces.
            StoreSample(&location, voxel, &r, &p ARRAY_ARGUMENTS);
            if (!isTaken)
            {
              MarkCovered(voxel, coverage, counts, &r, &p);
            }
          }
        }
      }
    }
  }
}
