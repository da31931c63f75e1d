// SPDX-License-Identifier: BSD-3-Clause
// Binning for mesh rasterization: tiles of the output, and the tiles in which a tetrahedron of the deformation mesh
// may contain voxels. RangeLists.cl and EntryLists.cl list these tetrahedra for each tile, in the order in which they
// win overlaps: first upright tetrahedra, then inverted tetrahedra, each in ascending order.
//
// Data: a tetrahedron has four nodes (16 bytes), in an order of positive orientation at rest, or -1 if it has no
// volume at rest. A node is its deformed position in 1/256 output voxel (16 bytes, the last four unused).

// The output voxels in a box, both ends included.
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

// Returns the output voxels in a tile, and sets the tile's first voxel, which may lie before the output.
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

// Sets the first voxel of a row of a tile. origin: the first voxel of the tile.
static void FindFirstOfRow(int row, const int* origin, int* voxel)
{
  voxel[0] = origin[0];
  voxel[1] = origin[1] + (row & ((1 << DEFORMVOLUME_TILE_BITS_Y) - 1));
  voxel[2] = origin[2] + (row >> DEFORMVOLUME_TILE_BITS_Y);
}

// The tiles of a tetrahedron: the first tile; and, packed into one number, the count of tiles on x, y and z, with
// enough bits for the largest tetrahedron, and whether it is inverted.
#define TILES_BITS_X 8
#define TILES_BITS_Y 10
#define TILES_BITS_Z 10

static uint PackSizes(uint x, uint y, uint z, uint inverted)
{
  return x | y << TILES_BITS_X | z << (TILES_BITS_X + TILES_BITS_Y) | inverted << 31;
}

static uint GetSizeX(uint sizes)
{
  return sizes & ((1u << TILES_BITS_X) - 1);
}

static uint GetSizeY(uint sizes)
{
  return sizes >> TILES_BITS_X & ((1u << TILES_BITS_Y) - 1);
}

static uint GetSizeZ(uint sizes)
{
  return sizes >> (TILES_BITS_X + TILES_BITS_Y) & ((1u << TILES_BITS_Z) - 1);
}

static uint IsInverted(uint sizes)
{
  return sizes >> 31;
}

// The result of binning a tetrahedron.
typedef struct
{
  uint2 Tiles; // 0 tiles if there is nothing to rasterize
  uint Inverted;
  uint Overstretched;
} Binned;

static Binned Bin(int4 nodes, __global const int4* positions, const RasterParameters* p)
{
  Binned r;
  r.Inverted = r.Overstretched = 0;
  r.Tiles = (uint2)(0);
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
    const int4 tile = (voxels.Low >> bits) - first;
    const uint4 size = as_uint4((voxels.High >> bits) - first - tile + 1);
    r.Tiles.x = (uint)((tile.z * p->TileCount[1] + tile.y) * p->TileCount[0] + tile.x);
    r.Tiles.y = PackSizes(size.x, size.y, size.z, r.Inverted);
  }
  return r;
}
