// SPDX-License-Identifier: BSD-3-Clause
// Which voxels of a volume belong to its body, and to which piece of it.
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
  double Isovalue = 0.0;            // unless by labels
};

/// Body voxels that lie side by side in a row.
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
  std::vector<vtkIdType> RowStarts; // of each row its first run, and the number of runs at the end
  std::vector<PieceKind> Pieces;    // the kind of each piece

  vtkIdType NumberOfRows() const { return vtkIdType(this->Size[1]) * this->Size[2]; }
  vtkIdType CountVoxels(PieceKind kind) const;
  vtkIdType CountPieces(PieceKind kind) const;
};

/// The voxels that fulfil the criterion, are finite and not hidden by vtkGhostType, without pieces.
BodyVoxels FindBodyVoxels(
  vtkImageData* volume, vtkDataArray* array, const BodyCriterion& criterion);

/// Finds the pieces, sets Piece of all runs and the kinds: pieces of at most `speckSize` voxels are
/// specks; of the others, all are meshed, or only the one with most voxels. Voxels are neighbours
/// where they share a face, an edge or a corner. Where all pieces are specks, none is one.
void FindPieces(BodyVoxels& body, vtkIdType speckSize, bool largestOnly);

} // namespace deformvolume

#endif
