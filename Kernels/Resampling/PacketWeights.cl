// SPDX-License-Identifier: BSD-3-Clause
// Computes, in floats, the weights of a cell's vertices at a sample, for a packet of cells, and finds which samples
// these weights decide (PacketResampling.cl).
//
// Method. The central tetrahedron has the vertices 0, 3, 5, 6 of the cell; l0, l3, l5, l6 are a sample's barycentric
// coordinates in it. Each corner tetrahedron replaces one of these vertices by vertex 1 (for 6), 2 (for 5), 4 (for 3)
// or 7 (for 0). In a cell that is not too bent, a sample has at most one negative coordinate li, and lies behind the
// face opposite vertex i. In the corner tetrahedron, the corner vertex then has the weight u = li / bi, where bi < 0 is
// the corner vertex's own coordinate, and the other vertices have tj = lj - u bj. For samples of the central
// tetrahedron u = 0 and tj = lj. So u = min(li, 0) / bi for each corner, tj = max(lj, 0) - sum of u bj are the weights
// of all eight vertices without a branch, and the sample is in the cell if no tj is negative. All coordinates, and so
// the tj, are left multiplied by the determinant D of the central tetrahedron, to avoid waiting for a division by D. If
// D is negative, the normals are reversed.
//
// Exactness. Positions are exact in float (cells under 8 voxels, steps of 1/256), and so are the normals. Let e =
// 2^-24, and let k >= D be the cell's extent times the largest 1-norm of the normals. The three roundings of l3, l5,
// l6, of D and of the corresponding bj are at most 3 e k. The errors of l0 = (D - l3) - (l5 + l6) and of the bj with
// j = 0 are at most (4 * 3 + 2 + 2 + 4) e k. Let M = max |bj / bi|. For u <= 1, the error of tj has these parts: the
// errors of lj and bj; M times the errors of li and bi; 7 M e k, as u has six roundings that count and divisions may
// have an error of more than one unit; and three roundings of its own. The sum is at most (9 + 47 M) e k, for i = 0.
// Up to two more li may be negative only by their error, which adds M times that error, 6 M e k. The total is (9 + 53
// M) e k. (For u > 1 the tj add up to D (1 - u), and the least tj is clearly negative as long as d < D / 3, which
// holds by far in cells that are not too flat.) With bj >= 1/64 and bi <= -1/8, M <= (1 - bi) / -bi = 9. With bj >=
// 0.35 and bi <= -0.42, as in cells that are hardly bent, M <= (0.3 - bi) / -bi < 1.72. So d = 3.2e-5 k or 6.5e-6 k,
// which includes a reserve of 5 %. The 1-norm is at most the sum of the areas of the box's three faces, as each
// component of a normal is twice the area of a triangle in such a face. If three of the tj exceed d, the sample is
// inside. If one is below -d, it is outside. Floats do not decide samples in between.
//
// In cells over 8 voxels, normals have rounding errors as well: one of a product, at most the size of a face of the
// box, and one of the difference. This adds 2 e k to each product with a normal: 5 e k instead of 3, 28 e k instead
// of 20, and (13 + 73 M) e k instead of (9 + 53 M). So d grows by a third (INEXACT_NORMALS).

// Flatter cells are not decided by floats. For other cells d / D, the largest error of weights, is 1.5e-3 or 7.4e-3.
#define MAXIMUM_BOUND_SCALE 4.35e-3f

// The central tetrahedra of a packet's cells.
typedef struct
{
  // Vertex 0, to which samples are relative, and the opposite vertex.
  FLOATS X0, Y0, Z0, X7, Y7, Z7;
  // Normals: the gradients of l3, l5 and l6, oriented inwards.
  FLOATS N3x, N3y, N3z, N5x, N5y, N5z, N6x, N6y, N6z;
  FLOATS Determinant;
  // Coordinates of the corner vertices: Bcj is bj of vertex c.
  FLOATS B13, B15, B16, B10, B23, B25, B26, B20, B43, B45, B46, B40, B73, B75, B76, B70;
  FLOATS Bound;  // d: the largest error of the weights
  INTS Inverted; // mirrored cells, all of whose tetrahedra are inverted
  uint InvertedBits; // Inverted as bits, only for simple cells
  uint Decidable;    // bits of cells whose samples floats can decide
} PacketFrame;

