// SPDX-License-Identifier: BSD-3-Clause
// Resampling: rasterizes the five tetrahedra of each cell of the sampling mesh into the output by the fill rule of
// CellCoverage.cl, for all arrays of the volume in one pass over the geometry.
//
// Data: input of the mapping (DeformationMapping.cl), state 1 byte per vertex, active tetrahedra 1 byte per cell
// (optional), boundary distances 4 bytes per voxel (optional), a smooth cut (CutCells.cl; optional), the output
// (VoxelWinners.cl), and the arrays in their own types (SampleStoring.cl).
//
// A work-group handles a cuboid of cells. It maps the vertices of the cuboid into local memory, each once. Then each
// work-item takes one cell, neighboring items neighboring cells. Almost all cells are convex enough that a sample needs
// the edge functions of the central tetrahedron, and at most those of the corner behind one face. Other cells, and
// cells with many samples, are resampled one tetrahedron after the other, row by row. Cells with very many samples are
// only added to a list (LargeCells.cl).

// A cell of the sampling mesh, with those of its tetrahedra that a smooth cut does not divide; or, with a Side, a
// view: the copies of the divided tetrahedra for that side.
typedef struct ViewedCell
{
  int X, Y, Z;
  int Tetrahedra; // bits of the tetrahedra that exist and are not flat
  int Inverted;   // bits of the inverted ones
  int Clipped;    // bits of the clipped ones: their boundary distances have both signs
#if HAS_CUT
  int Side; // side of a view; -1 for the cell itself
  CellCut Cut;
  const struct ViewedCell* Whole; // the cell itself
  const struct ViewedCell* Views; // views of sides 0 and 1, if tetrahedra are divided
#endif
  CellState State;
  Vector Vertices[8];
  Vector Low; // bounds of the vertices that have a position
  Vector High;
  float Distances[8]; // boundary distances of the vertices, if a vertex is clipped
} Cell;

// A cell has one part, or three if it has two views. Parts are drawn in the order of these numbers. Without a cut
// there is only the cell itself.
#if HAS_CUT
static const Cell* WholeOf(const Cell* part)
{
  return part->Whole;
}

static int CountParts(const Cell* whole)
{
  return whole->Cut.Divided ? 3 : 1;
}

static const Cell* PartOf(const Cell* whole, int part)
{
  return part == 0 ? whole : whole->Views + (2 - part);
}
#else
#define WholeOf(part) (part)
#define CountParts(whole) 1
#define PartOf(whole, part) (whole)
#endif

static EdgeFunctions EdgeFunctionsOf(const Cell* cell, int t)
{
  return MakeEdgeFunctions(cell->Vertices[Tetrahedra[t][0]], cell->Vertices[Tetrahedra[t][1]],
    cell->Vertices[Tetrahedra[t][2]], cell->Vertices[Tetrahedra[t][3]]);
}

static Vector SamplePosition(Vector voxel)
{
  const Vector r = { voxel.x * 256, voxel.y * 256, voxel.z * 256 };
  return r;
}

// Whether a sample is skipped, because its boundary distance is negative or it lies on the other side of the cut.
// Distances are interpolated in the tetrahedron like values. weights: of the sample, from edge functions.
static int IsClipped(const Cell* cell, int t, const long* weights)
{
#if HAS_CUT
  if (cell->Side >= 0 && (WeighDistances(cell->Cut.Distances, t, weights) < 0) != cell->Side)
  {
    return 1;
  }
#endif
  return (cell->Clipped >> t & 1) && WeighDistances(cell->Distances, t, weights) < 0;
}

