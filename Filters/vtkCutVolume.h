// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkCutVolume
 * @brief   cut a volume with a sheet
 *
 * vtkCutVolume switches off the tetrahedra of the sampling mesh of a volume that a sheet crosses.
 * The values of the volume do not change: the output shares its arrays, and the cell array
 * "ActiveTetrahedra" has the remaining tetrahedra. vtkDeformVolumeFilter leaves out tetrahedra that
 * are switched off, so that the cut opens where a deformation moves its sides apart.
 *
 * Whether a sheet crosses a tetrahedron is decided exactly, on positions that are rounded to 1/256
 * voxel. The vertices of the sampling mesh are treated as moved by (e, e^2, e^3) with an infinitely
 * small e, so that a sheet through voxels cuts one layer of cells, and not two or none. A sheet
 * without a border within the volume always separates its sides: no two remaining tetrahedra on its
 * two sides share a face. The order and the orientation of triangles do not matter. A cut is about
 * one cell thick.
 *
 * With SmoothCut no tissue is lost: tetrahedra that the sheet crosses are divided, and both sides
 * keep their part.
 *
 * @par Port 1, the sheet, optional:
 * vtkPolyData in world coordinates: triangles, polygons and triangle strips; also polylines if
 * SweepVector is set. It may be open, fold and cross itself. A sheet that misses the volume cuts
 * nothing. If the sheet changes, the new cut replaces the old one, unless Accumulate is on.
 *
 * @par Port 0, the volume, ports 2 and 3, the deformation and its mesh at rest, and output:
 * As in vtkVolumeEditAlgorithm. With a deformation, the sheet and the tool are in the coordinates
 * of the deformed volume. A cut is made if the sheet or the positions of the tool have changed.
 *
 * @par Edits:
 * An update with a new sheet makes an edit, and so does one with new positions of the tool. See
 * vtkVolumeEditAlgorithm for how to undo edits.
 *
 * @par Errors:
 * Those of vtkVolumeEditAlgorithm; a point of the sheet that is not finite, or a cell with a point
 * that does not exist; lines without SweepVector; a SweepVector that is not finite.
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
  void SetSheetConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  /// Set the data object of port 1 itself, without a pipeline.
  void SetSheetData(vtkDataObject* data) { this->SetInputDataInternal(1, data); }
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
   * Set/Get whether crossed tetrahedra are divided instead of switched off. On: the output has the
   * cell array "CutTetrahedra" (unsigned char, bit i stands for tetrahedron i of the cell) with the
   * tetrahedra that the sheet divides into two sides, and the point array "CutDistance" (float):
   * the signed distance of their vertices from the sheet, in voxels of the volume that is cut, and
   * 0 elsewhere. vtkDeformVolumeFilter draws each side of such a tetrahedron with the motion of
   * that side. Therefore a cut that is not opened does not change the image, and a gap lies exactly
   * between the two moved sheets.
   *
   * A tetrahedron in which the sheet ends stays whole. If two sheets pass between two neighboring
   * vertices, or a vertex lies on different sides of two sheets, tetrahedra are switched off as
   * without SmoothCut. The triangles of a connected sheet are first oriented consistently. Strokes
   * of the tool continue from update to update, and divide as one sheet. A smooth cut of the input
   * volume is joined with the new cuts, but tetrahedra that only both together divide stay whole.
   * SmoothCut affects the next edits; if it changes, the sheet cuts again. Default: off.
   */
  vtkSetMacro(SmoothCut, bool);
  vtkGetMacro(SmoothCut, bool);
  vtkBooleanMacro(SmoothCut, bool);
  ///@}

  /**
   * Get the number of tetrahedra that the edits have divided, without those that are divided in the
   * input volume.
   */
  vtkIdType GetNumberOfDividedTetrahedra();

  /**
   * Move a cutting tool, a straight edge with two ends, to a position in world coordinates. It cuts
   * along the area that it sweeps from position to position (two triangles). An update cuts only
   * between new positions, and takes time only for the cells there. ClearToolPositions() lifts
   * the tool: the next position begins a new stroke, and cuts nothing. Cuts remain.
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
