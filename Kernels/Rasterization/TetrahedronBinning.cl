// SPDX-License-Identifier: BSD-3-Clause
// Binning for the mesh rasterisation: lists the tetrahedra of the deformation mesh that may hold
// voxels of each output tile, in the order in which they win: upright ones first, then inverted
// ones, each in ascending order.
//
// Data: a tetrahedron is four nodes (16 bytes), ordered so that it is positively oriented at rest,
// or -1 where it has no volume at rest; a node is its deformed position in 1/256 output voxel (16
// bytes, the last four unused).
//
// A work-item takes a range of tetrahedra and keeps a counter for each tile, once for upright and
// once for inverted ones. Their sums over the ranges are the places to write to, so that the lists
// come out in order without atomic operations. The host does the sums in between.

static Vector Difference(int4 a, int4 b)
{
  const Vector r = { (long)a.x - b.x, (long)a.y - b.y, (long)a.z - b.z };
  return r;
}

// The voxels of the output in the box of a tetrahedron, both ends included.
typedef struct
{
  int4 Low, High;
} VoxelBox;

static VoxelBox FindVoxels(int4 low, int4 high, const RasterParameters* p)
{
  const int4 first = { p->OutputFirst[0], p->OutputFirst[1], p->OutputFirst[2], 0 };
  const int4 size = { p->OutputSize[0], p->OutputSize[1], p->OutputSize[2], 1 };
  VoxelBox box;
  box.Low = max((low + 255) >> 8, first);
  box.High = min(high >> 8, first + size - 1);
  return box;
}

static int IsEmpty(VoxelBox box)
{
  return box.Low.x > box.High.x || box.Low.y > box.High.y || box.Low.z > box.High.z;
}

// The voxels of the output in a tile, and the tile's first voxel, which may lie before the output.
static VoxelBox GetTile(int index, int* origin, const RasterParameters* p)
{
  origin[0] = (p->TileFirst[0] + index % p->TileCount[0]) * (1 << DEFORMVOLUME_TILE_BITS_X);
  origin[1] = (p->TileFirst[1] + index / p->TileCount[0] % p->TileCount[1]) *
    (1 << DEFORMVOLUME_TILE_BITS_Y);
  origin[2] = (p->TileFirst[2] + index / p->TileCount[0] / p->TileCount[1]) *
    (1 << DEFORMVOLUME_TILE_BITS_Z);
  const int4 corner = { origin[0], origin[1], origin[2], 0 };
  const int4 outputFirst = { p->OutputFirst[0], p->OutputFirst[1], p->OutputFirst[2], 0 };
  const int4 outputSize = { p->OutputSize[0], p->OutputSize[1], p->OutputSize[2], 1 };
  const int4 tileSize = { 1 << DEFORMVOLUME_TILE_BITS_X, 1 << DEFORMVOLUME_TILE_BITS_Y,
    1 << DEFORMVOLUME_TILE_BITS_Z, 1 };
  VoxelBox tile;
  tile.Low = max(corner, outputFirst);
  tile.High = min(corner + tileSize, outputFirst + outputSize) - 1;
  return tile;
}

// A tetrahedron as far as binning goes.
typedef struct
{
  VoxelBox Tiles; // counted from the first tile; empty where nothing is to be rasterised
  int Inverted;
  int Overstretched;
} Binned;

