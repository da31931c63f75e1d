// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointsFile_h
#define DeformVolumePointsFile_h

#include "LandmarkFile.h"

#include <vtkPointSet.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

class Messages;
struct Deformation;
struct Options;
struct Volume;

/// A file of --points.
struct PointsFile
{
  std::string Path;
  /// In the world of the volume, with the cells and arrays of a .vtp or .vtu file.
  vtkSmartPointer<vtkPointSet> Points;
  /// Whether the points were turned from the other world.
  bool IsTurned = false;
  /// Of other formats.
  LandmarkFile Landmarks;
};

/// How names end that are read and written.
inline constexpr const char* PointFormats =
  HasJson ? ".vtp, .vtu, .csv or .mrk.json" : ".vtp, .vtu or .csv";

/// The end of a file's name that says its format, or "" where it is none of these.
std::string GetPointFormat(const std::string& path);

/// Reads the files of --points, and turns the points into the world of the volume. Throws a
/// Failure that says what is wrong with a file.
std::vector<PointsFile> ReadPoints(
  const Options& options, const Volume& volume, Messages& messages);

/// Moves the points with the deformation, and writes them, in the worlds of their files, to those
/// of --points-output. A warning gives the number of points outside the deformation, which stay
/// where they are.
void WriteDeformedPoints(const std::vector<PointsFile>& files, const Options& options,
  const Deformation& deformation, Messages& messages);

#endif
