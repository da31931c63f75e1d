// SPDX-License-Identifier: BSD-3-Clause
// The fill rule: it decides which tetrahedron of the sampling mesh writes a voxel.
//
// Coverage is closed: a voxel is covered if its center lies in an active tetrahedron or on its surface. If the center
// lies on a face, edge or vertex that several tetrahedra share, exactly one of them writes the voxel:
// - inside the sampling mesh, the one that holds the center after a shift by (e, e^2, e^3) for an infinitesimal e > 0
//   (the top-left rule of triangle rasterization in three dimensions);
// - at the border of the volume, if all cells exist there, the first tetrahedron with the simplex in this cell: on
//   each axis the simplex touches the low side of the cell in the voxel grid, or the cell is the last one;
// - elsewhere at the border of the sampling mesh, where any cell may be missing, the one that holds the center after
//   the first possible shift (+-e, +-e^2, +-e^3), with signs in the order +++, -++, +-+, --+, ++-, ...; if no shift
//   leads into the mesh, the last one in the order of cells and tetrahedra.
// Which of the three rules applies depends only on the simplex whose interior contains the center. So all tetrahedra
// around it decide consistently.
//
// If the mesh is folded, several tetrahedra may write a voxel, and some voxels at the crease may have no tetrahedron
// that writes them. Further passes then visit every tetrahedron that holds the center of such a voxel, and the winner's
// key decides.
//
// The host defines before this text:
//   OUTLINED  for large functions: empty, or the noinline attribute for compilers that would take many seconds
//             to inline them all
//
// All arithmetic is exact. Positions are integers in 1/256 voxel. For a tetrahedron of e voxels the edge functions
// are at most 2 (256 e)^3, which fits 64 bits up to 6,500 voxels.

#pragma OPENCL FP_CONTRACT OFF

#define MAXIMUM_STRETCH (4000 * 256)

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

// Whether a tetrahedron is too large for the edge functions. Such tetrahedra are skipped.
static int IsOverstretched(Vector a, Vector b, Vector c, Vector d)
{
  const Vector extent =
    Subtract(Maximum(Maximum(a, b), Maximum(c, d)), Minimum(Minimum(a, b), Minimum(c, d)));
  return max(extent.x, max(extent.y, extent.z)) > MAXIMUM_STRETCH;
}

// The edge functions of a tetrahedron. The edge function of the face opposite vertex k is Normals[k] . (sample -
// Origin), plus Volume for k = 0. Edge functions are positive inside. Their sum is Volume, so they are the barycentric
// weights times Volume.
typedef struct
{
  Vector Origin;
  Vector Normals[4];
  long Volume;
} EdgeFunctions;