// Whether an earlier tetrahedron of the cell with the same key writes the voxel, too.
static __attribute__((noinline)) int IsWrittenBefore(const SamplingMesh* mesh, const Cell* cell,
  int tetrahedron, Vector voxel, const KernelParameters* p)
{
  const int inverted = cell->Inverted >> tetrahedron & 1;
  const int parts = CountParts(WholeOf(cell));
  for (int t = 4; t >= tetrahedron; --t)
  {
    for (int i = 0; i < parts; ++i)
    {
      const Cell* const part = PartOf(WholeOf(cell), i);
      if (part == cell && t == tetrahedron)
      {
        return 0;
      }
      if (!(part->Tetrahedra >> t & 1) || (part->Inverted >> t & 1) != inverted)
      {
        continue;
      }
      const EdgeFunctions f = EdgeFunctionsOf(part, t);
      long weights[4];
      Evaluate(&f, SamplePosition(voxel), weights);
      if (RoleOf(mesh, cell->X, cell->Y, cell->Z, t, weights, &f, cell->State, p) == OWNER &&
        !IsClipped(part, t, weights))
      {
        return 1;
      }
    }
  }
  return 0;
}

#if CUBIC
// Whether all 64 voxels around a cell exist with boundary distances that are not negative, and all tetrahedra of the
// cell and of its 26 neighbors exist and are not crossed by a smooth cut. All vertices of the cell are interior in
// that case. They may also be interior next to cells at the boundary of the deformation mesh, which are resampled
// without their vertices.
static int HasAllAround(const SamplingMesh* mesh, const Cell* cell, const KernelParameters* p)
{
  if (cell->State.Interior != 255)
  {
    return 0;
  }
  const size_t number = CellInChunk(cell->X, cell->Y, cell->Z, p);
  if (p->HasActive && (mesh->Active[number] & DEFORMVOLUME_CELL_AT_BOUNDARY))
  {
    return 0;
  }
#if HAS_CUT
  for (int i = 0; i < 27; ++i)
  {
    const int index = FindCutVertex(mesh->Cut.Rows, mesh->Cut.Vertices, cell->X + i % 3 - 1,
      cell->Y + i / 3 % 3 - 1, cell->Z + i / 9 - 1, p);
    if (index >= 0 && (mesh->Cut.Vertices[index].Tetrahedra & DEFORMVOLUME_ALL_TETRAHEDRA))
    {
      return 0;
    }
  }
#endif
  return 1;
}
#endif

// Writes a sample that a tetrahedron holds. s: memory for samples of the tetrahedron; Volume is 0 if BeginSamples was
// not called yet.
static OUTLINED void Write(const SamplingMesh* mesh, const Cell* cell, int t, const long* weights,
  long volume, Sample* s, Vector voxel, int role, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  if (IsClipped(cell, t, weights))
  {
    return;
  }
  const int outputX = voxel.x - p->OutputFirst[0];
  const int outputY = voxel.y - p->OutputFirst[1];
  const int outputZ = voxel.z - p->OutputFirst[2];
  if (role == ON_BOUNDARY)
  {
    if (p->Pass == DEFORMVOLUME_PASS_OWNERS)
    {
      Touch(outputX, outputY, outputZ, output, p);
    }
    return;
  }
  const size_t target = ((size_t)outputZ * p->OutputSize[1] + outputY) * p->OutputSize[0] + outputX;
  if (p->Pass == DEFORMVOLUME_PASS_COUNT)
  {
    atomic_inc((volatile __global uint*)(output->Winners + target));
    return;
  }
  output->Writes++;
  if (p->Pass != DEFORMVOLUME_PASS_DIRECT)
  {
    const KEY key = MakeKey(cell->X, cell->Y, cell->Z, cell->Inverted >> t & 1, p);
    // The voxel may also have this key because the cell is resampled a second time (BrickResampling.cl).
    if (p->Pass == DEFORMVOLUME_PASS_OWNERS && output->Winners[target] == key &&
      IsWrittenBefore(mesh, cell, t, voxel, p))
    {
      Contest(output->Winners + target, key);
    }
    if (!WinsVoxel(output, target, key, p))
    {
      return;
    }
  }
  if (s->Volume == 0)
  {
    BeginSamples(s, cell->X, cell->Y, cell->Z, t, volume, p);
#if CUBIC
    s->IsCubic = HasAllAround(mesh, cell, p);
#endif
  }
  SetSample(s, weights, target);
  Cover(output, target);
#if CUBIC
  if (s->IsCubic && s->Only < 0)
  {
    StoreCubic(s, p ARRAY_ARGUMENTS);
    return;
  }
#endif
  StoreArrays(s ARRAY_ARGUMENTS);
}

