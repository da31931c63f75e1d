// SPDX-License-Identifier: BSD-3-Clause
// Tests that the peers of the benchmarks have the same output as the filter, so that the benchmarks
// compare times for the same result.
#include "BenchmarkCase.h"
#include "Peers.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>

namespace
{
constexpr std::array<int, 3> Dimensions{ { 48, 40, 44 } };
constexpr int Nodes = 7;
// Voxels near the border are left out, because peers may use the background as a neighboring value.
constexpr int Border = 6;

// Returns the largest difference of values at voxels whose neighborhood the filter covers; negative
// if there are no such voxels.
double GetLargestDifference(vtkImageData* ours, vtkImageData* theirs)
{
  vtkDataArray* mask = ours->GetPointData()->GetArray("vtkValidPointMask");
  vtkDataArray* a = ours->GetPointData()->GetScalars();
  vtkDataArray* b = theirs->GetPointData()->GetScalars();
  if (!b || b->GetNumberOfTuples() != a->GetNumberOfTuples())
  {
    std::cerr << "the output of the peer has " << (b ? b->GetNumberOfTuples() : 0)
              << " values instead of " << a->GetNumberOfTuples() << "\n";
    return -1.0;
  }
  int extent[6];
  ours->GetExtent(extent);
  const auto covered = [&](int x, int y, int z)
  {
    int index[3] = { x, y, z };
    return mask->GetTuple1(ours->ComputePointId(index)) != 0.0;
  };
  double largest = -1.0;
  for (int z = extent[4] + Border; z <= extent[5] - Border; ++z)
  {
    for (int y = extent[2] + Border; y <= extent[3] - Border; ++y)
    {
      for (int x = extent[0] + Border; x <= extent[1] - Border; ++x)
      {
        bool inside = true;
        for (int corner = 0; corner < 8; ++corner)
        {
          inside = inside &&
            covered(x + (corner & 1 ? Border : -Border), y + (corner & 2 ? Border : -Border),
              z + (corner & 4 ? Border : -Border));
        }
        if (inside)
        {
          int index[3] = { x, y, z };
          const vtkIdType id = ours->ComputePointId(index);
          largest = std::max(largest, std::abs(a->GetTuple1(id) - b->GetTuple1(id)));
        }
      }
    }
  }
  return largest;
}

bool Check(
  const char* name, vtkImageData* volume, std::unique_ptr<Peer> peer, Pose pose, double tolerance)
{
  BenchmarkCase subject(volume, Nodes);
  // Two steps, so that a peer that does not notice that the mesh has moved fails.
  for (int step = 1; step <= 2; ++step)
  {
    subject.Move(pose);
    subject.Update();
    vtkImageData* ours = subject.GetFilter()->GetOutput();
    peer->Update(pose, subject.GetStep(), ours->GetExtent());
    const double difference = GetLargestDifference(ours, peer->GetOutput());
    std::cout << name << ", " << GetName(pose) << ": largest difference " << difference << "\n";
    if (difference < 0.0 || difference > tolerance)
    {
      std::cerr << name
                << ": the largest difference from the output of the filter must be from 0 to "
                << tolerance << "\n";
      return false;
    }
  }
  return true;
}
}

int main()
{
  const auto volume = MakeVolume(Dimensions);
  // The waves change by at most 600 (0.11 + 0.07 + 0.05) = 138 from voxel to voxel. So the rounding
  // of positions, at most 1/512 voxel, changes values by 0.3. The filter rounds values to the
  // nearest integer, and some peers truncate. Tetrahedra and cells interpolate sums of functions of
  // one axis in the same way; the waves and the components of the displacements are such sums.
  constexpr double tolerance = 2.0;
  bool passed = true;
  try
  {
    passed &= Check("affine reslice", volume, MakeAffineReslice(volume), Pose::General, tolerance);
    passed &= Check("grid reslice, solved", volume,
      MakeGridReslice(volume, Nodes, GridDirection::Solved), Pose::NearIdentity, tolerance);
    passed &= Check("grid reslice, solved", volume,
      MakeGridReslice(volume, Nodes, GridDirection::Solved), Pose::General, tolerance);
    for (const Pose pose : { Pose::NearIdentity, Pose::General })
    {
      passed &= Check("probe chain", volume, MakeProbeChain(volume, Nodes), pose, tolerance);
    }
    // The published method does not round positions, which changes values by 0.3 at most. Both
    // round values to integers.
    for (const Pose pose : { Pose::NearIdentity, Pose::General, Pose::VaryingScale })
    {
      passed &= Check("published", volume, MakePublished(volume, Nodes), pose, 1.0);
    }
    // A forward grid that is used as the inverse is correct only if all points move by the same
    // vector.
    passed &= Check("grid reslice, backward", volume,
      MakeGridReslice(volume, Nodes, GridDirection::Backward), Pose::Undeformed, tolerance);
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return passed ? EXIT_SUCCESS : EXIT_FAILURE;
}
