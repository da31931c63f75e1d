// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTools_h
#define DeformVolumeTools_h

#include <array>
#include <string>
#include <vector>

class Messages;
struct Options;
struct Volume;

/// A sphere that is carved out. World units.
struct Carving
{
  std::array<double, 3> Center{ { 0.0, 0.0, 0.0 } };
  double Radius = 1.0;
};

/// Switches off the tetrahedra of the volume that the sheets of the options cross, unless these cut
/// a mesh, and that the spheres hold: the volume gets the cell array "ActiveTetrahedra". Returns
/// what was done, in words, a line each. Throws a Failure where a sheet cannot be read.
std::vector<std::string> CutAndCarve(const Options& options, Volume& volume, Messages& messages);

#endif
