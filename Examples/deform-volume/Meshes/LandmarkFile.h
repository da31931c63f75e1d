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

/// Landmarks of a text file. Only coordinates change when it is written again.
struct LandmarkFile
{
  std::string Text;
  /// Where x, y and z of each point begin in the text, and where they end.
  std::vector<std::pair<std::size_t, std::size_t>> Numbers;
  /// In the world of the file, which the field data say.
  vtkSmartPointer<vtkPolyData> Points;
};

/// Whether a file's name is that of a format below.
bool IsLandmarkFile(const std::string& path);

/// Whether this program reads and writes .mrk.json.
#ifdef DEFORMVOLUME_HAVE_JSON
inline constexpr bool HasJson = true;
#else
inline constexpr bool HasJson = false;
#endif

/// Reads landmarks. Throws a Failure that says what is wrong, and in which line.
///
/// .csv: those of antsApplyTransformsToPoints. The first line names the columns, and the first
/// three are x, y and z. The world is left-posterior-superior.
///
/// .mrk.json: the markups of 3D Slicer, in the world that they say. Control points that are not
/// defined have no place, and are left out.
LandmarkFile ReadLandmarks(const std::string& path, Messages& messages);

/// Writes the text with the coordinates of moved points, in the world of the file. Numbers of
/// points whose "vtkValidPointMask" is 0 stay as they are, to the letter.
void WriteLandmarks(const LandmarkFile& file, vtkPointSet* moved, const std::string& path);

#endif
