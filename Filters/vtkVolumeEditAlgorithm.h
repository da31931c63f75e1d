// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkVolumeEditAlgorithm
 * @brief   superclass of filters that switch off tetrahedra of a volume
 *
 * vtkVolumeEditAlgorithm is the common part of vtkCutVolume and vtkCarveVolume: the ports and their
 * requests, edits of the deformed volume, positions of a tool, and undo. Subclasses find the
 * tetrahedra that their edits switch off.
 *
 * @par Port 0, the volume:
 * vtkImageData of at least two voxels on each axis; any extent, origin, spacing and direction. A
 * cell array "ActiveTetrahedra" (unsigned char, one component; bit i stands for tetrahedron i of
 * the cell) has the tetrahedra that are active before the edits. Without it, all tetrahedra are
 * active. Edits only clear bits, so that the edits of filters in a chain accumulate.
 *
 * @par Port 1, vtkPolyData, optional:
 * See the subclasses.
 *
 * @par Port 2, the deformation, optional:
 * As on port 1 of vtkDeformVolumeFilter: a mesh with displacements, or a forward displacement
 * field. Edits are then in the coordinates of the deformed volume. SetInputArrayToProcess(0, 2, 0,
 * POINTS, name) chooses the displacements, by default the active vectors. An edit uses the
 * deformation of the update that makes it. If only the deformation changes later, the edit keeps
 * its position in the tissue, and takes no time.
 *
 * @par Port 3, optional, the mesh at rest:
 * As on port 2 of vtkDeformVolumeFilter.
 *
 * @par Output:
 * The volume with its arrays, and "ActiveTetrahedra". The array is changed in place from update to
 * update, unless somebody else holds a reference to it. With BlankCells also vtkGhostType.
 *
 * @par Edits:
 * Undo() restores the tetrahedra that the last edit has switched off, bit for bit, except those
 * that another edit has switched off. If the extent, origin, spacing or direction of the volume
 * changes, all edits are removed, and the current inputs, settings and tool positions edit again.
 * If values or "ActiveTetrahedra" of the volume change, the edits remain.
 *
 * @par Abort:
 * An aborted execution ends with an empty output. The edits do not change, and the next update
 * makes the missing ones.
 *
 * @par Errors:
 * A composite volume, sheet or surface; a volume that is flat; an "ActiveTetrahedra" array of
 * another type or size; a tool position or a DisplacementScale that is not finite; a deformation
 * that is an error in vtkDeformVolumeFilter, or that stretches 8 cells over more than 2,048 voxels
 * at an edit. Each error is reported by one vtkErrorMacro. The output is then empty, the edits do
 * not change, and the filter works again after the cause is corrected.
 *
 * @sa vtkCutVolume vtkCarveVolume vtkDeformVolumeFilter
 */
#ifndef vtkVolumeEditAlgorithm_h
#define vtkVolumeEditAlgorithm_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkImageAlgorithm.h"

#include <memory> // for std::unique_ptr

