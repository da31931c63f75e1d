// SPDX-License-Identifier: BSD-3-Clause
// Resamples cells with too many samples for one work-item. A cell can extend over the whole output. Devices that also
// draw the screen abort kernels that take seconds, and on other devices all other units would wait.
//
// Data and macros of the host: as in Resampling.cl, after which this text comes. pieces: from p.ListBegin to
// p.ListEnd, the local x, y and z of a cell, and the number of a piece of it.

__kernel void ResampleLargeCells(GIVEN_PARAMETERS,
  __global const int4* pieces, const KernelParameters p ARRAY_PARAMETERS)
{
  const int i = p.ListBegin + (int)get_global_id(0);
  if (i >= p.ListEnd)
  {
    return; // padding of the last work-group
  }
  const int4 piece = pieces[i];
  const SamplingMesh mesh = GIVEN_MESH;
  Output output = GIVEN_OUTPUT;
  const Candidates all = AllCandidates(&p);
  Cell cell, views[2];
  if (!MakeCell(&mesh, piece.x, piece.y, piece.z, &all, &cell, views, &output, &p))
  {
    return;
  }
  // The cell itself was counted before.
  output.Inverted = output.Overstretched = output.Missing = 0;
  const Candidates part = PieceOf(FindCandidates(cell.Low, cell.High, 0, &all), piece.w);
  if (!DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p.Pass) || AreUnsettled(part, &output, &p))
  {
    ResampleSamples(&mesh, &cell, &part, &output, &p ARRAY_ARGUMENTS);
  }
  AddCounts(&output, SectionOf(piece.x, piece.y, piece.z, &p), counters, &p);
}