static OUTLINED EdgeFunctions MakeEdgeFunctions(Vector a, Vector b, Vector c, Vector d)
{
  EdgeFunctions f;
  f.Origin = a;
  f.Volume =
    FindFaceNormals(Subtract(b, a), Subtract(c, a), Subtract(d, a), f.Normals + 1, f.Normals);
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

// Returns the first shift that leads from a simplex into a tetrahedron, or 8 if there is none. simplex: a mask of
// vertices of the cell.
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

// Whether this tetrahedron owns a simplex by the rule for the border of the sampling mesh: of all tetrahedra that share
// the simplex, none comes before it. simplex: a mask of vertices of the cell. own: the first shift into this
// tetrahedron. side: the side of a smooth cut whose copies are considered.
static OUTLINED int IsOwnerOnBorder(const SamplingMesh* mesh, int x, int y, int z, int tetrahedron,
  int simplex, int own, int side, const KernelParameters* p)
{
  if (own == 0)
  {
    return 1; // only an overlapping tetrahedron could have the same shift
  }
  // The sides of the cell that the simplex touches in the voxel grid, as bits of axes.
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
  // Inside the mesh the shift +++ usually leads to the high sides, so search there first.
  for (int dz = 1; dz >= -1; --dz)
  {
    for (int dy = 1; dy >= -1; --dy)
    {
      for (int dx = 1; dx >= -1; --dx)
      {
        // A neighbor on the low side shares the simplex only if the simplex does not touch the high side.
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
        const int order = (dz * 3 + dy) * 3 + dx; // order of the neighbor; 0 for the own cell
        // The neighbor has the same vertex numbers for the simplex: on an axis towards the neighbor, both the sides
        // and the mirroring are exchanged.
        Vector q[8];
#if HAS_CUT
        CellCut cut;
#endif
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
#if HAS_CUT
            LoadCut(mesh, nx, ny, nz, active, p, &cut);
#endif
          }
          Vector v[4] = { q[Tetrahedra[t][0]],
            q[Tetrahedra[t][1]], q[Tetrahedra[t][2]], q[Tetrahedra[t][3]] };
          int hasPositions = (present & needed) == needed;
#if HAS_CUT
          hasPositions = hasPositions && ViewTetrahedron(mesh, &cut, t, side, v);
#endif
          if (!hasPositions || IsOverstretched(v[0], v[1], v[2], v[3]))
          {
            continue;
          }
          const EdgeFunctions other = MakeEdgeFunctions(v[0], v[1], v[2], v[3]);
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

// States of the vertices of a cell, as masks.
typedef struct
{
  int Interior;
  int Regular; // all surrounding cells exist, except those beyond the volume
} CellState;

static OUTLINED CellState CellStateOf(
  const SamplingMesh* mesh, int x, int y, int z, const KernelParameters* p)
{
  const int mirror = Mirror(x, y, z, p);
  CellState cell = { 0, 0 };
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    const int state = StateOf(mesh->State, x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), p);
    cell.Interior |= (state & DEFORMVOLUME_VERTEX_INTERIOR) ? 1 << v : 0;
    cell.Regular |= (state & DEFORMVOLUME_VERTEX_REGULAR) ? 1 << v : 0;
  }
  return cell;
}

// The vertices on the low side of a cell, on the axis of a bit of the vertex numbers.
#define LOW_SIDE(axis, mirror) (LOW_VERTICES(axis) ^ ((mirror) >> (axis)&1 ? 255 : 0))
#define LOW_VERTICES(axis) ((axis) == 0 ? 0x55 : (axis) == 1 ? 0x33 : 0x0f)

// Whether a tetrahedron owns a simplex at the border of the volume, if all cells exist there.
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

// The role of a tetrahedron for a sample.
#define OUTSIDE 0     // does not hold the sample
#define ON_BOUNDARY 1 // has the sample on its surface; another tetrahedron writes it
#define OWNER 2       // writes the sample

// Returns the role of a tetrahedron for the sample with these weights.
static OUTLINED int RoleOf(const SamplingMesh* mesh, int x, int y, int z, int tetrahedron, const long* weights,
  const EdgeFunctions* f, CellState state, const KernelParameters* p)
{
  int simplex = 0;
  int inside = 1;
  for (int k = 0; k < 4; ++k)
  {
    if (weights[k] < 0)
    {
      return OUTSIDE;
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
  if (DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass))
  {
    return OWNER; // the winner's key decides
  }
  if ((weights[0] && weights[1] && weights[2] && weights[3]) || (simplex & state.Interior))
  {
    return inside ? OWNER : ON_BOUNDARY;
  }
#if HAS_CUT
  const int side = SideOfSample(mesh, x, y, z, tetrahedron, weights, p);
#else
  const int side = 0;
#endif
  const int owner = (simplex & state.Regular) == simplex
    ? IsOwnerByIndex(x, y, z, tetrahedron, simplex, p)
    : IsOwnerOnBorder(mesh, x, y, z, tetrahedron, simplex,
        FirstShiftInside(f, tetrahedron, simplex), side, p);
  return owner ? OWNER : ON_BOUNDARY;
}