// A box of output voxels, both ends included.
typedef struct
{
  Vector Low, High;
} Candidates;

static Candidates AllCandidates(const KernelParameters* p)
{
  const Vector low = { p->OutputFirst[0], p->OutputFirst[1], p->OutputFirst[2] };
  const Vector high = { low.x + p->OutputSize[0] - 1, low.y + p->OutputSize[1] - 1,
    low.z + p->OutputSize[2] - 1 };
  const Candidates all = { low, high };
  return all;
}

// Returns the candidates within bounds in 1/256 voxel, among `all`. open: 1 if the upper bounds are excluded, else 0.
static Candidates FindCandidates(Vector low, Vector high, int open, const Candidates* all)
{
  Candidates c;
  c.Low.x = max((low.x + 255) >> 8, all->Low.x);
  c.Low.y = max((low.y + 255) >> 8, all->Low.y);
  c.Low.z = max((low.z + 255) >> 8, all->Low.z);
  c.High.x = min((high.x - open) >> 8, all->High.x);
  c.High.y = min((high.y - open) >> 8, all->High.y);
  c.High.z = min((high.z - open) >> 8, all->High.z);
  return c;
}

static int IsEmpty(Candidates c)
{
  return c.Low.x > c.High.x || c.Low.y > c.High.y || c.Low.z > c.High.z;
}

static long CountCandidates(Candidates c)
{
  return (c.High.x - c.Low.x + 1) * (c.High.y - c.Low.y + 1) * (c.High.z - c.Low.z + 1);
}

#define FOR_EACH_CANDIDATE(voxel, c)                                                               \
  for (voxel.z = c.Low.z; voxel.z <= c.High.z; ++voxel.z)                                          \
    for (voxel.y = c.Low.y; voxel.y <= c.High.y; ++voxel.y)                                        \
      for (voxel.x = c.Low.x; voxel.x <= c.High.x; ++voxel.x)

// Resamples a cell whose tetrahedra all exist and are upright. A sample behind no face of the central tetrahedron is
// in the central tetrahedron, and a corner tetrahedron only holds samples behind its face. Corner tetrahedra of a
// very bent cell overlap. As in any cell, the lowest tetrahedron comes last, because the last write wins.
static OUTLINED void ResampleUprightCell(const SamplingMesh* mesh, const Cell* cell, Candidates c,
  Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  // In passes with closed tetrahedra, all tetrahedra that hold a sample write it in turn.
  const int closed = DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass);
  const EdgeFunctions central = EdgeFunctionsOf(cell, 4);
  Sample ofCentral;
  ofCentral.Volume = 0;
  Vector voxel;
  FOR_EACH_CANDIDATE(voxel, c)
  {
    const Vector sample = SamplePosition(voxel);
    long behind[4];
    Evaluate(&central, sample, behind);
    const int role = RoleOf(mesh, cell->X, cell->Y, cell->Z, 4, behind, &central, cell->State, p);
    if (role != OUTSIDE)
    {
      Write(
        mesh, cell, 4, behind, central.Volume, &ofCentral, voxel, role, output, p ARRAY_ARGUMENTS);
    }
    if (role == OWNER && !closed)
    {
      continue;
    }
    for (int t = 3; t >= 0; --t)
    {
      const long beyond = behind[CornerBehindFace[t]];
      if (beyond > 0)
      {
        continue;
      }
      const EdgeFunctions corner = EdgeFunctionsOf(cell, t);
      long weights[4];
      Evaluate(&corner, sample, weights);
      const int roleOfCorner =
        RoleOf(mesh, cell->X, cell->Y, cell->Z, t, weights, &corner, cell->State, p);
      if (roleOfCorner != OUTSIDE)
      {
        Sample s;
        s.Volume = 0;
        Write(mesh, cell, t, weights, corner.Volume, &s, voxel, roleOfCorner, output,
          p ARRAY_ARGUMENTS);
      }
      if (roleOfCorner == OWNER && beyond == 0 && !closed)
      {
        break; // the sample is on the face, so no other corner tetrahedron contains it
      }
    }
  }
}

