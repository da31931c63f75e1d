// SPDX-License-Identifier: BSD-3-Clause
// The mask of the tetrahedra of the sampling mesh that are resampled by their vertices: tetrahedra that are active, are
// not bridges, and are not in a cell that the boundary of the deformation mesh crosses. This text comes after
// VertexState.cl.
//
// Where a node of the deformation mesh is split, the tetrahedra on the two sides have different nodes with the same
// position at rest. Two such tetrahedra are on different sides. A bridge is a tetrahedron of the sampling mesh that
// would be stretched over the gap between the sides. A tetrahedron is a bridge in two cases:
// - Two of its vertices are linked to tetrahedra on different sides.
// - The cell has vertices on different sides, and two vertices of the tetrahedron are in different connected
//   components. Two vertices of a cell are connected if their tetrahedra share a node and are not on different sides.
//
// A tetrahedron that a smooth cut crosses has a copy for each side of the cut. For such a tetrahedron, only pairs of
// vertices on the same side of the cut count.
//
// Data:
//   tetrahedra       int4: nodes, times DEFORMVOLUME_NODE_STRIDE
//   coincidentNodes  an int per node, equal for all nodes with the same position at rest
//   boundary         a byte per cell: tetrahedra that may be resampled by their
//                    vertices, DEFORMVOLUME_CELL_AT_BOUNDARY and DEFORMVOLUME_CELL_CROSSED

#if MAPPING == MAPPING_RUNS
#define TETRAHEDRON_OF(m, x, y, z, p) RunTetrahedronOf(m, owners, x, y, z, p)
static int RunTetrahedronOf(
  const Mapping* m, __global const int* owners, int x, int y, int z, const KernelParameters* p)
{
  const int record = RunOf(m, x, y, z, p).Tetrahedron;
  return record < 0 ? -1 : owners[record];
}
#elif MAPPING == MAPPING_LINKS
#define TETRAHEDRON_OF(m, x, y, z, p) (m)->Links[VertexInChunk(x, y, z, p)].Tetrahedron
#else
#define TETRAHEDRON_OF(m, x, y, z, p) -1
#endif

#define SHARES_NODE 1
#define IS_SPLIT 2

// Returns SHARES_NODE if two tetrahedra share a node, and IS_SPLIT if they have different nodes with the same position
// at rest.
static int CompareNodes(int4 first, int4 second, __global const int* coincidentNodes)
{
  const int a[4] = { first.x / DEFORMVOLUME_NODE_STRIDE, first.y / DEFORMVOLUME_NODE_STRIDE,
    first.z / DEFORMVOLUME_NODE_STRIDE, first.w / DEFORMVOLUME_NODE_STRIDE };
  const int b[4] = { second.x / DEFORMVOLUME_NODE_STRIDE, second.y / DEFORMVOLUME_NODE_STRIDE,
    second.z / DEFORMVOLUME_NODE_STRIDE, second.w / DEFORMVOLUME_NODE_STRIDE };
  int found = 0;
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      found |= a[i] == b[j] ? SHARES_NODE : coincidentNodes[a[i]] == coincidentNodes[b[j]] ? IS_SPLIT : 0;
    }
  }
  return found;
}

// Returns the crossed tetrahedra of a cell (x) and its vertices with negative distance (y), as bits.
static int2 FindCut(__global const uint* cutRows, __global const CutVertex* cutVertices, int x, int y, int z,
  int mirror, const KernelParameters* p)
{
  int2 cut = 0;
#if HAS_CUT
  const int first = FindCutVertex(cutRows, cutVertices, x, y, z, p);
  cut.x = first < 0 ? 0 : cutVertices[first].Tetrahedra & DEFORMVOLUME_ALL_TETRAHEDRA;
  for (int v = 0; v < 8 && cut.x; ++v)
  {
    const int o = v ^ mirror;
    const int index =
      FindCutVertex(cutRows, cutVertices, x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), p);
    cut.y |= (cutVertices[index].Distance < 0.0f) << v;
  }
#endif
  return cut;
}

