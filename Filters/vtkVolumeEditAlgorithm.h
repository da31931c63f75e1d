// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkVolumeEditAlgorithm
 * @brief   superclass of filters that take tetrahedra out of a volume
 *
 * vtkVolumeEditAlgorithm has what vtkCutVolume and vtkCarveVolume share: the ports and what is
 * asked of them, a deformation in which the volume is edited as it is seen, positions of a tool,
 * and edits that can be undone. A subclass finds the tetrahedra that its edits switch off.
 *
 * @par Port 0, the volume:
 * vtkImageData of at least two voxels on each axis; any extent, origin, spacing and direction. A
 * cell array "ActiveTetrahedra" (unsigned char, one component; bit i stands for tetrahedron i of
 * the cell) says what is active before the edits; absent, all tetrahedra are. Bits are only
 * cleared, so filters in a chain add up.
 *
 * @par Port 1, vtkPolyData, optional:
 * What the subclass makes of it.
 *
 * @par Port 2, the deformation, optional:
 * As on port 1 of vtkDeformVolumeFilter: tetrahedra with displacements, or a displacement field,
 * forward. The deformed volume is edited then, as it is seen. The vectors are chosen by
 * SetInputArrayToProcess(0, 2, 0, POINTS, name), by default the active ones. An edit is made with
 * the deformation as it is then. When only the deformation changes, the edit stays where it is in
 * the tissue, and costs nothing.
 *
 * @par Port 3, optional, the rest configuration of the deformation mesh:
 * As on port 2 of vtkDeformVolumeFilter.
 *
 * @par Output:
 * The volume with its arrays, and "ActiveTetrahedra". The array is changed in place from update to
 * update, unless somebody else holds a reference to it. With BlankCells also vtkGhostType.
 *
 * @par Edits:
 * Undo() switches on again what the last edit has switched off, bit for bit, as far as no other
 * edit has. Edits are forgotten when voxels lie elsewhere than before (extent, origin, spacing or
 * direction); everything then edits again. They stay when values or "ActiveTetrahedra" of the
 * volume change.
 *
 * @par Abort:
 * An execution that is aborted ends with an empty output; the edits are as they were, and the next
 * update makes those that are missing.
 *
 * @par Errors:
 * A volume that is flat; an "ActiveTetrahedra" array of another type or size; a tool
 * position or a DisplacementScale that is not finite; a deformation that vtkDeformVolumeFilter
 * would not take, or that draws 8 cells out to more than 2,048 voxels where it is edited. Each is
 * one vtkErrorMacro; the output is then empty, the edits are as they were, and the filter works
 * again once the cause is corrected.
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
   * Connect the deformation (port 2) and its rest configuration (port 3).
   */
  void SetDeformationConnection(vtkAlgorithmOutput* output);
  void SetDeformationData(vtkDataObject* data);
  void SetRestConnection(vtkAlgorithmOutput* output);
  void SetRestData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Set/Get whether an edit stays when what has made it changes: a sheet, a function, a surface or
   * a label. Off: the new edit takes the place of the old one, as when a plane is moved about.
   * Edits by the tool always stay. Default: off.
   */
  vtkSetMacro(Accumulate, bool);
  vtkGetMacro(Accumulate, bool);
  vtkBooleanMacro(Accumulate, bool);
  ///@}

  ///@{
  /**
   * Lift the tool: positions that follow begin another stroke. What it has done stays.
   */
  void ClearToolPositions();
  int GetNumberOfToolPositions();
  ///@}

  ///@{
  /**
   * Undo the last edit that an update has made, and redo what was undone last. Nothing happens
   * where there is none.
   */
  void Undo();
  void Redo();
  ///@}

  /**
   * Forget all edits: the output is the input. What is connected or set edits again when it
   * changes, the tool when it moves on.
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
   * What becomes of voxels outside the deformation, see SetOutsideMode().
   */
  enum OutsideModes
  {
    DISCARD = 0,
    EXTRAPOLATE = 1,
    KEEP = 2
  };

  ///@{
  /**
   * Set/Get where the voxels outside the deformation are, as in vtkDeformVolumeFilter: nowhere, so
   * that no edit takes them, where the nearest tetrahedron takes them, or where they are at rest,
   * but for what fades within FadeDistance. Default: DISCARD.
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
   * Set/Get whether the output's cell array vtkGhostType hides the cells that have a tetrahedron
   * that is switched off or divided, in addition to those that the volume's array hides. Renderers
   * and most filters leave hidden cells out, so that edits show in the volume itself, to within a
   * cell. These cells have the bit 128 as well, by which vtkDeformVolumeFilter knows that they are
   * not hidden from it. Default: off.
   */
  vtkSetMacro(BlankCells, bool);
  vtkGetMacro(BlankCells, bool);
  vtkBooleanMacro(BlankCells, bool);
  ///@}

  /**
   * Tetrahedra that the edits have switched off and that were active in the volume.
   */
  vtkIdType GetNumberOfSwitchedOffTetrahedra();

protected:
  vtkVolumeEditAlgorithm();
  ~vtkVolumeEditAlgorithm() override;

  /**
   * Bring the edits up to date with the inputs. All that can fail comes before the first change.
   * Throws a std::exception, which RequestData() turns into an error.
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
