// SPDX-License-Identifier: BSD-3-Clause
// The voxels of a body in a volume, and the pieces (connected components) of the body.
#ifndef DeformVolumeBodyVoxels_h
#define DeformVolumeBodyVoxels_h

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <array>
#include <vector>

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

struct BodyCriterion
{
  bool ByLabels = false;
  std::vector<vtkTypeInt64> Labels; // empty: all but 0
  double Isovalue = 0.0;            // used if ByLabels is false
};

/// Adjacent voxels of the body in a row along x.
struct VoxelRun
{
  int Begin = 0;
  int End = 0; // one past the last
  vtkIdType Piece = 0;
};

enum class PieceKind : unsigned char
{
  Meshed,
  LeftOut,
  Speck
};

/// The voxels of a body as runs along x, row by row, y faster than z. Indices start at 0, whatever
/// the extent of the volume.
struct BodyVoxels
{
  std::array<int, 3> Size{ { 0, 0, 0 } };
  glm::dvec3 Spacing{ 1.0 }; // positive
  std::vector<VoxelRun> Runs;
  std::vector<vtkIdType> RowStarts; // index of the first run of each row, then the number of runs
  std::vector<PieceKind> Pieces;    // the kind of each piece

  vtkIdType NumberOfRows() const { return vtkIdType(this->Size[1]) * this->Size[2]; }
  vtkIdType CountVoxels(PieceKind kind) const;
  vtkIdType CountPieces(PieceKind kind) const;
};

/// Finds the voxels that meet the criterion, are finite, and are not hidden (FindPointGhosts()).
/// Does not find the pieces.
BodyVoxels FindBodyVoxels(
  vtkImageData* volume, vtkDataArray* array, const BodyCriterion& criterion);

/// Finds the pieces, and sets Piece of all runs and the kinds of the pieces. Voxels are connected
/// if they share a face, an edge or a corner. Pieces of at most `speckSize` voxels are specks,
/// unless all pieces are that small. Of the other pieces, all are meshed, or only the one with the
/// most voxels.
void FindPieces(BodyVoxels& body, vtkIdType speckSize, bool largestOnly);

} // namespace deformvolume

#endif
