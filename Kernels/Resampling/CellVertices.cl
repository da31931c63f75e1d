// SPDX-License-Identifier: BSD-3-Clause
// The vertices of the cells of the sampling mesh: where they are, and which tetrahedra they make.

__constant uchar CornerBehindFace[4] = DEFORMVOLUME_CORNER_BEHIND_FACE;

// Positions of the vertices of a cell and of the cells round it, as far as they have been asked for: on the border of
// the mesh each is needed many times.
typedef struct
{
  int First[3]; // local index of the first vertex
  ulong Known;  // bits of the vertices, along x, then y, then z
  int4 Positions[64];
} Neighbours;

#if HAS_CUT
// A smooth cut: the vertices of the cells that it crosses (FindCutVertex), and of each where it would be if it moved
// with the other side (CutPositions.cl); INT_MIN in x where no tetrahedron asks.
typedef struct
{
  __global const uint* Rows;
  __global const CutVertex* Vertices;
  __global const int4* Positions;
} SmoothCut;
// With the comma before them.
#define CUT_PARAMETERS                                                                             \
  , __global const uint *cutRows, __global const CutVertex *cutVertices,                           \
    __global const int4 *cutPositions
#define CUT_ARGUMENTS , { cutRows, cutVertices, cutPositions }
#else
#define CUT_PARAMETERS
#define CUT_ARGUMENTS
#endif

// The sampling mesh round a launch's cells.
typedef struct
{
  Mapping Map;
  __global const uchar* State;
  __global const uchar* Active;
  __global const float* Distances; // to the boundary, of the vertices
#if HAS_CUT
  SmoothCut Cut;
#endif
  // Positions that are in local memory: of each vertex of a cuboid x, y and z, INT_MIN for a vertex without
  // position. Null: none are.
  __local const int* Cuboid;
  int CuboidFirst[3]; // local index of the first cell
  Neighbours* Near;   // of the cell that is worked on. Null: none are kept.
} SamplingMesh;

// A mesh that keeps the positions round a cell.
static SamplingMesh KeepNeighbours(const SamplingMesh* mesh, int x, int y, int z, Neighbours* near)
{
  near->First[0] = x - 1;
  near->First[1] = y - 1;
  near->First[2] = z - 1;
  near->Known = 0;
  SamplingMesh keeping = *mesh;
  keeping.Near = near;
  return keeping;
}

// The place of a vertex in a cuboid, or -1 outside it.
static int PlaceInCuboid(const SamplingMesh* mesh, int x, int y, int z)
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

// The position of a vertex in 1/256 output voxel; INT_MIN in x where it has none.
static int4 VertexPosition(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  if (mesh->Near)
  {
    const int place = ((z - mesh->Near->First[2]) * 4 + y - mesh->Near->First[1]) * 4 + x - mesh->Near->First[0];
    if (!(mesh->Near->Known >> place & 1))
    {
      mesh->Near->Positions[place] = FindPosition(mesh, x, y, z, p);
      mesh->Near->Known |= 1ul << place;
    }
    return mesh->Near->Positions[place];
  }
  const int place = mesh->Cuboid ? PlaceInCuboid(mesh, x, y, z) : -1;
  if (place >= 0)
  {
    return (int4)(mesh->Cuboid[3 * place], mesh->Cuboid[3 * place + 1], mesh->Cuboid[3 * place + 2], 0);
  }
  return FindPosition(mesh, x, y, z, p);
}

static int ActiveTetrahedra(const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  return p->HasActive
    ? mesh->Active[CellInChunk(x, y, z, p)] & DEFORMVOLUME_ALL_TETRAHEDRA
    : DEFORMVOLUME_ALL_TETRAHEDRA;
}

// The eight vertices of a cell; returns the mask of those that have a position.
static int LoadCell(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p, Vector* vertices)
{
  const int mirror = Mirror(x, y, z, p);
  int present = 0;
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    const int4 q = VertexPosition(mesh, x + (o & 1), y + (o >> 2), z + (o >> 1 & 1), p);
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