// Shorter rows are not worth clipping.
#define MINIMUM_CLIPPED_ROW 6
// The tolerance for the ends of a clipped row, in samples. The ends are found in single precision, with an error of
// less than 2^-20 of their distance from the first sample, which is at most MAXIMUM_STRETCH.
#define CLIP_TOLERANCE (1.0f / 64.0f)

// Returns the first and the last sample of a row that a tetrahedron may hold; the first is greater if there is none.
// weights: at the first sample. steps: change from a sample to the next one. zeros: 1 / -steps, where steps are not
// 0.
static int2 ClipRow(const long* weights, const long* steps, const float* zeros, long samples)
{
  float first = 0.0f;
  float last = samples - 1;
  for (int k = 0; k < 4; ++k)
  {
    const float zero = (float)weights[k] * zeros[k];
    first = steps[k] > 0 && zero - CLIP_TOLERANCE > first ? zero - CLIP_TOLERANCE : first;
    last = steps[k] < 0 && zero + CLIP_TOLERANCE < last ? zero + CLIP_TOLERANCE : last;
    last = steps[k] == 0 && weights[k] < 0 ? -1.0f : last;
  }
  return first > last ? (int2)(1, 0) : (int2)((int)ceil(first), (int)floor(last));
}

// Resamples the samples of a tetrahedron among candidates.
static OUTLINED void ResampleTetrahedron(const SamplingMesh* mesh, const Cell* cell, int t,
  const Candidates* candidates, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const EdgeFunctions f = EdgeFunctionsOf(cell, t);
  Sample s;
  s.Volume = 0;
  const long samples = candidates->High.x - candidates->Low.x + 1;
  const int clipped = samples >= MINIMUM_CLIPPED_ROW;
  long steps[4];
  float zeros[4];
  for (int k = 0; k < 4; ++k)
  {
    steps[k] = 256 * f.Normals[k].x;
    zeros[k] = clipped && steps[k] ? -1.0f / (float)steps[k] : 0.0f;
  }
  Vector voxel = candidates->Low;
  for (voxel.z = candidates->Low.z; voxel.z <= candidates->High.z; ++voxel.z)
  {
    for (voxel.y = candidates->Low.y; voxel.y <= candidates->High.y; ++voxel.y)
    {
      voxel.x = candidates->Low.x;
      long weights[4];
      Evaluate(&f, SamplePosition(voxel), weights);
      int2 row = (int2)(0, samples - 1);
      if (clipped)
      {
        row = ClipRow(weights, steps, zeros, samples);
        for (int k = 0; k < 4; ++k)
        {
          weights[k] += row.x * steps[k];
        }
      }
      for (int i = row.x; i <= row.y; ++i)
      {
        const int role = RoleOf(mesh, cell->X, cell->Y, cell->Z, t, weights, &f, cell->State, p);
        if (role != OUTSIDE)
        {
          voxel.x = candidates->Low.x + i;
          Write(mesh, cell, t, weights, f.Volume, &s, voxel, role, output, p ARRAY_ARGUMENTS);
        }
        for (int k = 0; k < 4; ++k)
        {
          weights[k] += steps[k];
        }
      }
    }
  }
}

// Resamples any cell, one tetrahedron after the other. The lowest one comes last, because the last write wins.
static OUTLINED void ResampleTetrahedra(const SamplingMesh* mesh, const Cell* cell,
  const Candidates* all, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const int parts = CountParts(cell);
  for (int t = 4; t >= 0; --t)
  {
    for (int i = 0; i < parts; ++i)
    {
      const Cell* const part = PartOf(cell, i);
      if (!(part->Tetrahedra >> t & 1))
      {
        continue;
      }
      const Vector a = part->Vertices[Tetrahedra[t][0]];
      const Vector b = part->Vertices[Tetrahedra[t][1]];
      const Vector c = part->Vertices[Tetrahedra[t][2]];
      const Vector d = part->Vertices[Tetrahedra[t][3]];
      const Candidates candidates = FindCandidates(
        Minimum(Minimum(a, b), Minimum(c, d)), Maximum(Maximum(a, b), Maximum(c, d)), 0, all);
      if (!IsEmpty(candidates))
      {
        ResampleTetrahedron(mesh, part, t, &candidates, output, p ARRAY_ARGUMENTS);
      }
    }
  }
}

