// SPDX-License-Identifier: BSD-3-Clause
// Rasterizes the tetrahedra of the deformation mesh into the output, and finds the rest coordinate of each voxel.
// RestSampling.cl samples the volume there.
//
// Data: tetrahedra, positions of nodes and lists of tetrahedra as in TetrahedronBinning.cl; displacements of nodes, 16
// bytes each, in output voxels (the last four bytes unused). Local memory has the rest coordinate of each voxel of a
// tile as three integers: the index relative to the volume's first voxel times 2^FractionBits, in the layout of
// LaneSampling.cl. It also has two bits per voxel: whether it is covered, and whether a tetrahedron holds it after the
// symbolic shift (`own`).
//
// A work-group handles one output tile. Its work-items take the rows of the tile in turn, and each visits the
// tetrahedra of the tile in their order. Work-items share no data until all rows are done, and a voxel has a single
// writer. So the result does not depend on the size of the group. The voxels of a row that a tetrahedron holds form one
// interval, bounded by four edge functions: integers in (1/256 voxel)^3 that are 0 on a face and positive inside. A
// float estimate of the ends is corrected by the exact function. So a voxel on a shared face is in both tetrahedra, and
// the first one takes it.
//
// RestCoordinates.cl finds the rest coordinates of all wanted voxels of a row.
//
// This text comes after TetrahedronBinning.cl, RestSampling.cl and RestCoordinates.cl, and needs no macros beyond
// theirs.

// The bits from first to last (inclusive); 0 if last < first.
static uint Bits(int first, int last)
{
  return last < first ? 0u : (0xffffffffu >> (31 - (last - first))) << first;
}

// Returns the voxels of a row that a tetrahedron holds, relative to the lowest voxel of its box. edges: the edge
// functions at the lowest voxel. count: number of voxels minus 1. own: output: the voxels that it holds after the
// symbolic shift, which decides for voxels on shared faces.
static uint FindRow(OF_GROUP const TileTetrahedron* t, const long* edges, int count, uint* own)
{
  int low = 0;
  int high = count;
  int ownHigh = count;
  *own = 0;
  // Quick test: most rows outside the tetrahedron lie entirely behind one face.
  long behind = 0;
  for (int k = 0; k < 4; ++k)
  {
    behind |= edges[k] + max(0L, t->Steps[k].x) * count;
  }
  if (behind < 0)
  {
    return 0;
  }
  for (int k = 0; k < 4; ++k)
  {
    const long e = edges[k];
    const long step = t->Steps[k].x;
    if (step > 0)
    {
      if (e < 0)
      {
        const float root = (float)(-e) * t->Inverse[k];
        int x = root < (float)count ? (int)root : count;
        while (x <= count && e + x * step < 0)
        {
          ++x;
        }
        while (x > 0 && e + (x - 1) * step >= 0)
        {
          --x;
        }
        low = max(low, x);
      }
    }
    else if (step < 0)
    {
      const float root = (float)e * t->Inverse[k];
      int x = root < (float)count ? (int)root : count;
      while (e + x * step < 0)
      {
        --x;
      }
      while (x < count && e + (x + 1) * step >= 0)
      {
        ++x;
      }
      high = min(high, x);
      ownHigh = min(ownHigh, e + x * step == 0 ? x - 1 : x);
    }
    else if (e == 0 && !t->AcceptsTie[k])
    {
      ownHigh = -1;
    }
  }
  *own = Bits(low, ownHigh);
  return Bits(low, high);
}

// Returns the voxels of a row that a tetrahedron holds and that no earlier tetrahedron has taken. first: voxel of the
// row at the lowest voxel of the tetrahedron's box, where the edge functions are `edges`.
static uint FindWanted(OF_GROUP const TileTetrahedron* t, const long* edges, int first, __local const uint* covered,
  __local uint* own, int* overlaps)
{
  uint ownHere;
  const uint held = FindRow(t, edges, t->Box.High.x - t->Box.Low.x, &ownHere) << first;
  ownHere <<= first;
  *overlaps |= (*own & ownHere) != 0;
  *own |= ownHere;
  return held & ~*covered;
}

