// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkCarveVolume
 * @brief   carve a body out of a volume
 *
 * vtkCarveVolume switches off the tetrahedra of the sampling mesh of a volume that lie inside a
 * body. A body is where an implicit function is negative, the inside of a closed surface, the
 * voxels with a label, or the space that a spherical tool has swept. All bodies that are set carve.
 * The values of the volume do not change: the output shares its arrays, and the cell array
 * "ActiveTetrahedra" has the remaining tetrahedra for vtkDeformVolumeFilter.
 *
 * Rule defines which tetrahedra are inside. With CENTROID, the default, the carved volume is that
 * of the body, to within a tenth of a percent for a sphere with a radius of 20 voxels.
 *
 * With SmoothBoundary the surface of the carved volume passes between the voxels, instead of along
 * the faces of whole tetrahedra.
 *
 * @par Port 1, the body, optional:
 * vtkPolyData, a closed surface in world coordinates: triangles, polygons and triangle strips.
 * Inside is where a ray crosses the surface an odd number of times; the orientation of cells does
 * not matter. Points that coincide to 1/256 voxel are merged. Whether a point is inside is decided
 * exactly: if two neighboring bodies share a face, exactly one of them carves each tetrahedron
 * there.
 *
 * @par Port 0, the volume, ports 2 and 3, the deformation and its mesh at rest, and output:
 * As in vtkVolumeEditAlgorithm. With a deformation, the function, the surface and the tool are in
 * the coordinates of the deformed volume. A label is carved whatever the deformation is.
 *
 * @par Edits:
 * An update makes an edit for the function, the surface and the label, each if it has changed, or
 * if Rule or SmoothBoundary has changed. It makes another edit for new positions of the tool. See
 * vtkVolumeEditAlgorithm for how to undo edits.
 *
 * @par Errors and warnings:
 * Errors are those of vtkVolumeEditAlgorithm; a surface that is open, or has a point that is not
 * finite; an array of labels that is missing, not numeric, of more than one component or too short;
 * a ToolRadius that is not greater than 0; a "BoundaryDistance" array of the volume that is not
 * numeric, or does not have one component and one tuple for each point. A label that no voxel has
 * causes a warning.
 *
 * @sa vtkVolumeEditAlgorithm vtkCutVolume vtkDeformVolumeFilter
 */
#ifndef vtkCarveVolume_h
#define vtkCarveVolume_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkVolumeEditAlgorithm.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class vtkImplicitFunction;

class VTKDEFORMVOLUME_EXPORT vtkCarveVolume : public vtkVolumeEditAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkCarveVolume* New();
  vtkTypeMacro(vtkCarveVolume, vtkVolumeEditAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  /**
   * The modification time of the filter or of the implicit function, whichever is later.
   */
  vtkMTimeType GetMTime() override;

  ///@{
  /**
   * Set/Get the implicit function, in world coordinates. Its inside is where it is negative.
   * Spheres, boxes and planes without a transform are evaluated only near them, other functions in
   * the whole volume. Default: null, which carves nothing.
   */
  virtual void SetImplicitFunction(vtkImplicitFunction* function);
  vtkGetObjectMacro(ImplicitFunction, vtkImplicitFunction);
  ///@}

  ///@{
  /**
   * Connect the closed surface (port 1).
   */
  void SetSurfaceConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  /// Set the data object of port 1 itself, without a pipeline.
  void SetSurfaceData(vtkDataObject* data) { this->SetInputDataInternal(1, data); }
  ///@}

  ///@{
  /**
   * Set/Get the name of a point array of labels, numeric and of one component, and the label of the
   * voxels that are carved. Labels are compared as doubles, which hold integers up to 2^53. With
   * CENTROID, a tetrahedron is inside if at least three of its four vertices have the label.
   * Defaults: "", which carves nothing; 1.
   */
  vtkSetMacro(LabelArrayName, std::string);
  vtkGetMacro(LabelArrayName, std::string);
  /// Set/Get the label of the voxels that are carved. Default: 1.
  vtkSetMacro(Label, double);
  vtkGetMacro(Label, double);
  ///@}

  /**
   * Which tetrahedra are inside the body, see SetRule().
   */
  enum Rules
  {
    CENTROID = 0,
    CONSERVATIVE = 1,
    MINIMAL = 2
  };

  ///@{
  /**
   * Set/Get which tetrahedra are inside the body. CENTROID: those whose centroid, the mean of their
   * vertices, is inside. CONSERVATIVE: those with any vertex inside, so that nothing of the body
   * remains. MINIMAL: those with all vertices inside, so that nothing outside the body is carved.
   * Default: CENTROID.
   */
  vtkSetClampMacro(Rule, int, CENTROID, MINIMAL);
  vtkGetMacro(Rule, int);
  void SetRuleToCentroid() { this->SetRule(CENTROID); }
  void SetRuleToConservative() { this->SetRule(CONSERVATIVE); }
  void SetRuleToMinimal() { this->SetRule(MINIMAL); }
  ///@}

  ///@{
  /**
   * Set/Get whether the surface of the carved volume passes between the voxels. On: tetrahedra with
   * all vertices inside are switched off, whatever Rule is, and the output has the point array
   * "BoundaryDistance" (float, world units): the signed distance of each vertex from the surface,
   * negative inside. The distance is a first-order approximation, and valid only near the surface.
   * vtkDeformVolumeFilter interpolates it in each tetrahedron, and leaves out samples where it is
   * negative. The volume of a sphere with a radius of 20 voxels is then right to within a tenth of
   * a percent at any sampling of the output. The surface of a label lies halfway between voxels. If
   * the volume has an array of this name, the output has the smaller of both distances. Default:
   * off.
   */
  vtkSetMacro(SmoothBoundary, bool);
  vtkGetMacro(SmoothBoundary, bool);
  vtkBooleanMacro(SmoothBoundary, bool);
  ///@}

  /**
   * Move a spherical tool with the radius ToolRadius to a position in world coordinates. The tool
   * carves at its positions, and the space that it sweeps between them. An update carves only along
   * positions that are new since the last update, and takes time only for the cells there.
   * ClearToolPositions() lifts the tool, and the next position begins a new stroke. Carved
   * tetrahedra remain switched off.
   */
  void AddToolPosition(double x, double y, double z);

  ///@{
  /**
   * Set/Get the radius of the tool in world units, greater than 0. It is used for new positions.
   * Default: 1.
   */
  vtkSetMacro(ToolRadius, double);
  vtkGetMacro(ToolRadius, double);
  ///@}

protected:
  vtkCarveVolume();
  ~vtkCarveVolume() override;

  void UpdateEdits(vtkInformationVector** input) override;

private:
  vtkCarveVolume(const vtkCarveVolume&) = delete;
  void operator=(const vtkCarveVolume&) = delete;

  vtkImplicitFunction* ImplicitFunction = nullptr;
  std::string LabelArrayName;
  double Label = 1.0;
  int Rule = CENTROID;
  bool SmoothBoundary = false;
  double ToolRadius = 1.0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