// Returns the bridges of a cell, as bits. owners: tetrahedra of the vertices, by vertex number. cut: result of FindCut.
static int FindBridges(
  const int* owners, int2 cut, __global const int4* tetrahedra, __global const int* coincidentNodes)
{
  uchar split[8]; // for each vertex the vertices on a different side, as bits
  int component[8];   // the lowest vertex of the connected component of each vertex
  int any = 0;
  for (int v = 0; v < 8; ++v)
  {
    split[v] = 0;
    component[v] = v;
  }
  for (int v = 1; v < 8; ++v)
  {
    for (int w = 0; w < v; ++w)
    {
      if (owners[v] < 0 || owners[w] < 0)
      {
        continue;
      }
      const int found = owners[v] == owners[w]
        ? SHARES_NODE
        : CompareNodes(tetrahedra[owners[v]], tetrahedra[owners[w]], coincidentNodes);
      if (found & IS_SPLIT)
      {
        split[v] |= 1 << w;
        split[w] |= 1 << v;
        any = 1;
      }
      else if (found)
      {
        const int low = min(component[v], component[w]);
        const int high = max(component[v], component[w]);
        for (int u = 0; u < 8; ++u)
        {
          component[u] = component[u] == high ? low : component[u];
        }
      }
    }
  }
  int bridges = 0;
  for (int t = 0; any && t < 5; ++t)
  {
    for (int i = 1; i < 4; ++i)
    {
      for (int j = 0; j < i; ++j)
      {
        const int v = Tetrahedra[t][i], w = Tetrahedra[t][j];
        const int areSeparated = (cut.x >> t & 1) && ((cut.y >> v ^ cut.y >> w) & 1);
        bridges |= !areSeparated && ((split[v] >> w & 1) || component[v] != component[w]) ? 1 << t : 0;
      }
    }
  }
  return bridges;
}

// Computes the mask `resampled` of the cells of cuboids. changed: set to 1 for each cuboid of the list in which the
// mask of a cell has changed.
__kernel void UpdateResampledMask(MAPPING_PARAMETERS, __global const int* owners,
  __global const int4* tetrahedraOfMesh, __global const int* coincidentNodes, const int hasCoincidentNodes,
  __global const uchar* boundary, const int hasBoundary, __global const uchar* active, const int hasActive,
  __global const uint* cutRows, __global const CutVertex* cutVertices,
  __global uchar* resampled, __global uint* changed, __global const uint* cuboids, const KernelParameters p)
{
  const Mapping m = MAPPING_ARGUMENTS;
  const int3 first = FirstVertex(cuboids[get_global_id(1)], &p);
  const int3 end = min(EndOfVertices(first, &p), (int3)(p.Size[0], p.Size[1], p.PlanesEnd) - 1);
  int isChanged = 0;
  for (int z = first.z; z < end.z; ++z)
  {
    for (int y = first.y; y < end.y; ++y)
    {
      for (int x = first.x + get_global_id(0); x < end.x; x += get_global_size(0))
      {
        const int mirror = Mirror(x, y, z, &p);
        int ownersOfCell[8];
        int same = 1;
        for (int v = 0; v < 8 && hasCoincidentNodes; ++v)
        {
          const int o = v ^ mirror;
          ownersOfCell[v] = TETRAHEDRON_OF(&m, x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), &p);
          same &= ownersOfCell[v] == ownersOfCell[0];
        }
        const int bridges = same
          ? 0
          : FindBridges(ownersOfCell, FindCut(cutRows, cutVertices, x, y, z, mirror, &p),
              tetrahedraOfMesh, coincidentNodes);
        const size_t cell = CellInChunk(x, y, z, &p);
        const int boundaryMask = hasBoundary ? boundary[cell] : DEFORMVOLUME_ALL_TETRAHEDRA;
        const int mask = boundaryMask &
          ((DEFORMVOLUME_ALL_TETRAHEDRA & (hasActive ? active[cell] : ~0) & ~bridges) |
            DEFORMVOLUME_CELL_AT_BOUNDARY | DEFORMVOLUME_CELL_CROSSED);
        isChanged |= mask != resampled[cell];
        resampled[cell] = mask;
      }
    }
  }
  if (isChanged)
  {
    atomic_or(changed + get_global_id(1), 1u);
  }
}