static Binned Bin(int4 nodes, __global const int4* positions, const RasterParameters* p)
{
  Binned r;
  r.Inverted = r.Overstretched = 0;
  r.Tiles.Low = (int4)(0);
  r.Tiles.High = (int4)(-1);
  if (nodes.x < 0)
  {
    return r;
  }
  const int4 a = positions[nodes.x];
  const int4 b = positions[nodes.y];
  const int4 c = positions[nodes.z];
  const int4 d = positions[nodes.w];
  const int4 low = min(min(a, b), min(c, d));
  const int4 high = max(max(a, b), max(c, d));
  const VoxelBox voxels = FindVoxels(low, high, p);
  const int4 extent = high - low;
  if (max(extent.x, max(extent.y, extent.z)) > DEFORMVOLUME_LARGEST_TETRAHEDRON * 256)
  {
    r.Overstretched = !IsEmpty(voxels);
    return r;
  }
  const long volume = Dot(Difference(b, a), Cross(Difference(c, a), Difference(d, a)));
  r.Inverted = volume < 0;
  if (volume != 0 && !IsEmpty(voxels))
  {
    const int4 bits = { DEFORMVOLUME_TILE_BITS_X, DEFORMVOLUME_TILE_BITS_Y,
      DEFORMVOLUME_TILE_BITS_Z, 0 };
    const int4 first = { p->TileFirst[0], p->TileFirst[1], p->TileFirst[2], 0 };
    r.Tiles.Low = (voxels.Low >> bits) - first;
    r.Tiles.High = (voxels.High >> bits) - first;
  }
  return r;
}

#define FOR_EACH_TILE(tile, tiles, p)                                                              \
  for (int tz = tiles.Low.z; tz <= tiles.High.z; ++tz)                                             \
    for (int ty = tiles.Low.y; ty <= tiles.High.y; ++ty)                                           \
      for (size_t tile = ((size_t)tz * p.TileCount[1] + ty) * p.TileCount[0] + tiles.Low.x,        \
                  end = tile + tiles.High.x - tiles.Low.x;                                         \
           tile <= end; ++tile)

static int RangeBegin(int range, const RasterParameters* p)
{
  return (int)((long)p->Tetrahedra * range / p->Ranges);
}

// places: for upright and then for inverted tetrahedra, for each range, for each tile a number.
__kernel void CountTetrahedra(__global const int4* tetrahedra, __global const int4* positions,
  __global uint* places, __global uint* counters, const RasterParameters p)
{
  const int range = get_global_id(0);
  const size_t tiles = (size_t)p.TileCount[0] * p.TileCount[1] * p.TileCount[2];
  __global uint* upright = places + tiles * range;
  __global uint* inverted = upright + tiles * p.Ranges;
  for (size_t tile = 0; tile < tiles; ++tile)
  {
    upright[tile] = inverted[tile] = 0;
  }
  uint numberOfInverted = 0;
  uint overstretched = 0;
  for (int t = RangeBegin(range, &p); t < RangeBegin(range + 1, &p); ++t)
  {
    const Binned found = Bin(tetrahedra[t], positions, &p);
    numberOfInverted += found.Inverted;
    overstretched += found.Overstretched;
    __global uint* counts = found.Inverted ? inverted : upright;
    FOR_EACH_TILE(tile, found.Tiles, p)
    {
      ++counts[tile];
    }
  }
  counters[range * DEFORMVOLUME_BINNED_COUNTERS + DEFORMVOLUME_BINNED_INVERTED] = numberOfInverted;
  counters[range * DEFORMVOLUME_BINNED_COUNTERS + DEFORMVOLUME_BINNED_OVERSTRETCHED] =
    overstretched;
}

// places: as above, the number being the place in the lists of the next tetrahedron.
__kernel void ListTetrahedra(__global const int4* tetrahedra, __global const int4* positions,
  __global uint* places, __global int* lists, const RasterParameters p)
{
  const int range = get_global_id(0);
  const size_t tiles = (size_t)p.TileCount[0] * p.TileCount[1] * p.TileCount[2];
  __global uint* upright = places + tiles * range;
  __global uint* inverted = upright + tiles * p.Ranges;
  for (int t = RangeBegin(range, &p); t < RangeBegin(range + 1, &p); ++t)
  {
    const Binned found = Bin(tetrahedra[t], positions, &p);
    __global uint* next = found.Inverted ? inverted : upright;
    FOR_EACH_TILE(tile, found.Tiles, p)
    {
      lists[next[tile]++] = t;
    }
  }
}
