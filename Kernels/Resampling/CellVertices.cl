// SPDX-License-Identifier: BSD-3-Clause
// The vertices of the cells of the sampling mesh: their positions, and the tetrahedra that they form.

__constant uchar CornerBehindFace[4] = DEFORMVOLUME_CORNER_BEHIND_FACE;

// A cache of the positions of the vertices of a cell and of the surrounding cells: at the border of the sampling
// mesh each position is needed many times.
typedef struct
{
  int First[3]; // local index of the first vertex
  ulong Known;  // bits of cached vertices, along x, then y, then z
  int4 Positions[64];
} Neighbors;

#if HAS_CUT
// A smooth cut: the vertices of the cells that it crosses (FindCutVertex). For each vertex, Positions has its
// position if it moved with the other side (CutPositions.cl); INT_MIN in x if no tetrahedron needs this position.
typedef struct
{
  __global const uint* Rows;
  __global const CutVertex* Vertices;
  __global const int4* Positions;
} SmoothCut;
// Both macros include the comma before the parameters.
#define CUT_PARAMETERS                                                                             \
  , __global const uint *cutRows, __global const CutVertex *cutVertices,                           \
    __global const int4 *cutPositions
#define CUT_ARGUMENTS , { cutRows, cutVertices, cutPositions }
#else
#define CUT_PARAMETERS
#define CUT_ARGUMENTS
#endif

// The sampling mesh around the cells of a launch.
typedef struct
{
  Mapping Map;
  __global const uchar* State;
  __global const uchar* Active;
  __global const float* Distances; // boundary distances of the vertices
#if HAS_CUT
  SmoothCut Cut;
#endif
  // Positions in local memory: x, y and z of each vertex of a cuboid; INT_MIN for a vertex without position. Null:
  // there are none.
  __local const int* Cuboid;
  int CuboidFirst[3]; // local index of the first cell
  Neighbors* Near;   // cache for the current cell; null: none
} SamplingMesh;

// Returns a mesh that caches the positions around a cell.
static SamplingMesh KeepNeighbors(const SamplingMesh* mesh, int x, int y, int z, Neighbors* near)
{
  near->First[0] = x - 1;
  near->First[1] = y - 1;
  near->First[2] = z - 1;
  near->Known = 0;
  SamplingMesh keeping = *mesh;
  keeping.Near = near;
  return keeping;
}

// Returns the index of a vertex in the cuboid, or -1 outside it.
static int IndexInCuboid(const SamplingMesh* mesh, int x, int y, int z)
{
  const uint bx = x - mesh->CuboidFirst[0];
  const uint by = y - mesh->CuboidFirst[1];
  const uint bz = z - mesh->CuboidFirst[2];
  return bx <= DEFORMVOLUME_CUBOID_X && by <= DEFORMVOLUME_CUBOID_Y && bz <= DEFORMVOLUME_CUBOID_Z
    ? (int)((bz * (DEFORMVOLUME_CUBOID_Y + 1) + by) * (DEFORMVOLUME_CUBOID_X + 1) + bx)
    : -1;
}

static int4 FindPosition(const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  return StateOf(mesh->State, x, y, z, p) & DEFORMVOLUME_VERTEX_SOURCE
    ? PositionOf(&mesh->Map, x, y, z, p)
    : (int4)(INT_MIN, 0, 0, 0);
}

// Returns the position of a vertex in 1/256 output voxel; INT_MIN in x if it has none.
static int4 VertexPosition(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  if (mesh->Near)
  {
    const int index = ((z - mesh->Near->First[2]) * 4 + y - mesh->Near->First[1]) * 4 + x - mesh->Near->First[0];
    if (!(mesh->Near->Known >> index & 1))
    {
      mesh->Near->Positions[index] = FindPosition(mesh, x, y, z, p);
      mesh->Near->Known |= 1ul << index;
    }
    return mesh->Near->Positions[index];
  }
  const int index = mesh->Cuboid ? IndexInCuboid(mesh, x, y, z) : -1;
  if (index >= 0)
  {
    return (int4)(mesh->Cuboid[3 * index], mesh->Cuboid[3 * index + 1], mesh->Cuboid[3 * index + 2], 0);
  }
  return FindPosition(mesh, x, y, z, p);
}

static int ActiveTetrahedra(const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  return p->HasActive
    ? mesh->Active[CellInChunk(x, y, z, p)] & DEFORMVOLUME_ALL_TETRAHEDRA
    : DEFORMVOLUME_ALL_TETRAHEDRA;
}

// Loads the eight vertices of a cell. Returns the mask of those that have a position.
static int LoadCell(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p, Vector* vertices)
{
  const int mirror = Mirror(x, y, z, p);
  int present = 0;
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    const int4 q = VertexPosition(mesh, x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), p);
    vertices[v].x = q.x;
    vertices[v].y = q.y;
    vertices[v].z = q.z;
    present |= (q.x != INT_MIN) << v;
  }
  return present;
}

static int VerticesOf(int tetrahedron)
{
  return 1 << Tetrahedra[tetrahedron][0] | 1 << Tetrahedra[tetrahedron][1] |
    1 << Tetrahedra[tetrahedron][2] | 1 << Tetrahedra[tetrahedron][3];
}
