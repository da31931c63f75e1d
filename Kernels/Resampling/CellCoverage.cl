// SPDX-License-Identifier: BSD-3-Clause
// The fill rule: which tetrahedron of the sampling mesh writes a voxel.
//
// Coverage is closed: a voxel is covered when its centre lies in an active tetrahedron or on its
// surface. Where the centre lies on a face, an edge or a vertex that several tetrahedra share,
// exactly one of them writes it:
// - inside the mesh the one that holds the centre after a shift by (e, e^2, e^3) for an
//   infinitesimal e > 0 (the top-left rule of triangle rasterisation in three dimensions);
// - on the border of the volume, where all cells are there, the cell that has the simplex on its low sides,
//   in the order of the voxel grid, or is the last one on an axis; of its tetrahedra the first;
// - on the border of the mesh elsewhere, where any may be missing, the one that holds the centre after
//   a shift by (+-e, +-e^2, +-e^3), whichever of the signs +++, -++, +-+, --+, ++-, ... comes first; if no
//   shift leads into the mesh, the last one in the order of cells and tetrahedra.
// Which of the three holds depends only on the simplex whose interior the centre lies in, so that
// all tetrahedra round it decide alike.
//
// Where the mesh folds over, several may write a voxel, and at the crease none. Further passes then
// take every tetrahedron that holds the centre of such a voxel, and the winner's key decides.
//
// All arithmetic is exact: positions are integers in 1/256 voxel, and for a tetrahedron of e
// voxels the edge functions are at most 2 (256 e)^3, which fits 64 bits up to 6,500 voxels.

#pragma OPENCL FP_CONTRACT OFF

#define MAXIMUM_STRETCH (4000 * 256)

