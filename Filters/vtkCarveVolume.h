// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkCarveVolume
 * @brief   carve a body out of a volume
 *
 * vtkCarveVolume switches off the tetrahedra of the sampling mesh of a volume that lie inside a
 * body: where an implicit function is negative, inside a closed surface, where voxels have a label,
 * or where a spherical tool has been. Each that is set carves. The volume itself stays: its arrays
 * are shared, and its cell array "ActiveTetrahedra" says what is left for vtkDeformVolumeFilter.
 *
 * Rule says which tetrahedra are inside. By CENTROID, the default, what is carved out is as large
 * as the body, to within a tenth of a percent for a sphere of a radius of 20 voxels.
 *
 * With SmoothBoundary the surface of what is carved out is not made of whole tetrahedra: it passes
 * between the voxels.
 *
 * @par Port 1, the body, optional:
 * vtkPolyData, a closed surface in world coordinates: triangles, polygons and triangle strips.
 * Inside is where a ray crosses the surface an odd number of times; the orientation of cells does
 * not matter. Points in one place, to 1/256 voxel, are one. Points are decided exactly, so that of
 * neighbouring bodies that share a face exactly one carves a tetrahedron.
 *
 * @par Port 0, the volume, ports 2 and 3, the deformation and its rest configuration, and output:
 * As in vtkVolumeEditAlgorithm. With a deformation the body lies in the deformed volume, as it is
 * seen. A label is carved wherever its voxels are.
 *
 * @par Edits:
 * An update makes an edit for each of the function, the surface, the label and the tool that is
 * new, or for which Rule or SmoothBoundary is. See vtkVolumeEditAlgorithm for undoing them.
 *
 * @par Errors and warnings:
 * Errors are those of vtkVolumeEditAlgorithm; a surface that is open, or has a point that is not
 * finite; an array of labels that is missing, not numeric, of more than one component or too short;
 * a ToolRadius that is not greater than 0; a "BoundaryDistance" array of the volume that is not
 * numeric, of one component and as long as the volume has points. A label that no voxel has is a
 * warning.
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
   * That of the filter or of the implicit function, whichever was changed last.
   */
  vtkMTimeType GetMTime() override;

  ///@{
  /**
   * A function of world coordinates; where it is negative is inside. For spheres and boxes without
   * a transform only what is near them is looked at, for other functions all of the volume.
   * Default: null, which carves nothing.
   */
  virtual void SetImplicitFunction(vtkImplicitFunction* function);
  vtkGetObjectMacro(ImplicitFunction, vtkImplicitFunction);
  ///@}

  ///@{
  /**
   * Connect the closed surface (port 1).
   */
  void SetSurfaceConnection(vtkAlgorithmOutput* output);
  void SetSurfaceData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * Set/Get the name of a point array of the volume, numeric and of one component, and the value in
   * it of the voxels that are carved out, compared as a double: whole numbers up to 2^53. By
   * CENTROID three of the four vertices of a tetrahedron have it. Default: "", which carves
   * nothing, and 1.
   */
  vtkSetMacro(LabelArrayName, std::string);
  vtkGetMacro(LabelArrayName, std::string);
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
   * Set/Get which tetrahedra are inside: those with their centroid there, the mean of their
   * vertices; those with any vertex there, so that nothing of the body is left; or those with all
   * vertices there, so that nothing but the body is taken. Default: CENTROID.
   */
  vtkSetClampMacro(Rule, int, CENTROID, MINIMAL);
  vtkGetMacro(Rule, int);
  void SetRuleToCentroid() { this->SetRule(CENTROID); }
  void SetRuleToConservative() { this->SetRule(CONSERVATIVE); }
  void SetRuleToMinimal() { this->SetRule(MINIMAL); }
  ///@}

  ///@{
  /**
   * Set/Get whether the surface of what is carved out passes between the voxels. On: tetrahedra
   * with all vertices inside are switched off, whatever Rule is, and the output gets the point
   * array "BoundaryDistance" (float, world units): how far each vertex is from the surface,
   * negative inside, to first order and near the surface only. vtkDeformVolumeFilter interpolates
   * it in each tetrahedron and leaves out samples where it is negative. The volume of a sphere of a
   * radius of 20 voxels is then right to within a tenth of a percent at any sampling of the output.
   * Of a label the surface lies halfway between voxels. An array of this name that the volume comes
   * with is kept where it is less. Default: off.
   */
  vtkSetMacro(SmoothBoundary, bool);
  vtkGetMacro(SmoothBoundary, bool);
  vtkBooleanMacro(SmoothBoundary, bool);
  ///@}

  /**
   * Move a spherical tool of the radius ToolRadius, in world coordinates: it carves out where it
   * is, and from position to position what it sweeps. An update carves only what is new since the
   * last one, and looks at the bricks there only. Positions that do not continue those of the last
   * update begin another stroke: ClearToolPositions() lifts the tool. What has been carved stays
   * carved.
   */
  void AddToolPosition(double x, double y, double z);

  ///@{
  /**
   * Set/Get the radius of the tool in world units, greater than 0. It counts for positions that are
   * new. Default 1.
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