// Whether candidates lie in a patch of the output with unsettled voxels.
static int AreUnsettled(Candidates c, const Output* output, const KernelParameters* p)
{
  if (IsEmpty(c))
  {
    return 0;
  }
  const int first[3] = { c.Low.x - p->OutputFirst[0], c.Low.y - p->OutputFirst[1],
    c.Low.z - p->OutputFirst[2] };
  const int last[3] = { c.High.x - p->OutputFirst[0], c.High.y - p->OutputFirst[1],
    c.High.z - p->OutputFirst[2] };
  return AnyUnsettled(output->Patches, first, last, p);
}

// For cells with more candidates than this, it is faster to resample one tetrahedron after the other.
#define MAXIMUM_ONE_BY_ONE 128

// Resamples the samples of a cell by the faster of the two methods. all: the wanted samples.
static OUTLINED void ResampleSamples(const SamplingMesh* mesh, const Cell* cell,
  const Candidates* all, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  if (cell->Tetrahedra == DEFORMVOLUME_ALL_TETRAHEDRA && cell->Inverted == 0)
  {
    // If the shift +++ decides all ties, no sample on the upper bounds is owned.
    const int open = cell->State.Interior == 255 && p->Pass == DEFORMVOLUME_PASS_DIRECT;
    const Candidates c = FindCandidates(cell->Low, cell->High, open, all);
    if (IsEmpty(c))
    {
      return;
    }
    if (CountCandidates(c) <= MAXIMUM_ONE_BY_ONE)
    {
      ResampleUprightCell(mesh, cell, c, output, p ARRAY_ARGUMENTS);
      return;
    }
  }
  ResampleTetrahedra(mesh, cell, all, output, p ARRAY_ARGUMENTS);
}

// Returns the bits of the vertices of a cell with a negative boundary distance. Loads the boundary distances of the
// cell.
static int ClippedVertices(const SamplingMesh* mesh, Cell* cell, const KernelParameters* p)
{
  if (!p->HasDistances)
  {
    return 0;
  }
  const int mirror = Mirror(cell->X, cell->Y, cell->Z, p);
  int clipped = 0;
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    const size_t i =
      VertexInChunk(cell->X + OFFSET_X(o), cell->Y + OFFSET_Y(o), cell->Z + OFFSET_Z(o), p);
    cell->Distances[v] = mesh->Distances[i];
    clipped |= (cell->Distances[v] < 0.0f) << v;
  }
  return clipped;
}

// Prepares some tetrahedra of a cell or of a view, given as bits. present: vertices that have a position. clipped:
// vertices with a negative boundary distance. Returns whether one of the tetrahedra is flat, or skipped because it is
// overstretched.
static OUTLINED int MakeTetrahedra(
  Cell* cell, int tetrahedra, int present, int clipped, int odd, Output* output)
{
  const Vector* const q = cell->Vertices;
  cell->Tetrahedra = 0;
  cell->Inverted = 0;
  cell->Clipped = 0;
  int missing = 0;
  for (int t = 0; t < 5; ++t)
  {
    const int needed = VerticesOf(t);
    if (!(tetrahedra >> t & 1) || (present & needed) != needed || (clipped & needed) == needed)
    {
      continue;
    }
    cell->Clipped |= ((clipped & needed) != 0) << t;
    const Vector a = q[Tetrahedra[t][0]];
    const Vector b = q[Tetrahedra[t][1]];
    const Vector c = q[Tetrahedra[t][2]];
    const Vector d = q[Tetrahedra[t][3]];
    if (IsOverstretched(a, b, c, d))
    {
      ++output->Overstretched;
      missing = 1;
      continue;
    }
    const long determinant = Determinant(a, b, c, d);
    const int upright = odd != (t == 4) ? determinant < 0 : determinant > 0;
    cell->Tetrahedra |= (determinant != 0) << t;
    cell->Inverted |= (!upright && determinant != 0) << t;
    missing |= determinant == 0;
  }
  return missing;
}