// Finds a packet's normals and determinants, as if no cell were inverted.
static __attribute__((always_inline)) void FindNormals(const PacketCandidates* c, PacketFrame* f)
{
  const Packet* const packet = &c->Cells;
  LOAD_VERTEX(0)
  LOAD_VERTEX(3)
  LOAD_VERTEX(5)
  LOAD_VERTEX(6)
  f->X0 = X0;
  f->Y0 = Y0;
  f->Z0 = Z0;
#define EDGE(a, v) const FLOATS a##x = X##v - X0, a##y = Y##v - Y0, a##z = Z##v - Z0;
  EDGE(e3, 3)
  EDGE(e5, 5)
  EDGE(e6, 6)
#define NORMAL(n, a, b)                                                                            \
  f->n##x = fma(a##y, b##z, -(a##z * b##y));                                                       \
  f->n##y = fma(a##z, b##x, -(a##x * b##z));                                                       \
  f->n##z = fma(a##x, b##y, -(a##y * b##x));
#if LANES > 1
  const int turned = packet->Parity;
#else
  // Every second work-item has an odd cell, and a branch would be divergent. Changing the sign is exact if the
  // normals are exact.
  const int turned = packet->Parity && c->Extent > EXACT_NORMALS_EXTENT;
#endif
  if (turned)
  {
    NORMAL(N3, e6, e5)
    NORMAL(N5, e3, e6)
    NORMAL(N6, e5, e3)
  }
  else
  {
    NORMAL(N3, e5, e6)
    NORMAL(N5, e6, e3)
    NORMAL(N6, e3, e5)
#if LANES == 1
    const float sign = packet->Parity ? -1.0f : 1.0f;
#define SIGN(v) f->v *= sign;
    SIGN(N3x) SIGN(N3y) SIGN(N3z) SIGN(N5x) SIGN(N5y) SIGN(N5z) SIGN(N6x) SIGN(N6y) SIGN(N6z)
#endif
  }
  f->Determinant = fma(e3z, f->N3z, fma(e3y, f->N3y, e3x * f->N3x));
}

// Barycentric coordinates do not distinguish a cell from its mirror image, whose tetrahedra are all inverted: reverse
// the normals of mirrored cells. simple: the cells to consider; lanes without a cell contain arbitrary values.
static __attribute__((always_inline)) void ReverseInverted(uint simple, PacketFrame* f)
{
  f->Inverted = 0;
  f->InvertedBits = LaneBits(f->Determinant < 0.0f) & simple;
  if (f->InvertedBits)
  {
    const INTS inverted = f->Determinant < 0.0f;
    f->Inverted = inverted;
#define REVERSE(v) f->v = inverted ? -f->v : f->v;
    REVERSE(N3x) REVERSE(N3y) REVERSE(N3z) REVERSE(N5x) REVERSE(N5y) REVERSE(N5z) REVERSE(N6x) REVERSE(N6y) REVERSE(N6z)
    REVERSE(Determinant)
  }
}

// Finds the coordinates of the corner vertices.
static __attribute__((always_inline)) void FindCoordinates(const Packet* packet, PacketFrame* f)
{
  LOAD_VERTEX(1)
  LOAD_VERTEX(2)
  LOAD_VERTEX(4)
  LOAD_VERTEX(7)
  f->X7 = X7;
  f->Y7 = Y7;
  f->Z7 = Z7;
#define COORDINATES(c)                                                                             \
  {                                                                                                \
    const FLOATS rx = X##c - f->X0;                                                                \
    const FLOATS ry = Y##c - f->Y0;                                                                \
    const FLOATS rz = Z##c - f->Z0;                                                                \
    f->B##c##3 = fma(rx, f->N3x, fma(ry, f->N3y, rz * f->N3z));                                    \
    f->B##c##5 = fma(rx, f->N5x, fma(ry, f->N5y, rz * f->N5z));                                    \
    f->B##c##6 = fma(rx, f->N6x, fma(ry, f->N6y, rz * f->N6z));                                    \
    f->B##c##0 = (f->Determinant - f->B##c##3) - (f->B##c##5 + f->B##c##6);                        \
  }
  COORDINATES(1)
  COORDINATES(2)
  COORDINATES(4)
  COORDINATES(7)
}

// Finds the error bounds, and the simple cells that are not too bent for these bounds.
static __attribute__((always_inline)) void BoundErrors(
  const PacketCandidates* c, uint simple, PacketFrame* f)
{
  const FLOATS leastOther = Min(Min(Min(Min(f->B13, f->B15), Min(f->B10, f->B45)),
                                    Min(Min(f->B46, f->B40), Min(f->B23, f->B26))),
    Min(Min(f->B20, f->B73), Min(f->B75, f->B76)));
  const FLOATS mostOwn = Max(Max(f->B16, f->B43), Max(f->B25, f->B70));
  const FLOATS minimumOwn = Min(Min(f->B16, f->B43), Min(f->B25, f->B70));
  const INTS tame =
    (mostOwn <= f->Determinant * -0.42f) & (leastOther >= f->Determinant * 0.35f);
  f->Bound = (tame ? (FLOATS)(6.5e-6f) : (FLOATS)(3.2e-5f)) * c->BoundScale;
  f->Decidable = simple &
    LaneBits((leastOther >= f->Determinant * 0.015625f) & (mostOwn <= f->Determinant * -0.125f) &
      (minimumOwn >= f->Determinant * -2.0f) & (c->BoundScale * MAXIMUM_BOUND_SCALE < f->Determinant));
}