// Finds the rest coordinates of wanted voxels. Returns the voxels that the volume covers. voxel: the first voxel of the
// row.
static uint CoverRow(OF_GROUP const TileTetrahedron* t, OF_GROUP const RestMap* map, long* edges, const int* voxel,
  const int* origin, uint wanted, VolumeMasks masks, __local int* rowRests, const RasterParameters* p)
{
  uint found;
  if (map->Fits)
  {
    found = FindRests(map, voxel[1] - origin[1], voxel[2] - origin[2], wanted, rowRests, p);
  }
  else
  {
    for (int k = 0; k < 4; ++k)
    {
      edges[k] -= (t->Box.Low.x - voxel[0]) * t->Steps[k].x;
    }
    found = FindRestsOneByOne(t, map, edges, voxel, wanted, rowRests, p);
  }
  return SelectSources(masks, found, rowRests, p);
}

// Visits all tetrahedra of a tile, for all rows of this work-item. Returns whether tetrahedra overlap. If work-items
// are lanes, each work-item first sets up some tetrahedra for the whole group, and then visits all of these for its
// rows: setting up a tetrahedron takes longer than handling one of its rows.
#if SETUP_IS_SHARED
typedef struct
{
  TileTetrahedron Tetrahedron;
  RestMap Map;
  ulong Rows; // a bit for each row of the tile in the box of the tetrahedron
} SharedTetrahedron;

static ulong FindRows(VoxelBox box, const int* origin)
{
  const ulong ofPlane = Bits(box.Low.y - origin[1], box.High.y - origin[1]);
  ulong rows = 0;
  for (int z = box.Low.z; z <= box.High.z; ++z)
  {
    rows |= ofPlane << ((z - origin[2]) << DEFORMVOLUME_TILE_BITS_Y);
  }
  return rows;
}