static void AddToBounds(Cell* cell, int present, const Vector* q)
{
  for (int v = 0; v < 8; ++v)
  {
    if (present >> v & 1)
    {
      cell->Low = Minimum(cell->Low, q[v]);
      cell->High = Maximum(cell->High, q[v]);
    }
  }
}

#if HAS_CUT
// Prepares the views of a cell: the positions of vertices for both sides. views: memory for two views. present: bits
// of vertices that have a position: of the cell (input), then of each view (output).
static __attribute__((noinline)) void BeginViews(
  const SamplingMesh* mesh, Cell* cell, Cell* views, int* present)
{
  int divided = 0;
  for (int t = 0; t < 5; ++t)
  {
    divided |= cell->Cut.Divided >> t & 1 ? VerticesOf(t) : 0;
  }
  for (int side = 0; side < 2; ++side)
  {
    present[1 + side] = 0;
    for (int v = 0; v < 8; ++v)
    {
      if (present[0] & divided & 1 << v)
      {
        views[side].Vertices[v] = ViewVertex(mesh, &cell->Cut, v, side, cell->Vertices[v]);
        present[1 + side] |= (views[side].Vertices[v].x != INT_MIN) << v;
      }
    }
    AddToBounds(cell, present[1 + side], views[side].Vertices);
  }
  cell->Views = views;
}

// Copies what the cell and its views have in common, and prepares their tetrahedra. Returns whether one of these is
// flat, or skipped because it is overstretched.
static __attribute__((noinline)) int FinishViews(
  const Cell* cell, Cell* views, const int* present, int clipped, int odd, Output* output)
{
  int missing = 0;
  for (int side = 0; side < 2; ++side)
  {
    Cell* const view = views + side;
    view->X = cell->X;
    view->Y = cell->Y;
    view->Z = cell->Z;
    view->Side = side;
    view->Cut = cell->Cut;
    view->Whole = cell;
    view->State = cell->State;
    for (int v = 0; v < 8; ++v)
    {
      view->Distances[v] = cell->Distances[v];
    }
    missing |= MakeTetrahedra(view, cell->Cut.Divided, present[1 + side], clipped, odd, output);
  }
  return missing;
}
#endif

// Prepares a cell for resampling, and counts it. views: memory for two views, if the cell may be divided. Returns
// whether the cell may have samples.
static OUTLINED int MakeCell(const SamplingMesh* mesh, int x, int y, int z, const Candidates* all,
  Cell* cell, Cell* views, Output* output, const KernelParameters* p)
{
  const int active = ActiveTetrahedra(mesh, x, y, z, p);
  const int found = active ? LoadCell(mesh, x, y, z, p, cell->Vertices) : 0;
  if (found == 0)
  {
    return 0;
  }
  const Vector none = { LONG_MAX, LONG_MAX, LONG_MAX };
  cell->Low = none;
  cell->High.x = cell->High.y = cell->High.z = LONG_MIN;
  AddToBounds(cell, found, cell->Vertices);
  int whole = active;
#if HAS_CUT
  int present[3] = { found };
  LoadCut(mesh, x, y, z, active, p, &cell->Cut);
  cell->Side = -1;
  cell->Whole = cell;
  if (cell->Cut.Divided)
  {
    BeginViews(mesh, cell, views, present);
    whole &= ~cell->Cut.Divided;
  }
#endif
  if (DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass) &&
    !AreUnsettled(FindCandidates(cell->Low, cell->High, 0, all), output, p))
  {
    return 0;
  }
  const int mirror = Mirror(x, y, z, p);
  // The expected orientation, from the parity of the cell.
  const int odd = IsTurned(x, y, z, p);
  cell->X = x;
  cell->Y = y;
  cell->Z = z;
  cell->State = CellStateOf(mesh, x, y, z, p);
  const int clipped = ClippedVertices(mesh, cell, p);
  int missing = MakeTetrahedra(cell, whole, found, clipped, odd, output);
  int inverted = cell->Inverted;
#if HAS_CUT
  if (cell->Cut.Divided)
  {
    missing |= FinishViews(cell, views, present, clipped, odd, output);
    inverted |= views[0].Inverted | views[1].Inverted;
  }