class VTKDEFORMVOLUME_EXPORT vtkVolumeEditAlgorithm : public vtkImageAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for type information and printing.
   */
  vtkAbstractTypeMacro(vtkVolumeEditAlgorithm, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Connect the deformation (port 2) and its mesh at rest (port 3).
   */
  void SetDeformationConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
  /// Set the data object of port 2 itself, without a pipeline.
  void SetDeformationData(vtkDataObject* data) { this->SetInputDataInternal(2, data); }
  /// Connect the mesh at rest (port 3, optional).
  void SetRestConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(3, output); }
  /// Set the data object of port 3 itself, without a pipeline.
  void SetRestData(vtkDataObject* data) { this->SetInputDataInternal(3, data); }
  ///@}

  ///@{
  /**
   * Set/Get whether an edit remains when the sheet, function, surface or label that has made it
   * changes. Off: the new edit replaces the old one, for example while a plane is moved. Edits of
   * the tool always remain. Default: off.
   */
  vtkSetMacro(Accumulate, bool);
  vtkGetMacro(Accumulate, bool);
  vtkBooleanMacro(Accumulate, bool);
  ///@}

  ///@{
  /**
   * Remove the tool positions. Edits of the tool remain. After ClearToolPositions() the next
   * positions begin a new stroke. ReplaceToolPositions() is for user interfaces that give the whole
   * list again: positions that continue those of the last update continue its stroke.
   */
  void ClearToolPositions();
  /// Remove the tool positions, for a list that is given again and may continue the last stroke.
  void ReplaceToolPositions();
  int GetNumberOfToolPositions();
  ///@}

  ///@{
  /**
   * Undo the last edit that an update has made, or redo the last edit that was undone. Do nothing
   * if there is none.
   */
  void Undo();
  /// Redo the last edit that was undone.
  void Redo();
  ///@}

  /**
   * Remove all edits, so that the output equals the input. A sheet, function, surface or label
   * edits again after it has changed, and the tool after it has moved.
   */
  void Reset();

  ///@{
  /**
   * Set/Get a factor on the displacements of port 2, as in vtkDeformVolumeFilter. Default 1.
   */
  vtkSetMacro(DisplacementScale, double);
  vtkGetMacro(DisplacementScale, double);
  ///@}

  ///@{
  /**
   * Set/Get whether the points of a mesh on port 2 are deformed already, as in
   * vtkDeformVolumeFilter. Default: off.
   */
  vtkSetMacro(PointsAreDeformed, bool);
  vtkGetMacro(PointsAreDeformed, bool);
  vtkBooleanMacro(PointsAreDeformed, bool);
  ///@}

  /**
   * What happens to voxels outside the deformation, see SetOutsideMode().
   */
  enum OutsideModes
  {
    DISCARD = 0,
    EXTRAPOLATE = 1,
    KEEP = 2
  };

  ///@{
  /**
   * Set/Get what happens to voxels outside the deformation, as in vtkDeformVolumeFilter. DISCARD:
   * the deformed volume does not contain them, so that no edit affects them. EXTRAPOLATE: they
   * follow the nearest tetrahedron. KEEP: they do not move, except that the displacement fades to
   * zero within FadeDistance. Default: DISCARD.
   */
  vtkSetClampMacro(OutsideMode, int, DISCARD, KEEP);
  vtkGetMacro(OutsideMode, int);
  void SetOutsideModeToDiscard() { this->SetOutsideMode(DISCARD); }
  void SetOutsideModeToExtrapolate() { this->SetOutsideMode(EXTRAPOLATE); }
  void SetOutsideModeToKeep() { this->SetOutsideMode(KEEP); }
  ///@}

  ///@{
  /**
   * Set/Get, for OutsideMode KEEP, the distance within which the displacement fades to zero, as in
   * vtkDeformVolumeFilter. Default: 0.
   */
  vtkSetMacro(FadeDistance, double);
  vtkGetMacro(FadeDistance, double);
  ///@}

  ///@{
  /**
   * Set/Get whether the output's cell array vtkGhostType hides cells with a tetrahedron that is
   * switched off or divided, in addition to cells that are hidden in the volume. Volume rendering
   * on a GPU and the extraction of surfaces (vtkDataSetSurfaceFilter) leave out hidden cells, so
   * that edits are visible in the volume itself, with the resolution of a cell. Contours, slices,
   * clips, thresholds and ray casting on a CPU show hidden cells of an image. These cells also have
   * the bit 128, so that vtkDeformVolumeFilter does not treat them as hidden. Default: off.
   */
  vtkSetMacro(BlankCells, bool);
  vtkGetMacro(BlankCells, bool);
  vtkBooleanMacro(BlankCells, bool);
  ///@}

  /**
   * Get the number of tetrahedra that the edits have switched off and that are active in the input
   * volume.
   */
  vtkIdType GetNumberOfSwitchedOffTetrahedra();

protected:
  vtkVolumeEditAlgorithm();
  ~vtkVolumeEditAlgorithm() override;

  /**
   * Update the edits from the inputs. Everything that can fail has to come before the first change.
   * Throws a std::exception, which RequestData() reports as an error.
   */
  virtual void UpdateEdits(vtkInformationVector** input) = 0;

  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** input,
    vtkInformationVector* output, int requestFromOutputPort, vtkMTimeType* mtime) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

  bool Accumulate = false;
  double DisplacementScale = 1.0;
  bool PointsAreDeformed = false;
  int OutsideMode = DISCARD;
  double FadeDistance = 0.0;
  bool BlankCells = false;

  class vtkEdits;
  std::unique_ptr<vtkEdits> Edits;

private:
  vtkVolumeEditAlgorithm(const vtkVolumeEditAlgorithm&) = delete;
  void operator=(const vtkVolumeEditAlgorithm&) = delete;
};

#endif