static __attribute__((always_inline)) int RasterizeRows(__global const int4* tetrahedra,
  __global const int4* positions, __global const float4* displacements, __global const int* list, uint listed,
  VolumeMasks masks, VoxelBox tile, const int* origin, __local SharedTetrahedron* shared, __local int* rests,
  __local uint* covered, __local uint* own, const RasterParameters* p)
{
  const int items = get_local_size(0);
  const int item = get_local_id(0);
  int overlaps = 0;
  for (uint begin = 0; begin < listed; begin += DEFORMVOLUME_TILE_SHARED)
  {
    const int count = min(listed - begin, (uint)DEFORMVOLUME_TILE_SHARED);
    for (int i = item; i < count; i += items)
    {
      const int4 nodes = tetrahedra[list[begin + i]];
      __local SharedTetrahedron* one = shared + i;
      one->Rows = 0;
      if (SetUpTetrahedron(nodes, positions, tile, &one->Tetrahedron, p))
      {
        SetRestMap(&one->Tetrahedron, nodes, displacements, origin, &one->Map, p);
        one->Rows = FindRows(one->Tetrahedron.Box, origin);
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int row = item; row < DEFORMVOLUME_TILE_ROWS; row += items)
    {
      int voxel[3];
      FindFirstOfRow(row, origin, voxel);
      // Collect the tetrahedra of this row first, so that neighboring work-items handle their tetrahedra at the same
      // time.
      uint left = 0;
      for (int i = 0; i < count; ++i)
      {
        left |= (uint)(shared[i].Rows >> row & 1) << i;
      }
      for (; left; left &= left - 1)
      {
        const int i = popcount((left & -left) - 1);
        __local const TileTetrahedron* t = &shared[i].Tetrahedron;
        const int y = voxel[1] - t->Box.Low.y;
        const int z = voxel[2] - t->Box.Low.z;
        long edges[4];
        for (int k = 0; k < 4; ++k)
        {
          edges[k] = t->Start[k] + y * t->Steps[k].y + z * t->Steps[k].z;
        }
        const uint wanted =
          FindWanted(t, edges, t->Box.Low.x - origin[0], covered + row, own + row, &overlaps);
        if (wanted)
        {
          covered[row] |= CoverRow(
            t, &shared[i].Map, edges, voxel, origin, wanted, masks, rests + row * REST_ROW_STEP, p);
        }
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  return overlaps;
}
#else
static int RasterizeRows(__global const int4* tetrahedra, __global const int4* positions,
  __global const float4* displacements, __global const int* list, uint listed, VolumeMasks masks,
  VoxelBox tile, const int* origin, __local int* rests, __local uint* covered, __local uint* own,
  const RasterParameters* p)
{
  const int items = get_local_size(0);
  const int item = get_local_id(0);
  int overlaps = 0;
  for (uint i = 0; i < listed; ++i)
  {
    const int4 nodes = tetrahedra[list[i]];
    TileTetrahedron t;
    if (!SetUpTetrahedron(nodes, positions, tile, &t, p))
    {
      continue;
    }
    RestMap map;
    int mapped = 0;
    long slice[4] = { t.Start[0], t.Start[1], t.Start[2], t.Start[3] };
    for (int z = t.Box.Low.z; z <= t.Box.High.z; ++z)
    {
      long next[4];
      for (int k = 0; k < 4; ++k)
      {
        next[k] = slice[k];
        slice[k] += t.Steps[k].z;
      }
      for (int y = t.Box.Low.y; y <= t.Box.High.y; ++y)
      {
        long edges[4];
        for (int k = 0; k < 4; ++k)
        {
          edges[k] = next[k];
          next[k] += t.Steps[k].y;
        }
        const int row = ((z - origin[2]) << DEFORMVOLUME_TILE_BITS_Y) + y - origin[1];
        if (items > 1 && row % items != item)
        {
          continue;
        }
        const uint wanted =
          FindWanted(&t, edges, t.Box.Low.x - origin[0], covered + row, own + row, &overlaps);
        if (!wanted)
        {
          continue;
        }
        if (!mapped)
        {
          SetRestMap(&t, nodes, displacements, origin, &map, p);
          mapped = 1;
        }
        const int voxel[3] = { origin[0], y, z };
        covered[row] |= CoverRow(
          &t, &map, edges, voxel, origin, wanted, masks, rests + row * REST_ROW_STEP, p);
      }
    }
  }
  return overlaps;
}
#endif

__kernel void RasterizeMesh(__global const int4* tetrahedra, __global const int4* positions,
  __global const float4* displacements, __global const uint* listBegins,
  __global const int* lists, __global const uchar* active, __global const uchar* blanked,
  __global const float* distances, __global const ulong* backgrounds, __global char* coverage,
  __global uint* counters,
  const RasterParameters p ARRAY_PARAMETERS)
{
  __local int rests[RESTS];
  __local uint covered[DEFORMVOLUME_TILE_ROWS];
  __local uint own[DEFORMVOLUME_TILE_ROWS];
  __local uint overlaps;
#if SETUP_IS_SHARED
  __local SharedTetrahedron shared[DEFORMVOLUME_TILE_SHARED];
#endif
  const int index = p.TileBegin + (int)get_group_id(0);
  int origin[3];
  const VoxelBox tile = GetTile(index, origin, &p);
  if (get_local_id(0) == 0)
  {
    overlaps = 0;
  }
  for (int row = get_local_id(0); row < DEFORMVOLUME_TILE_ROWS; row += get_local_size(0))
  {
    own[row] = covered[row] = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const VolumeMasks masks = { active, blanked, distances };
  if (RasterizeRows(tetrahedra, positions, displacements, lists + listBegins[index],
        listBegins[index + 1] - listBegins[index], masks, tile, origin,
#if SETUP_IS_SHARED
        shared,
#endif
        rests, covered, own, &p))
  {
    atomic_or(&overlaps, 1);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  SampleTile(tile, origin, rests, covered, backgrounds, coverage, &p ARRAY_ARGUMENTS);
  if (get_local_id(0) == 0)
  {
    CountTile(covered, overlaps, counters + index * DEFORMVOLUME_TILE_COUNTERS);
  }
}
