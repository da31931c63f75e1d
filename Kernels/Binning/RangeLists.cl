// SPDX-License-Identifier: BSD-3-Clause
// Lists of the tetrahedra in each tile, for CPUs. A work-item processes a range of tetrahedra and has two counters for
// each tile, one for upright and one for inverted tetrahedra. Between the two kernels, the host replaces the counters
// by their prefix sums over the ranges. The sums are the indices at which the second kernel writes, so that the
// tetrahedra of each list are in order.
//
// This text comes after TetrahedronBinning.cl.

#define FOR_EACH_TILE(tile, tiles, p)                                                              \
  for (uint tz = 0; tz < GetSizeZ(tiles.y); ++tz)                                                  \
    for (uint ty = 0; ty < GetSizeY(tiles.y); ++ty)                                                \
      for (uint tile = tiles.x + (tz * p.TileCount[1] + ty) * p.TileCount[0],                      \
                end = tile + GetSizeX(tiles.y);                                                    \
           tile < end; ++tile)

static int RangeBegin(size_t range, const RasterParameters* p)
{
  return (int)(p->Tetrahedra * range / get_global_size(0));
}

// Counts the tetrahedra of each tile. boxes: the tiles of each tetrahedron. counters: see RasterParameters.h.
// rangeBegins: the number of upright tetrahedra for each range and each tile, then the number of inverted tetrahedra.
__kernel void CountTetrahedra(__global const int4* tetrahedra, __global const int4* positions,
  __global uint2* boxes, __global uint* counters, __global uint* rangeBegins, const RasterParameters p)
{
  const size_t range = get_global_id(0);
  const size_t tiles = (size_t)p.TileCount[0] * p.TileCount[1] * p.TileCount[2];
  __global uint* upright = rangeBegins + tiles * range;
  __global uint* inverted = upright + tiles * get_global_size(0);
  for (size_t tile = 0; tile < tiles; ++tile)
  {
    upright[tile] = inverted[tile] = 0;
  }
  uint numberOfInverted = 0;
  uint overstretched = 0;
  const int end = RangeBegin(range + 1, &p);
  for (int t = RangeBegin(range, &p); t < end; ++t)
  {
    const Binned found = Bin(tetrahedra[t], positions, &p);
    boxes[t] = found.Tiles;
    numberOfInverted += found.Inverted;
    overstretched += found.Overstretched;
    __global uint* counts = found.Inverted ? inverted : upright;
    FOR_EACH_TILE(tile, found.Tiles, p)
    {
      ++counts[tile];
    }
  }
  atomic_add(counters + DEFORMVOLUME_BINNED_INVERTED, numberOfInverted);
  atomic_add(counters + DEFORMVOLUME_BINNED_OVERSTRETCHED, overstretched);
}

// Writes the lists. rangeBegins: as in CountTetrahedra, but with the index in the lists of the next tetrahedron.
__kernel void ListTetrahedra(__global const uint2* boxes, __global uint* rangeBegins,
  __global int* lists, const RasterParameters p)
{
  const size_t range = get_global_id(0);
  const size_t tiles = (size_t)p.TileCount[0] * p.TileCount[1] * p.TileCount[2];
  __global uint* upright = rangeBegins + tiles * range;
  __global uint* inverted = upright + tiles * get_global_size(0);
  const int end = RangeBegin(range + 1, &p);
  for (int t = RangeBegin(range, &p); t < end; ++t)
  {
    const uint2 found = boxes[t];
    __global uint* next = IsInverted(found.y) ? inverted : upright;
    FOR_EACH_TILE(tile, found, p)
    {
      lists[next[tile]++] = t;
    }
  }
}
