// SPDX-License-Identifier: BSD-3-Clause
// Resamples cells that the kernels for columns defer (ColumnResampling.cl): cells that are bent or large, that a cut
// divides, or that may lack tetrahedra.

// Resamples the samples of a cell that floats leave undecided.
static void ResampleUndecided(const PacketCandidates* c, const PacketFrame* frame,
  const SamplingMesh* mesh, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const Packet* const packet = &c->Cells;
  const Candidates all = AllCandidates(p);
  Neighbors near;
  const SamplingMesh keeping = KeepNeighbors(mesh, packet->X, packet->Y, packet->Z, &near);
  Cell cell;
  int isMade = -1; // -1: unknown
  // Whether the cell is inverted was counted before.
  const uint inverted = output->Inverted;
  PacketScales scales;
  FindScales(frame, &scales);
  Walk at;
  BeginWalk(c, frame, &at, p);
  for (int i = 0; i < c->Number; ++i, Advance(&at))
  {
    SampleWeights weights;
    uint undecidedByFloats;
    WeighCandidate(c, frame, &scales, &at, &weights, &undecidedByFloats);
    const float x = at.X + frame->X0, y = at.Y + frame->Y0, z = at.Z + frame->Z0;
    if (!undecidedByFloats || !InOutput(x, y, z, p) ||
      (c->HasNextToMissing && c->NextToMissing && IsOnVertex(frame, &at)))
    {
      continue;
    }
    const Vector voxel = { (int)x + p->OutputFirst[0], (int)y + p->OutputFirst[1],
      (int)z + p->OutputFirst[2] };
    const Candidates only = { voxel, voxel };
    // In passes with closed tetrahedra, MakeCell tests the sample and not the whole cell.
    const int isClosed = DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass);
    if (isMade < 0 || isClosed)
    {
      // A whole cell is not divided, so there are no views.
      isMade = MakeCell(&keeping, packet->X, packet->Y, packet->Z, isClosed ? &only : &all, &cell, 0, output, p) &&
        !IsDeferred(&cell, &only, output, p);
    }
    if (isMade)
    {
      ResampleSamples(&keeping, &cell, &only, output, p ARRAY_ARGUMENTS);
    }
  }
  output->Inverted = inverted;
}

// Resamples one deferred cell. slot: memory for its vertices.
static void ResampleDeferredCell(const SamplingMesh* mesh, int x, int y, int z, int what,
  ROW_MEMORY float* slot, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  if (what != DEFERRED_CELL_INT64)
  {
    PacketCandidates c;
    PacketFrame frame;
    MapCell(mesh, x, y, z, slot, &c.Cells, p ARRAY_ARGUMENTS);
    what = ResampleColumnCell(
      &c, MAXIMUM_CANDIDATES, mesh, &frame, 1, what != DEFERRED_FLOATS, output, p ARRAY_ARGUMENTS);
    if (what == DEFERRED_SAMPLES_INT64)
    {
      ResampleUndecided(&c, &frame, mesh, output, p ARRAY_ARGUMENTS);
      return;
    }
    if (what == CELL_DONE)
    {
      return;
    }
  }
  const Candidates all = AllCandidates(p);
  Neighbors near;
  const SamplingMesh keeping = KeepNeighbors(mesh, x, y, z, &near);
  ResampleCell(&keeping, x, y, z, &all, output, p ARRAY_ARGUMENTS);
}

// Resamples one deferred cell for each work-item, including those that ResampleDeferredInt32 has not finished. The
// host does not know their number.
__kernel void ResampleDeferredInt64(GIVEN_PARAMETERS, __global const uint* bricks, __global uint* deferred,
  __local float* rows, const KernelParameters p ARRAY_PARAMETERS)
{
  const SamplingMesh mesh = GIVEN_MESH;
  const uint countInt64 = deferred[0], entries = countInt64 + deferred[1];
  for (uint i = get_global_id(0); i < entries; i += get_global_size(0))
  {
    const uint entry = i < countInt64 ? ENTRIES_INT64(deferred)[i] : ENTRY_INT32(deferred, i - countInt64, &p);
    if (entry >> DEFERRED_BITS == DEFERRED_INT32)
    {
      continue;
    }
    const int3 cell = CellOfEntry(entry, bricks, &p);
    Output output = GIVEN_OUTPUT;
    ResampleDeferredCell(&mesh, cell.x, cell.y, cell.z, entry >> DEFERRED_BITS, SlotOfItem(rows),
      &output, &p ARRAY_ARGUMENTS);
    AddCounts(&output, SectionOf(cell.x, cell.y, cell.z, &p), counters, &p);
  }
}
