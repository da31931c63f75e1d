// SPDX-License-Identifier: BSD-3-Clause
// The samples that a group of cells holds, with their values (BrickResampling.cl): by floats where the sign of a
// coordinate is certain, by integers where it is not.
//
// The method. The central tetrahedron has the vertices 0, 3, 5, 6 of the cell; l0, l3, l5, l6 are a
// sample's barycentric coordinates in it. The corner tetrahedra replace one of them by the vertex
// 1 (for 6), 2 (for 5), 4 (for 3) or 7 (for 0). In a cell that is not too bent a sample has at most
// one negative coordinate li, and lies behind that face: in the corner's coordinates the corner
// vertex c has the weight u = li / bi, where bi < 0 is the corner's own coordinate, and the others
// have tj = lj - u bj. For samples of the central tetrahedron u is 0 and tj = lj. So
//   u = min(li, 0) / bi for each corner,  tj = max(lj, 0) - sum of u bj
// are the weights of all eight vertices without a branch, and the sample is in the cell where
// no tj is negative. All coordinates of cells and of samples are left multiplied by the determinant D of the
// central tetrahedron, and so are the tj, so that nothing waits for a division by it; where D is negative, the
// normals are turned.
//
// The fill rule stays exact. Positions are exact in float (cells under 8 voxels, steps of 1/256), and so are the
// normals. Let e = 2^-24, and k >= D the cell's extent times the largest 1-norm of the normals. The three
// roundings of l3, l5, l6, of D and of the like bj are at most 3 e k, and the errors of l0 = (D - l3) - (l5 +
// l6) and of the bj with j = 0 at most (4 * 3 + 2 + 2 + 4) e k. With M = max |bj / bi|, and where u is not over
// 1, tj is off by the errors of lj and bj, M times those of li and bi, 7 M e k as u has six roundings that count
// and divisions may be off by more than one, and three roundings of its own: at most (9 + 47 M) e k, when i is
// 0. Up to two more li that are negative only by their error add M times that, 6 M e k, which makes (9 + 53 M) e
// k. (Where u is over 1 the tj add up to D (1 - u), and the least of them is clearly negative as long as d < D /
// 3, which cells that are not too flat keep by far.) As the bj are at least 1/64 and bi is at most -1/8, M is at
// most (1 - bi) / -bi = 9; where the bj are at least 0.35 and bi is at most -0.42, as in cells that are hardly
// bent, M is at most (0.3 - bi) / -bi < 1.72. So d = 3.2e-5 k, or 6.5e-6 k, which is more by 5 %. The 1-norm is
// at most the sum of the areas of the box's three faces, as each component of a normal is twice the area of a
// triangle in such a face. When three of the tj exceed d, the sample is inside; when one is under -d, outside.
// Cells with a sample in between are repeated: with edge functions in integers, LANES cells at once again; where
// they are bent, or what surrounds them is not all there, by ResampleCell. Of cells that are too large for integers
// of 32 bits only these samples are left to it: they have many samples, and hardly one of them is in between.
//
// In cells over 8 voxels the normals have rounding errors, too: of a product, at most as large as the face of the
// box, and of the difference. That adds 2 e k to each product with a normal, 5 e k instead of 3, and makes the
// above 28 e k instead of 20, (13 + 73 M) e k instead of (9 + 53 M), and d more by a third (INEXACT_NORMALS).

// Cells that are flatter are left out: d / D, which weights are off by at most, is 1.5e-3 or 7.4e-3 in others.
#define MOST_REACH 4.35e-3f

// Barycentric coordinates of vertex c relative to the central tetrahedron.
#define COORDINATES(c)                                                                             \
  FLOATS b##c##3, b##c##5, b##c##6, b##c##0;                                                       \
  {                                                                                                \
    const FLOATS rx = X##c - X0;                                                                   \
    const FLOATS ry = Y##c - Y0;                                                                   \
    const FLOATS rz = Z##c - Z0;                                                                   \
    b##c##3 = fma(rx, n3x, fma(ry, n3y, rz * n3z));                                                \
    b##c##5 = fma(rx, n5x, fma(ry, n5y, rz * n5z));                                                \
    b##c##6 = fma(rx, n6x, fma(ry, n6y, rz * n6z));                                                \
    b##c##0 = (determinant - b##c##3) - (b##c##5 + b##c##6);                                       \
  }

