// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTools_h
#define DeformVolumeTools_h

#include <array>
#include <string>
#include <vector>

class Messages;
struct Options;
struct Volume;

/// A sphere of --carve. World units.
struct Carving
{
  std::array<double, 3> Center{ { 0.0, 0.0, 0.0 } };
  double Radius = 1.0;
};

/// Switches off the tetrahedra of the volume that the sheets of --cut cross, unless they cut a mesh
/// (Options::CutsMesh), and those inside the spheres of --carve. The volume gets the cell array
/// "ActiveTetrahedra". Returns one line of text for each tool, with its effect. Throws a Failure if
/// a sheet cannot be read.
std::vector<std::string> CutAndCarve(const Options& options, Volume& volume, Messages& messages);

#endif
