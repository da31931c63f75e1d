// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLandmarkFile_h
#define DeformVolumeLandmarkFile_h

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

class Messages;
class vtkPointSet;

/// Landmarks of a text file. WriteLandmarks changes only coordinates in the text.
struct LandmarkFile
{
  std::string Text;
  /// Begin and end of x, y and z of each point in Text.
  std::vector<std::pair<std::size_t, std::size_t>> Numbers;
  /// In the world coordinates of the file, which are in the field data (KeepSpace).
  vtkSmartPointer<vtkPolyData> Points;
};

/// Whether a file name has the extension of a format that ReadLandmarks reads.
bool IsLandmarkFile(const std::string& path);

/// Whether this program reads and writes .mrk.json.
#ifdef DEFORMVOLUME_HAVE_JSON
inline constexpr bool HasJson = true;
#else
inline constexpr bool HasJson = false;
#endif

/// Reads landmarks. Throws a Failure that says what is wrong, and in which line.
///
/// .csv: points as antsApplyTransformsToPoints reads them. The first line names the columns, and
/// the first three are x, y and z. World coordinates are left-posterior-superior.
///
/// .mrk.json: markups of 3D Slicer, which state their world coordinates. Control points without a
/// defined position are left out.
LandmarkFile ReadLandmarks(const std::string& path, Messages& messages);

/// Writes the text with the coordinates of the moved points, in the world coordinates of the file.
/// The text of points whose "vtkValidPointMask" is 0 does not change. Returns false if the file
/// cannot be written.
bool WriteLandmarks(const LandmarkFile& file, vtkPointSet* moved, const std::string& path);

#endif
