// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkCutVolume
 * @brief   cut a volume with a sheet
 *
 * vtkCutVolume switches off the tetrahedra of the sampling mesh of a volume that a sheet crosses.
 * The volume itself stays: its arrays are shared, and its cell array "ActiveTetrahedra" says what
 * is left. vtkDeformVolumeFilter leaves out what is switched off, so that the sides of the cut come
 * apart where a deformation moves them apart.
 *
 * A tetrahedron is decided exactly, on positions that are rounded to 1/256 voxel. The vertices of
 * the sampling mesh count as moved by (e, e^2, e^3) for an e that is as small as can be, so that a
 * sheet through voxels cuts one layer of cells, and not two or none. A sheet without a border
 * within the volume always separates: no two tetrahedra that are left on its two sides share a
 * face. The order and the orientation of triangles do not matter. A cut is about one cell thick.
 *
 * With SmoothCut nothing is lost: what the sheet crosses is divided, and both sides keep their part
 * of it.
 *
 * @par Port 1, the sheet, optional:
 * vtkPolyData in world coordinates: triangles, polygons and triangle strips; polylines where
 * SweepVector is set. It may be open, fold and cross itself. A sheet that misses the volume cuts
 * nothing. Where the sheet changes, the new cut takes the place of the old one, unless Accumulate
 * is on.
 *
 * @par Port 0, the volume, ports 2 and 3, the deformation and its rest configuration, and output:
 * As in vtkVolumeEditAlgorithm. With a deformation the sheet cuts the deformed volume, as it is
 * seen. A cut is made when the sheet or the tool is new.
 *
 * @par Edits:
 * An update with a new sheet makes an edit, and so does one with new positions of the tool. See
 * vtkVolumeEditAlgorithm for undoing them.
 *
 * @par Errors:
 * Those of vtkVolumeEditAlgorithm; a point of the sheet that is not finite, or a cell with a point
 * that is none; lines without SweepVector; a SweepVector that is not finite.
 *
 * The sampling mesh is that of Rodriguez, Leon, Martin and Otaduy, "A parallel resampling method
 * for interactive deformation of volumetric models", and the movement of vertices the simulation of
 * simplicity of Edelsbrunner and Muecke, 1990.
 *
 * @sa vtkVolumeEditAlgorithm vtkCarveVolume vtkDeformVolumeFilter
 */
#ifndef vtkCutVolume_h
#define vtkCutVolume_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkVolumeEditAlgorithm.h"

#include <memory> // for std::unique_ptr

class VTKDEFORMVOLUME_EXPORT vtkCutVolume : public vtkVolumeEditAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkCutVolume* New();
  vtkTypeMacro(vtkCutVolume, vtkVolumeEditAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Connect the sheet (port 1).
   */
  void SetSheetConnection(vtkAlgorithmOutput* output);
  void SetSheetData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Set/Get the vector along which polylines of the sheet cut: each segment becomes the
   * parallelogram that it sweeps. World units; 0, 0, 0: polylines do not cut. Default 0, 0, 0.
   */
  vtkSetVector3Macro(SweepVector, double);
  vtkGetVector3Macro(SweepVector, double);
  ///@}

  ///@{
  /**
   * Set/Get whether what is crossed is divided, in place of being switched off. On: the output gets
   * the cell array "CutTetrahedra" (unsigned char, bit i stands for tetrahedron i of the cell) with
   * the tetrahedra that the sheet parts into two sides, and the point array "CutDistance" (float):
   * the signed distance of their vertices from the sheet, in voxels of what is cut, and 0
   * elsewhere. vtkDeformVolumeFilter draws each side of such a tetrahedron with the motion of that
   * side, so that a cut which is not opened leaves the image as it was, and a gap lies exactly
   * between the two moved sheets. Where the sheet ends inside a tetrahedron, that one stays whole.
   * Where two sheets pass between two neighbouring vertices, and where a vertex lies on different
   * sides of two sheets, tetrahedra are switched off as without SmoothCut. Sheets of one piece have
   * one orientation; tool positions divide where they have gone on from each other. A smooth cut
   * that the volume comes with is joined. It matters for edits that follow; with another value the
   * sheet cuts again. Default: off.
   */
  vtkSetMacro(SmoothCut, bool);
  vtkGetMacro(SmoothCut, bool);
  vtkBooleanMacro(SmoothCut, bool);
  ///@}

  /**
   * Tetrahedra that the edits have divided, and that the volume did not come with as divided ones.
   */
  vtkIdType GetNumberOfDividedTetrahedra();

  /**
   * Move a cutting tool, a straight edge with these two ends in world coordinates. From position to
   * position it cuts what it sweeps: two triangles. An update cuts only between positions that are
   * new, and looks at the bricks there only. Positions that do not continue those of the last
   * update begin another stroke, whose first position cuts nothing: ClearToolPositions() lifts the
   * tool. What has been cut stays cut.
   */
  void AddToolPosition(double x0, double y0, double z0, double x1, double y1, double z1);

protected:
  vtkCutVolume();
  ~vtkCutVolume() override;

  void UpdateEdits(vtkInformationVector** input) override;

private:
  vtkCutVolume(const vtkCutVolume&) = delete;
  void operator=(const vtkCutVolume&) = delete;

  double SweepVector[3] = { 0.0, 0.0, 0.0 };
  bool SmoothCut = false;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