// simple: bits of the cells that are small and complete.
static __attribute__((always_inline)) void MakePacketFrame(
  const PacketCandidates* c, uint simple, PacketFrame* frame)
{
  FindNormals(c, frame);
  ReverseInverted(simple, frame);
  FindCoordinates(&c->Cells, frame);
  BoundErrors(c, simple, frame);
}

// The factors that turn coordinates into weights.
typedef struct
{
  FLOATS Corner1, Corner2, Corner4, Corner7; // 1 / bi of each corner
  FLOATS Central;                            // 1 / D
} PacketScales;

static __attribute__((always_inline)) void FindScales(const PacketFrame* f, PacketScales* scales)
{
  scales->Central = INVERSE(f->Determinant);
  // One division for all four inverses.
  const FLOATS product12 = f->B16 * f->B25, product47 = f->B43 * f->B70;
  const FLOATS inverses = INVERSE(product12 * product47);
  const FLOATS inverse12 = inverses * product47, inverse47 = inverses * product12;
  scales->Corner1 = inverse12 * f->B25;
  scales->Corner2 = inverse12 * f->B16;
  scales->Corner4 = inverse47 * f->B70;
  scales->Corner7 = inverse47 * f->B43;
}

// Finds the weights at samples. rx, ry, rz: the samples relative to vertex 0.
static __attribute__((always_inline)) void WeighSamples(const PacketFrame* f,
  const PacketScales* scales, FLOATS rx, FLOATS ry, FLOATS rz, SampleWeights* w)
{
  const FLOATS l3 = fma(rx, f->N3x, fma(ry, f->N3y, rz * f->N3z));
  const FLOATS l5 = fma(rx, f->N5x, fma(ry, f->N5y, rz * f->N5z));
  const FLOATS l6 = fma(rx, f->N6x, fma(ry, f->N6y, rz * f->N6z));
  const FLOATS l0 = (f->Determinant - l3) - (l5 + l6);
  const FLOATS u1 = Min(l6, 0.0f) * scales->Corner1;
  const FLOATS u2 = Min(l5, 0.0f) * scales->Corner2;
  const FLOATS u4 = Min(l3, 0.0f) * scales->Corner4;
  const FLOATS u7 = Min(l0, 0.0f) * scales->Corner7;
  w->T3 = fma(-u7, f->B73, fma(-u2, f->B23, fma(-u1, f->B13, Max(l3, 0.0f))));
  w->T5 = fma(-u7, f->B75, fma(-u4, f->B45, fma(-u1, f->B15, Max(l5, 0.0f))));
  w->T6 = fma(-u7, f->B76, fma(-u2, f->B26, fma(-u4, f->B46, Max(l6, 0.0f))));
  w->T0 = fma(-u2, f->B20, fma(-u4, f->B40, fma(-u1, f->B10, Max(l0, 0.0f))));
  w->U1 = u1;
  w->U2 = u2;
  w->U4 = u4;
  w->U7 = u7;
  w->Scale = scales->Central;
}

// Returns which of the given cells, as bits, hold their sample. A cell holds the sample if three weights exceed
// `threshold`, and does not if one is below -bound. undecidedByFloats: the cells in between.
static __attribute__((always_inline)) uint DecideByFloats(
  const SampleWeights* w, uint cells, FLOATS threshold, FLOATS bound, uint* undecidedByFloats)
{
  const FLOATS lowA = Min(w->T3, w->T5), highA = Max(w->T3, w->T5);
  const FLOATS lowB = Min(w->T6, w->T0), highB = Max(w->T6, w->T0);
  const uint maybe = LaneBits(Min(lowA, lowB) >= -bound) & cells;
  // The second smallest weight decides: the weight opposite the corner may be 0.
  const FLOATS second = Min(Max(lowA, lowB), Min(highA, highB));
  const uint held = maybe & LaneBits(second > threshold);
  *undecidedByFloats = maybe & ~held;
  return held;
}

// At a vertex, the sample takes the value of the vertex bit for bit: sets the weights, which may have rounding
// errors, to 0 and 1. Other lanes keep their bits, whatever their neighbors are.
static __attribute__((always_inline)) void SnapWeights(
  INTS onVertex, const PacketFrame* f, SampleWeights* w)
{
  const FLOATS middle = f->Determinant * 0.5f;
#define SNAP(weight, least)                                                                        \
  w->weight = onVertex ? (w->weight > (least) ? (FLOATS)(1.0f) : (FLOATS)(0.0f)) : w->weight;
  SNAP(T0, middle) SNAP(T3, middle) SNAP(T5, middle) SNAP(T6, middle)
  SNAP(U1, 0.5f) SNAP(U2, 0.5f) SNAP(U4, 0.5f) SNAP(U7, 0.5f)
  w->Scale = onVertex ? (FLOATS)(1.0f) : w->Scale;
}