// What became of LANES cells, as bits.
typedef struct
{
  uint Ambiguous; // repeat them with integers
  uint Unsure;    // leave them to ResampleCell
  uint Doubtful;  // leave some samples of theirs to it
} Outcome;

// The samples that floats have not decided: of each round that had some its number, and in the lower 16 bits the
// cells.
typedef struct
{
  uint Rounds[MAXIMUM_CANDIDATES];
  uint Count;
} Doubts;

// The samples of a group of cells. state: where the group is on the border, if samples that floats do not decide
// are to be decided by integers: those of the cells in only, as bits. Else null, and doubts takes these samples.
// What cells that must be repeated have written is not counted.
static __attribute__((always_inline)) void ResampleGroup(
  const GroupCandidates* c, uint only, const GroupState* state, Output* output, Found* found,
  Doubts* doubts, Outcome* outcome, const KernelParameters* p ARRAY_PARAMETERS)
{
  const Group* const group = &c->Cells;
  LOAD_VERTICES
  const int x = group->X, y = group->Y, z = group->Z;
  const int exact = state != 0;
  const INTS cellX = x + 2 * LANE_INDEX;
  const int mirror = Mirror(x, y, z, p);
  const uint there = exact ? c->There & only : c->There;
  const uint fit = c->Fit & there;

  // Normals: the gradients of l3, l5 and l6. They point inside.
#define EDGE(a, v) const FLOATS a##x = X##v - X0, a##y = Y##v - Y0, a##z = Z##v - Z0;
  EDGE(e3, 3)
  EDGE(e5, 5)
  EDGE(e6, 6)
#define NORMAL(n, a, b)                                                                            \
  n##x = fma(a##y, b##z, -(a##z * b##y));                                                          \
  n##y = fma(a##z, b##x, -(a##x * b##z));                                                          \
  n##z = fma(a##x, b##y, -(a##y * b##x));
  FLOATS n3x, n3y, n3z, n5x, n5y, n5z, n6x, n6y, n6z;
  if (group->Odd)
  {
    NORMAL(n3, e6, e5)
    NORMAL(n5, e3, e6)
    NORMAL(n6, e5, e3)
  }
  else
  {
    NORMAL(n3, e5, e6)
    NORMAL(n5, e6, e3)
    NORMAL(n6, e3, e5)
  }
  FLOATS determinant = fma(e3z, n3z, fma(e3y, n3y, e3x * n3x));
  // Coordinates do not tell a cell from its mirror image: all its tetrahedra are inverted then.
  INTS inverted = 0;
  const uint turned = LaneBits(determinant < 0.0f) & fit;
  if (turned)
  {
    inverted = determinant < 0.0f;
#define TURN(v) v = inverted ? -v : v;
    TURN(n3x) TURN(n3y) TURN(n3z) TURN(n5x) TURN(n5y) TURN(n5z) TURN(n6x) TURN(n6y) TURN(n6z)
    TURN(determinant)
  }
  COORDINATES(1)
  COORDINATES(2)
  COORDINATES(4)
  COORDINATES(7)
  const FLOATS leastOther =
    Least(Least(Least(Least(b13, b15), Least(b10, b45)), Least(Least(b46, b40), Least(b23, b26))),
      Least(Least(b20, b73), Least(b75, b76)));
  const FLOATS mostOwn = Most(Most(b16, b43), Most(b25, b70));
  const FLOATS leastOwn = Least(Least(b16, b43), Least(b25, b70));
  const INTS tame = (mostOwn <= determinant * -0.42f) & (leastOther >= determinant * 0.35f);
  const FLOATS bound = (tame ? (FLOATS)(6.5e-6f) : (FLOATS)(3.2e-5f)) * c->Reach;
  const uint nice = fit &
    LaneBits((leastOther >= determinant * 0.015625f) & (mostOwn <= determinant * -0.125f) &
      (leastOwn >= determinant * -2.0f) & (c->Reach * MOST_REACH < determinant));
  const uint unsure = there & ~nice;
  uint ambiguous = 0;
  int rounds = 0;
  uint doubtful = 0;
  ushort hits[MAXIMUM_CANDIDATES]; // the cells that each round has found a sample in
  uint written = 0;
  uint some = c->Some & nice;
  if (some)
  {
    // Boxes take all their candidates, whatever the second smallest weight is, from which it is told that a sample
    // is inside. Where a vertex lies on a sample its value is taken bit for bit: the weights, which rounding may
    // have touched, are made 0 and 1.
    const int snap = c->HasBoxes;
    FLOATS decisive = bound;
    INTS box = 0;
    if (snap)
    {
      box = LanesOf(nice) & c->Box;
      decisive = box ? (FLOATS)(-INFINITY) : bound;
    }
    const FLOATS inverse = 1.0f / determinant;
    const INTS countX = c->Count[0];
    const INTS countY = c->Count[1];
    // One division for four.
    const FLOATS product12 = b16 * b25, product47 = b43 * b70;
    const FLOATS inverses = 1.0f / (product12 * product47);
    const FLOATS inverse12 = inverses * product47, inverse47 = inverses * product12;
    const FLOATS s1 = inverse12 * b25, s2 = inverse12 * b16;
    const FLOATS s4 = inverse47 * b70, s7 = inverse47 * b43;
    const FLOATS startX = TO_FLOATS(c->First[0]) - X0;
    const FLOATS startY = TO_FLOATS(c->First[1]) - Y0;
    const FLOATS startZ = TO_FLOATS(c->First[2]) - Z0;
    const FLOATS endX = startX + (TO_FLOATS(countX) - 0.5f);
    const FLOATS endY = startY + (TO_FLOATS(countY) - 0.5f);
    const INTS toNextRow = p->OutputSize[0] - countX;
    const INTS toNextPlane = (p->OutputSize[1] - countY) * p->OutputSize[0];
    INTS place = c->Place;
    FLOATS rx = startX;
    FLOATS ry = startY;
    FLOATS rz = startZ;
    uint kept = found->Count;
    for (;;)
    {
      const FLOATS l3 = fma(rx, n3x, fma(ry, n3y, rz * n3z));
      const FLOATS l5 = fma(rx, n5x, fma(ry, n5y, rz * n5z));
      const FLOATS l6 = fma(rx, n6x, fma(ry, n6y, rz * n6z));
      const FLOATS l0 = (determinant - l3) - (l5 + l6);
      FLOATS u1 = Least(l6, 0.0f) * s1;
      FLOATS u2 = Least(l5, 0.0f) * s2;
      FLOATS u4 = Least(l3, 0.0f) * s4;
      FLOATS u7 = Least(l0, 0.0f) * s7;
      FLOATS t3 = fma(-u7, b73, fma(-u2, b23, fma(-u1, b13, Most(l3, 0.0f))));
      FLOATS t5 = fma(-u7, b75, fma(-u4, b45, fma(-u1, b15, Most(l5, 0.0f))));
      FLOATS t6 = fma(-u7, b76, fma(-u2, b26, fma(-u4, b46, Most(l6, 0.0f))));
      FLOATS t0 = fma(-u2, b20, fma(-u4, b40, fma(-u1, b10, Most(l0, 0.0f))));
      const FLOATS lowA = Least(t3, t5), highA = Most(t3, t5);
      const FLOATS lowB = Least(t6, t0), highB = Most(t6, t0);
      const uint maybe = LaneBits(Least(lowA, lowB) >= -bound) & some;
      // The second smallest weight decides: that opposite the corner may be 0.
      const FLOATS second = Least(Most(lowA, lowB), Least(highA, highB));
      uint bits = maybe & LaneBits(second > decisive); // the cells that hold their candidate
      INTS onVertex = 0;
      const uint undecided = maybe & ~bits;
      if (exact)
      {
        if (undecided)
        {
          const FLOATS sample[3] = { rx, ry, rz };
          INTS simplex;
          INTS held = HoldSample(group, sample, group->Odd, inverted, &simplex);
          if (group->Border)
          {
            // As RoleOf.
            const INTS outer = (simplex != 0) & ((simplex & state->Interior) == 0);
            const INTS regular = (simplex & ~state->Regular) == 0;
            const INTS first = (((simplex & LOW_SIDE(0, mirror)) != 0) | (cellX == p->Size[0] - 2)) &
              (((simplex & LOW_SIDE(1, mirror)) != 0) | (INTS)(z == p->Size[2] - 2 ? -1 : 0)) &
              (((simplex & LOW_SIDE(2, mirror)) != 0) | (INTS)(y == p->Size[1] - 2 ? -1 : 0));
            held = outer ? first & regular : held;
            ambiguous |= undecided & LaneBits(outer & ~regular);
            output->Assumed |= (undecided & LaneBits(outer)) != 0;
          }
          bits |= undecided & LaneBits(held);
          if (p->Pass == DEFORMVOLUME_PASS_OWNERS)
          {
            TouchHeld(undecided & LaneBits(~held & (simplex != 0)), rx + X0, ry + Y0, rz + Z0,
              output, p);
          }
          onVertex = LanesOf(undecided) & ((simplex & (simplex - 1)) == 0);
        }
      }
      else if (undecided)
      {
        ambiguous |= undecided;
        doubts->Rounds[doubtful++] = (uint)rounds << 16 | undecided;
      }
      if (p->IsPart)
      {
        const FLOATS sx = rx + X0, sy = ry + Y0, sz = rz + Z0;
        bits &= LaneBits((sx >= 0.0f) & (sx < (float)p->OutputSize[0]) & (sy >= 0.0f) &
          (sy < (float)p->OutputSize[1]) & (sz >= 0.0f) & (sz < (float)p->OutputSize[2]));
      }
      if (snap)
      {
        const FLOATS sx = rx + X0, sy = ry + Y0, sz = rz + Z0;
        onVertex |= box & ((sx == X0) | (sx == X7)) & ((sy == Y0) | (sy == Y7)) &
          ((sz == Z0) | (sz == Z7));
      }
      FLOATS scale = inverse;
      if (snap || exact)
      {
        // All other lanes keep their bits, whatever their neighbours are.
        const FLOATS middle = determinant * 0.5f;
#define SNAP(weight, least)                                                                        \
  weight = onVertex ? (weight > (least) ? (FLOATS)(1.0f) : (FLOATS)(0.0f)) : weight;
        SNAP(t0, middle) SNAP(t3, middle) SNAP(t5, middle) SNAP(t6, middle)
        SNAP(u1, 0.5f) SNAP(u2, 0.5f) SNAP(u4, 0.5f) SNAP(u7, 0.5f)
        scale = onVertex ? (FLOATS)(1.0f) : inverse;
      }
      if (DEFORMVOLUME_IS_WRITING(p->Pass))
      {
        LANE_ARRAYS(LANE_RESULTS)
      }
      hits[rounds] = bits;
      written += popcount(bits);
      Append(place, bits, found->Places + kept);
      if (KEEPS_KEYS && p->Pass != DEFORMVOLUME_PASS_DIRECT)
      {
        // The first cell of the row, as the first one of the group may lie before the volume.
        const INTS keys = (int)MakeKey(0, y, z, 0, p) + cellX;
        Append(keys | (inverted & (int)MakeKey(0, 0, 0, 1, p)), bits, found->Cells + kept);
      }
      else if (HAS_OTHER_ARRAYS || p->Pass != DEFORMVOLUME_PASS_DIRECT)
      {
        Append(LANE_INDEX | (inverted & INVERTED_LANE), bits, found->Cells + kept);
      }
      kept += popcount(bits);
      if (kept > FOUND_CAPACITY)
      {
        found->Count = kept;
        kept = 0;
        StoreFound(found, group, output, p ARRAY_ARGUMENTS);
      }
      some &= LaneBits(c->Number > ++rounds);
      if (!some)
      {
        break;
      }
      // The next candidate of each lane.
      rx += 1.0f;
      const INTS rowDone = rx > endX;
      rx = rowDone ? startX : rx;
      ry = rowDone ? ry + 1.0f : ry;
      const INTS planeDone = ry > endY;
      ry = planeDone ? startY : ry;
      rz = planeDone ? rz + 1.0f : rz;
      place += 1 + (rowDone & toNextRow) + (planeDone & toNextPlane);
    }
    found->Count = kept;
    if (KEEPS_GROUP(p))
    {
      StoreFound(found, group, output, p ARRAY_ARGUMENTS);
    }
  }
  outcome->Doubtful = 0;
  if (!exact && ambiguous)
  {
    doubts->Count = doubtful;
    outcome->Doubtful = ambiguous & ~LaneBits(c->Extent < MAXIMUM_EXACT_EXTENT);
    ambiguous ^= outcome->Doubtful;
  }
  output->Inverted += 5 * popcount(turned & nice & ~ambiguous);
  const uint again = unsure | ambiguous;
  if (again)
  {
    // What an undecided cell wrote so far is written again with it, and must not count twice.
    for (int i = 0; i < rounds; ++i)
    {
      written -= popcount(hits[i] & again);
    }
  }
  output->Writes += written;
  // Integers of 32 bits decide who owns a sample.
  outcome->Ambiguous = exact || DEFORMVOLUME_IS_CLOSED(p->Pass) ? 0 : ambiguous;
  outcome->Unsure = again & ~outcome->Ambiguous;
}

