// SPDX-License-Identifier: BSD-3-Clause
// The walk of the lanes through the candidates of their cells (PacketCandidates.cl).

// The current candidate of each lane.
typedef struct
{
  FLOATS X, Y, Z; // the candidate, relative to vertex 0
  INTS Voxel;     // index in the output
  FLOATS StartX, StartY;
  FLOATS EndX, EndY;           // between the last candidate and the next voxel
  INTS ToNextRow, ToNextPlane; // number of output voxels to skip after a row and after a plane
} Walk;

static __attribute__((always_inline)) void BeginWalk(
  const PacketCandidates* c, const PacketFrame* f, Walk* at, const KernelParameters* p)
{
  at->StartX = TO_FLOATS(c->First[0]) - f->X0;
  at->StartY = TO_FLOATS(c->First[1]) - f->Y0;
  at->EndX = at->StartX + (TO_FLOATS(c->Count[0]) - 0.5f);
  at->EndY = at->StartY + (TO_FLOATS(c->Count[1]) - 0.5f);
  at->ToNextRow = p->OutputSize[0] - c->Count[0];
  at->ToNextPlane = (p->OutputSize[1] - c->Count[1]) * p->OutputSize[0];
  at->X = at->StartX;
  at->Y = at->StartY;
  at->Z = TO_FLOATS(c->First[2]) - f->Z0;
  at->Voxel = c->Voxel;
}

// Moves each lane to its next candidate.
static __attribute__((always_inline)) void Advance(Walk* at)
{
  at->X += 1.0f;
  const INTS rowDone = at->X > at->EndX;
  at->X = rowDone ? at->StartX : at->X;
  at->Y = rowDone ? at->Y + 1.0f : at->Y;
  const INTS planeDone = at->Y > at->EndY;
  at->Y = planeDone ? at->StartY : at->Y;
  at->Z = planeDone ? at->Z + 1.0f : at->Z;
  at->Voxel += 1 + WHERE(rowDone, at->ToNextRow) + WHERE(planeDone, at->ToNextPlane);
}

// Returns the lanes whose candidate is a vertex of their cell, which must be aligned.
static __attribute__((always_inline)) INTS IsOnVertex(const PacketFrame* f, const Walk* at)
{
  const FLOATS x = at->X + f->X0, y = at->Y + f->Y0, z = at->Z + f->Z0;
  return ((x == f->X0) | (x == f->X7)) & ((y == f->Y0) | (y == f->Y7)) &
    ((z == f->Z0) | (z == f->Z7));
}

// Returns the vertices at which samples lie, as masks, for lanes with IsOnVertex.
static __attribute__((always_inline)) INTS VerticesAt(const PacketFrame* f, const Walk* at)
{
  INTS vertices = at->X + f->X0 == f->X7 ? (INTS)(2) : (INTS)(1);
  vertices = at->Z + f->Z0 == f->Z7 ? vertices << 2 : vertices;
  return at->Y + f->Y0 == f->Y7 ? vertices << 4 : vertices;
}