#endif
  output->Inverted += popcount(inverted);
  output->Missing += missing && cell->State.Interior != 255;
  output->Assumed |= (cell->State.Regular & ~cell->State.Interior) != 0;
  return 1;
}

// The division of a box into pieces of at most DEFORMVOLUME_PIECE samples, or of one row. Each piece has a number of
// rows in a number of planes.
typedef struct
{
  int Rows;
  int Planes;
  int InPlane; // number of pieces in a plane
  int Count;
} Pieces;

static Pieces DivideBox(Candidates c)
{
  const long width = c.High.x - c.Low.x + 1;
  const long height = c.High.y - c.Low.y + 1;
  const long depth = c.High.z - c.Low.z + 1;
  Pieces pieces;
  pieces.Rows = clamp(DEFORMVOLUME_PIECE / width, 1L, height);
  pieces.Planes =
    pieces.Rows < height ? 1 : clamp(DEFORMVOLUME_PIECE / (width * height), 1L, depth);
  pieces.InPlane = (height + pieces.Rows - 1) / pieces.Rows;
  pieces.Count = pieces.InPlane * ((depth + pieces.Planes - 1) / pieces.Planes);
  return pieces;
}

static Candidates PieceOf(Candidates c, int piece)
{
  const Pieces pieces = DivideBox(c);
  c.Low.y += piece % pieces.InPlane * pieces.Rows;
  c.High.y = min(c.High.y, c.Low.y + pieces.Rows - 1);
  c.Low.z += piece / pieces.InPlane * pieces.Planes;
  c.High.z = min(c.High.z, c.Low.z + pieces.Planes - 1);
  return c;
}

// Smaller boxes, in 1/256 voxel, have at most as many samples as a piece: 40 * 40 * 40.
#define MINIMUM_LARGE_SIZE (39 * 256)

// Whether the cell is large and was added to the list of large cells.
static int IsDeferred(
  const Cell* cell, const Candidates* all, Output* output, const KernelParameters* p)
{
  const Vector size = Subtract(cell->High, cell->Low);
  if (max(size.x, max(size.y, size.z)) < MINIMUM_LARGE_SIZE)
  {
    return 0;
  }
  const Candidates box = FindCandidates(cell->Low, cell->High, 0, all);
  if (IsEmpty(box) || CountCandidates(box) <= DEFORMVOLUME_PIECE)
  {
    return 0;
  }
  const uint index = atomic_inc(output->LargeCells);
  if (index >= p->MostLargeCells)
  {
    return 0;
  }
  const int4 large = { cell->X, cell->Y, cell->Z, DivideBox(box).Count };
  ((__global int4*)output->LargeCells)[1 + index] = large;
  output->Large++;
  return 1;
}

// Resamples one cell. all: the wanted samples.
static OUTLINED void ResampleCell(const SamplingMesh* mesh, int x, int y, int z,
  const Candidates* all, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  Cell cell, views[2];
  if (MakeCell(mesh, x, y, z, all, &cell, views, output, p) && !IsDeferred(&cell, all, output, p))
  {
    ResampleSamples(mesh, &cell, all, output, p ARRAY_ARGUMENTS);
  }
}

// Adds counts to the counters of a section of a brick.
static void AddCounts(
  const Output* output, size_t section, __global uint* counters, const KernelParameters* p)
{
  const uint counts[DEFORMVOLUME_COUNTERS] = COUNTS_OF(output);
  for (int i = 0; i < DEFORMVOLUME_COUNTERS; ++i)
  {
    AddCount(i, counts[i], section, counters, p);
  }
}

#if HAS_CELL_KERNEL
#define CUBOIDS_X (DEFORMVOLUME_BRICK_X / DEFORMVOLUME_CUBOID_X)
#define SPANS_OF_CUBOID (DEFORMVOLUME_CUBOID_X / DEFORMVOLUME_SPAN)

// Whether a cuboid with this first cell has cells of the launch.
static int HasCells(int3 first, const KernelParameters* p)
{
  return first.x + DEFORMVOLUME_CUBOID_X > 0 && first.x < p->Size[0] - 1 &&
    first.y + DEFORMVOLUME_CUBOID_Y > 0 && first.y < p->Size[1] - 1 &&
    first.z + DEFORMVOLUME_CUBOID_Z > p->LayersBegin && first.z < p->LayersEnd;
}