static __attribute__((noinline)) Outcome ResampleByFloats(
  const GroupCandidates* c, Output* output, Found* found, Doubts* doubts,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  Outcome outcome;
  ResampleGroup(c, 0, 0, output, found, doubts, &outcome, p ARRAY_ARGUMENTS);
  return outcome;
}

// Returns the cells that are left to ResampleCell.
static __attribute__((noinline)) uint ResampleByIntegers(
  const GroupCandidates* c, uint only, const SamplingMesh* mesh, Output* output, Found* found,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  GroupState state;
  if (c->Cells.Border)
  {
    StatesOfGroup(mesh, c->Cells.X, c->Cells.Y, c->Cells.Z, &state, p);
  }
  Outcome outcome;
  ResampleGroup(c, only, &state, output, found, 0, &outcome, p ARRAY_ARGUMENTS);
  return outcome.Unsure;
}

// The samples in doubt of some cells, as bits, from beginX to endX.
static __attribute__((noinline)) void ResampleDoubts(const GroupCandidates* c, const Doubts* doubts,
  uint cells, int beginX, int endX, const SamplingMesh* mesh, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  Lanes first[3], count[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    first[axis].Vector = c->First[axis];
    count[axis].Vector = c->Count[axis];
  }
  // It is counted already which cells are inverted.
  const uint inverted = output->Inverted;
  for (uint i = 0; i < doubts->Count; ++i)
  {
    const int round = doubts->Rounds[i] >> 16;
    uint here = doubts->Rounds[i] & cells;
    FOR_EACH_LANE(lane, here)
    {
      const int cell = c->Cells.X + 2 * lane;
      const int width = count[0].Lanes[lane], height = count[1].Lanes[lane];
      const int x = first[0].Lanes[lane] + round % width;
      const int y = first[1].Lanes[lane] + round / width % height;
      const int z = first[2].Lanes[lane] + round / (width * height);
      if (cell < beginX || cell >= endX || x < 0 || x >= p->OutputSize[0] || y < 0 ||
        y >= p->OutputSize[1] || z < 0 || z >= p->OutputSize[2])
      {
        continue;
      }
      const Vector voxel = { x + p->OutputFirst[0], y + p->OutputFirst[1], z + p->OutputFirst[2] };
      const Candidates only = { voxel, voxel };
      ResampleCell(mesh, cell, c->Cells.Y, c->Cells.Z, &only, output, p ARRAY_ARGUMENTS);
    }
  }
  output->Inverted = inverted;
}
