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
  /// In the world coordinates of the volume, with the cells and arrays of the file.
  vtkSmartPointer<vtkPointSet> Points;
  /// Whether the points were converted from other world coordinates.
  bool IsConverted = false;
  /// The text of a .csv or .mrk.json file.
  LandmarkFile Landmarks;
};

/// The file extensions that can be read and written.
inline constexpr const char* PointFormats =
  HasJson ? ".vtp, .vtu, .stl, .ply, .csv or .mrk.json" : ".vtp, .vtu, .stl, .ply or .csv";

/// The extension of a file name, or "" if it is not one of PointFormats.
std::string GetPointFormat(const std::string& path);

/// Reads the files of --points, and converts them to the world coordinates of the volume. Throws a
/// Failure that says what is wrong with a file.
std::vector<PointsFile> ReadPoints(
  const Options& options, const Volume& volume, Messages& messages);

/// Deforms the points, and writes them to the files of --points-output, in the world coordinates of
/// the files of --points. Points outside the deformation do not move. A warning gives their number.
void WriteDeformedPoints(const std::vector<PointsFile>& files, const Options& options,
  const Deformation& deformation, Messages& messages);

#endif
