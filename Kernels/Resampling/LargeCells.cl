// SPDX-License-Identifier: BSD-3-Clause
// Cells that have so many samples that one work-item does not take them all. A cell can be stretched over the whole
// output: devices that draw the screen, too, end kernels that take seconds, and others have all units but one waiting.
//
// Data and what the host puts in front of this text: as in Resampling.cl, which it comes after. pieces: from
// p.ListBegin to p.ListEnd local x, y and z of a cell, and the number of a piece of it.

__kernel void ResampleLargeCells(GIVEN_PARAMETERS,
  __global const int4* pieces, const KernelParameters p ARRAY_PARAMETERS)
{
  const int i = p.ListBegin + (int)get_global_id(0);
  if (i >= p.ListEnd)
  {
    return; // an item that only fills its group
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
  // Of the cell itself all has been counted.
  output.Inverted = output.Overstretched = output.Missing = 0;
  const Candidates part = PieceOf(FindCandidates(cell.Low, cell.High, 0, &all), piece.w);
  if (!DEFORMVOLUME_IS_CLOSED(p.Pass) || AreUnsettled(part, &output, &p))
  {
    ResampleSamples(&mesh, &cell, &part, &output, &p ARRAY_ARGUMENTS);
  }
  AddCounts(&output, SectionOf(piece.x, piece.y, piece.z, &p), counters, &p);
}