// Resamples the bricks of a list from p.ListBegin to p.ListEnd (DEFORMVOLUME_BRICK_BITS). A work-group handles a
// cuboid of cells of a brick, span by span, as counters are those of sections. Groups on x are those of all bricks.
// positions: memory for three ints per vertex of the cuboid.
__kernel void Resample(GIVEN_PARAMETERS, __global const uint* bricks, __local int* positions,
  const KernelParameters p ARRAY_PARAMETERS)
{
  const int index = p.ListBegin + (int)(get_group_id(0) / CUBOIDS_X);
  const uint brick = index < p.ListEnd ? bricks[index] : 0; // 0: a brick without sections
  const int3 first = FirstOfBrick(brick, &p) +
    (int3)((int)get_group_id(0) % CUBOIDS_X * DEFORMVOLUME_CUBOID_X,
      (int)get_group_id(1) * DEFORMVOLUME_CUBOID_Y, (int)get_group_id(2) * DEFORMVOLUME_CUBOID_Z);
  // The section of the first span; the next spans follow.
  const size_t section = SectionOf(first.x, first.y, first.z, &p);
  int spans = 0; // bits of the spans that are resampled
  for (int span = 0; span < SPANS_OF_CUBOID && HasCells(first, &p); ++span)
  {
    spans |= IsSectionResampled(brick, section + span) << span;
  }
  const SamplingMesh unmapped = GIVEN_MESH;
  const int width = DEFORMVOLUME_CUBOID_X + 1;
  const int height = DEFORMVOLUME_CUBOID_Y + 1;
  const int vertices = spans ? DEFORMVOLUME_CUBOID_VERTICES : 0;
  for (int i = get_local_id(0); i < vertices; i += get_local_size(0))
  {
    const int x = first.x + i % width;
    const int y = first.y + i / width % height;
    const int z = first.z + i / (width * height);
    // Samples at the border of the sampling mesh also depend on cells before the first and after the last layer of the
    // launch.
    const int4 q = x >= 0 && y >= 0 && z >= max(p.LayersBegin - 1, 0) && x < p.Size[0] &&
        y < p.Size[1] && z < p.Size[2] && z <= p.LayersEnd + 1
      ? VertexPosition(&unmapped, x, y, z, &p)
      : (int4)(INT_MIN, 0, 0, 0);
    positions[3 * i] = q.x;
    positions[3 * i + 1] = q.y;
    positions[3 * i + 2] = q.z;
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  SamplingMesh mesh = unmapped;
  mesh.Cuboid = positions;
  mesh.CuboidFirst[0] = first.x;
  mesh.CuboidFirst[1] = first.y;
  mesh.CuboidFirst[2] = first.z;
  const Candidates all = AllCandidates(&p);
  for (int span = 0; span < SPANS_OF_CUBOID; ++span)
  {
    const int cells = spans >> span & 1
      ? DEFORMVOLUME_SPAN * DEFORMVOLUME_CUBOID_Y * DEFORMVOLUME_CUBOID_Z
      : 0;
    Output output = GIVEN_OUTPUT;
    for (int i = get_local_id(0); i < cells; i += get_local_size(0))
    {
      const int x = first.x + span * DEFORMVOLUME_SPAN + i % DEFORMVOLUME_SPAN;
      const int y = first.y + i / DEFORMVOLUME_SPAN % DEFORMVOLUME_CUBOID_Y;
      const int z = first.z + i / (DEFORMVOLUME_SPAN * DEFORMVOLUME_CUBOID_Y);
      if (x >= 0 && y >= 0 && z >= p.LayersBegin && x < p.Size[0] - 1 && y < p.Size[1] - 1 &&
        z < p.LayersEnd)
      {
        ResampleCell(&mesh, x, y, z, &all, &output, &p ARRAY_ARGUMENTS);
      }
    }
    AddCounts(&output, section + span, counters, &p);
  }
}
#endif