__constant uchar Tetrahedra[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
__constant uchar CornerBehindFace[4] = DEFORMVOLUME_CORNER_BEHIND_FACE;

// Six times the signed volume.
static long Determinant(Vector a, Vector b, Vector c, Vector d)
{
  return Dot(Subtract(b, a), Cross(Subtract(c, a), Subtract(d, a)));
}

static Vector Minimum(Vector a, Vector b)
{
  const Vector r = { min(a.x, b.x), min(a.y, b.y), min(a.z, b.z) };
  return r;
}

static Vector Maximum(Vector a, Vector b)
{
  const Vector r = { max(a.x, b.x), max(a.y, b.y), max(a.z, b.z) };
  return r;
}

// Tetrahedra that the edge functions do not hold are left out.
static int IsOverstretched(Vector a, Vector b, Vector c, Vector d)
{
  const Vector extent =
    Subtract(Maximum(Maximum(a, b), Maximum(c, d)), Minimum(Minimum(a, b), Minimum(c, d)));
  return max(extent.x, max(extent.y, extent.z)) > MAXIMUM_STRETCH;
}

// A tetrahedron ready to be evaluated: the edge function of the face opposite vertex k is
// Normals[k] . (sample - Origin), plus Volume for k = 0. It is positive inside, and the four add up
// to Volume, so that they are the barycentric weights times Volume.
typedef struct
{
  Vector Origin;
  Vector Normals[4];
  long Volume;
} EdgeFunctions;

static EdgeFunctions MakeEdgeFunctions(Vector a, Vector b, Vector c, Vector d)
{
  EdgeFunctions f;
  const Vector u = Subtract(b, a);
  const Vector v = Subtract(c, a);
  const Vector w = Subtract(d, a);
  f.Origin = a;
  f.Normals[1] = Cross(v, w);
  f.Normals[2] = Cross(w, u);
  f.Normals[3] = Cross(u, v);
  f.Volume = Dot(u, f.Normals[1]);
  if (f.Volume < 0)
  {
    f.Volume = -f.Volume;
    for (int k = 1; k < 4; ++k)
    {
      f.Normals[k].x = -f.Normals[k].x;
      f.Normals[k].y = -f.Normals[k].y;
      f.Normals[k].z = -f.Normals[k].z;
    }
  }
  f.Normals[0].x = -(f.Normals[1].x + f.Normals[2].x + f.Normals[3].x);
  f.Normals[0].y = -(f.Normals[1].y + f.Normals[2].y + f.Normals[3].y);
  f.Normals[0].z = -(f.Normals[1].z + f.Normals[2].z + f.Normals[3].z);
  return f;
}

static void Evaluate(const EdgeFunctions* f, Vector sample, long* weights)
{
  const Vector r = Subtract(sample, f->Origin);
  weights[1] = Dot(f->Normals[1], r);
  weights[2] = Dot(f->Normals[2], r);
  weights[3] = Dot(f->Normals[3], r);
  weights[0] = f->Volume - weights[1] - weights[2] - weights[3];
}

// Whether a shift by (e, e^2, e^3) moves a sample on the face towards the inside; of the signs of the
// shift those are reversed whose bits are set.
static int ShiftsInside(Vector normal, int signs)
{
  const long along = normal.x ? (signs & 1 ? -normal.x : normal.x)
    : normal.y                ? (signs & 2 ? -normal.y : normal.y)
                              : (signs & 4 ? -normal.z : normal.z);
  return along > 0;
}

// Positions of the vertices of a cell and of the cells round it, as far as they have been asked for: on the border of
// the mesh each is needed many times.
typedef struct
{
  int First[3]; // local index of the first vertex
  ulong Known;  // bits of the vertices, along x, then y, then z
  int4 Positions[64];
} Neighbours;

// The sampling mesh round a launch's cells.
typedef struct
{
  Mapping Map;
  __global const uchar* State;
  __global const uchar* Active;
  __global const float* Distances; // to the boundary, of the vertices
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
    ? mesh->Active[((size_t)(z - p->ChunkFirst) * (p->Size[1] - 1) + y) * (p->Size[0] - 1) + x] &
      DEFORMVOLUME_ALL_TETRAHEDRA
    : DEFORMVOLUME_ALL_TETRAHEDRA;
}

// Parity bits of a cell in the order of the bits of a vertex number: x, z, y.
static int Mirror(int x, int y, int z, const KernelParameters* p)
{
  return ((p->First[0] + x) & 1) | ((p->First[2] + z) & 1) << 1 | ((p->First[1] + y) & 1) << 2;
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

// The first shift that leads from a simplex into the tetrahedron with these edge functions and
// vertices (a mask over the cell's vertices for each), or 8 where none does.
static int FirstShiftInside(const EdgeFunctions* f, int tetrahedron, int simplex)
{
  for (int signs = 0; signs < 8; ++signs)
  {
    int inside = 1;
    for (int k = 0; k < 4; ++k)
    {
      inside &= (simplex >> Tetrahedra[tetrahedron][k] & 1) || ShiftsInside(f->Normals[k], signs);
    }
    if (inside)
    {
      return signs;
    }
  }
  return 8;
}

// Whether of the tetrahedra that share the simplex with these vertices (a mask over the cell's vertices)
// none comes before this one of the cell by the rule for the border of the mesh.
static int IsOwnerOnBorder(const SamplingMesh* mesh, int x, int y, int z, int tetrahedron,
  int simplex, const EdgeFunctions* f, const KernelParameters* p)
{
  const int own = FirstShiftInside(f, tetrahedron, simplex);
  if (own == 0)
  {
    return 1; // another one with that shift overlaps this one
  }
  // The simplex in the voxel grid: does it reach the low and the high side of the cell on each axis?
  const int mirror = Mirror(x, y, z, p);
  int low = 0;
  int high = 0;
  for (int v = 0; v < 8; ++v)
  {
    if (simplex >> v & 1)
    {
      high |= v ^ mirror;
      low |= ~(v ^ mirror) & 7;
    }
  }
  // Inside the mesh the shift +++ leads to the high sides more often than not: what they have is found first.
  for (int dz = 1; dz >= -1; --dz)
  {
    for (int dy = 1; dy >= -1; --dy)
    {
      for (int dx = 1; dx >= -1; --dx)
      {
        // A neighbour on the low side shares the simplex only if that does not reach the high side.
        const int needsLow = (dx < 0) | (dz < 0) << 1 | (dy < 0) << 2;
        const int needsHigh = (dx > 0) | (dz > 0) << 1 | (dy > 0) << 2;
        const int nx = x + dx;
        const int ny = y + dy;
        const int nz = z + dz;
        if ((high & needsLow) || (low & needsHigh) || nx < 0 || ny < 0 || nz < 0 ||
          nx >= p->Size[0] - 1 || ny >= p->Size[1] - 1 || nz >= p->Size[2] - 1)
        {
          continue;
        }
        const int active = ActiveTetrahedra(mesh, nx, ny, nz, p);
        const int order = (dz * 3 + dy) * 3 + dx; // of the cell, 0 for the tetrahedron's own
        // The simplex in the numbers of the neighbour's vertices: on an axis that leads to the
        // neighbour sides are exchanged, and so is the mirroring, hence numbers do not change.
        Vector q[8];
        int present = -1;
        for (int t = 0; t < 5; ++t)
        {
          if (order == 0 && t == tetrahedron)
          {
            continue;
          }
          const int later = order > 0 || (order == 0 && t > tetrahedron);
          const int needed = VerticesOf(t);
          if (!(active >> t & 1) || (simplex & needed) != simplex)
          {
            continue;
          }
          if (present < 0)
          {
            present = LoadCell(mesh, nx, ny, nz, p, q);
          }
          if ((present & needed) != needed ||
            IsOverstretched(
              q[Tetrahedra[t][0]], q[Tetrahedra[t][1]], q[Tetrahedra[t][2]], q[Tetrahedra[t][3]]))
          {
            continue;
          }
          const EdgeFunctions other = MakeEdgeFunctions(
            q[Tetrahedra[t][0]], q[Tetrahedra[t][1]], q[Tetrahedra[t][2]], q[Tetrahedra[t][3]]);
          const int shift = FirstShiftInside(&other, t, simplex);
          if (other.Volume != 0 && (shift < own || (shift == own && later)))
          {
            return 0;
          }
        }
      }
    }
  }
  return 1;
}

// The state of a cell's vertices, as masks.
typedef struct
{
  int Interior;
  int Regular; // all that surrounds these is there, but for what would lie beyond the volume
} CellState;

static CellState CellStateOf(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  const int mirror = Mirror(x, y, z, p);
  CellState cell = { 0, 0 };
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    const int state = StateOf(mesh->State, x + (o & 1), y + (o >> 2), z + (o >> 1 & 1), p);
    cell.Interior |= (state & DEFORMVOLUME_VERTEX_INTERIOR) ? 1 << v : 0;
    cell.Regular |= (state & DEFORMVOLUME_VERTEX_REGULAR) ? 1 << v : 0;
  }
  return cell;
}

// The vertices on the low side of a cell on the axis of a bit of vertex numbers.
#define LOW_SIDE(axis, mirror) (LOW_VERTICES(axis) ^ ((mirror) >> (axis)&1 ? 255 : 0))
#define LOW_VERTICES(axis) ((axis) == 0 ? 0x55 : (axis) == 1 ? 0x33 : 0x0f)

// Whether a tetrahedron of a cell owns a simplex on the border of the volume, where all cells are there.
static int IsOwnerByIndex(
  int x, int y, int z, int tetrahedron, int simplex, const KernelParameters* p)
{
  for (int before = 0; before < tetrahedron; ++before)
  {
    if ((simplex & VerticesOf(before)) == simplex)
    {
      return 0;
    }
  }
  const int mirror = Mirror(x, y, z, p);
  return ((simplex & LOW_SIDE(0, mirror)) || x == p->Size[0] - 2) &&
    ((simplex & LOW_SIDE(1, mirror)) || z == p->Size[2] - 2) &&
    ((simplex & LOW_SIDE(2, mirror)) || y == p->Size[1] - 2);
}

// What a tetrahedron is to a sample.
#define STRANGER 0 // does not hold it
#define HOLDER 1   // holds it on its surface, and leaves it to another one
#define OWNER 2    // writes it

// What a tetrahedron of a cell is to the sample with these weights.
static int RoleOf(const SamplingMesh* mesh, int x, int y, int z, int tetrahedron, const long* weights,
  const EdgeFunctions* f, CellState state, const KernelParameters* p)
{
  int simplex = 0;
  int inside = 1;
  for (int k = 0; k < 4; ++k)
  {
    if (weights[k] < 0)
    {
      return STRANGER;
    }
    if (weights[k] > 0)
    {
      simplex |= 1 << Tetrahedra[tetrahedron][k];
    }
    else
    {
      inside &= ShiftsInside(f->Normals[k], 0);
    }
  }
  if (DEFORMVOLUME_IS_CLOSED(p->Pass))
  {
    return OWNER; // the winner is chosen by its key
  }
  if ((weights[0] && weights[1] && weights[2] && weights[3]) || (simplex & state.Interior))
  {
    return inside ? OWNER : HOLDER;
  }
  const int owner = (simplex & state.Regular) == simplex
    ? IsOwnerByIndex(x, y, z, tetrahedron, simplex, p)
    : IsOwnerOnBorder(mesh, x, y, z, tetrahedron, simplex, f, p);
  return owner ? OWNER : HOLDER;
}
