// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLatticeTetrahedraSource
 * @brief   regular tetrahedral deformation mesh of a box or of a volume
 *
 * vtkLatticeTetrahedraSource makes the simplest deformation mesh: a regular lattice of nodes whose
 * cells are split into five tetrahedra each, mirrored from cell to neighboring cell so that shared
 * faces match. vtkDeformVolumeFilter splits the cells of the sampling mesh in the same way.
 *
 * @par Port 0, optional, the volume:
 * vtkImageData, of which only the geometry is used. The lattice then covers the volume's whole
 * extent, from the first voxel center to the last, along the axes of the volume. Origin, spacing,
 * direction matrix and an extent that does not start at 0 are taken into account. Each axis needs
 * at least two voxels. Without an input the lattice covers Bounds, along the world axes.
 *
 * @par Output:
 * vtkUnstructuredGrid. Points are in double precision, and the first axis varies fastest. Cells are
 * vtkTetra, all with positive volume (the fourth vertex is on the side to which the normal of the
 * first three points). The five tetrahedra of a cell follow each other. For Dimensions of nx, ny
 * and nz there are nx * ny * nz points and 5 (nx-1) (ny-1) (nz-1) tetrahedra. The first piece is
 * the whole lattice, all others are empty.
 *
 * @par Errors:
 * Bounds that are empty or not finite, a volume with fewer than two voxels on an axis, fewer than
 * two nodes on an axis, and a lattice too large to be stored.
 *
 * @sa vtkTetGenMesher vtkDeformVolumeFilter
 */
#ifndef vtkLatticeTetrahedraSource_h
#define vtkLatticeTetrahedraSource_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <memory> // for std::unique_ptr

namespace deformvolume
{
class PipelineExecution;
}

class VTKDEFORMVOLUME_EXPORT vtkLatticeTetrahedraSource : public vtkUnstructuredGridAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkLatticeTetrahedraSource* New();
  vtkTypeMacro(vtkLatticeTetrahedraSource, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Set/Get the number of nodes on each axis, at least 2. With EqualSpacing these are the largest
   * numbers. Default: 13, 13, 13.
   */
  vtkSetVector3Macro(NumberOfNodes, int);
  vtkGetVector3Macro(NumberOfNodes, int);
  ///@}

  ///@{
  /**
   * Set/Get whether the cells are cubes, which vtkMassSpringDeformation needs, and which give the
   * best tetrahedra. The edge of a cube is then the longest of the node distances that
   * NumberOfNodes gives on the three axes. The other axes get only as many nodes as they need, and
   * the lattice extends beyond the box or the volume there, by less than half a cell, equally on
   * both sides. Off: each axis has NumberOfNodes nodes, and the lattice ends where the box ends. If
   * the axes of a volume are not perpendicular, all edges have the same length, but the cells are
   * not cubes. Default: on.
   */
  vtkSetMacro(EqualSpacing, bool);
  vtkGetMacro(EqualSpacing, bool);
  vtkBooleanMacro(EqualSpacing, bool);
  ///@}

  ///@{
  /**
   * Get the number of nodes on each axis of the last output; 0, 0, 0 if the output is empty.
   */
  vtkGetVector3Macro(Dimensions, int);
  ///@}

  ///@{
  /**
   * Set/Get the box in world coordinates (x min, x max, y min, y max, z min, z max) that the
   * lattice covers when no volume is connected. Default: -0.5, 0.5, -0.5, 0.5, -0.5, 0.5.
   */
  vtkSetVector6Macro(Bounds, double);
  vtkGetVector6Macro(Bounds, double);
  ///@}

  ///@{
  /**
   * Set/Get the least distance by which the lattice extends beyond the box or the volume on each
   * side, in world units, at least 0. Default: 0. Without EqualSpacing, the outermost voxel centers
   * then lie on the lattice's boundary.
   */
  vtkSetClampMacro(Margin, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Margin, double);
  ///@}

protected:
  vtkLatticeTetrahedraSource();
  ~vtkLatticeTetrahedraSource() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector, int requestFromOutputPort, vtkMTimeType* mtime) override;

  int NumberOfNodes[3] = { 13, 13, 13 };
  double Bounds[6] = { -0.5, 0.5, -0.5, 0.5, -0.5, 0.5 };
  double Margin = 0.0;
  bool EqualSpacing = true;
  int Dimensions[3] = { 0, 0, 0 };

private:
  std::unique_ptr<deformvolume::PipelineExecution> Execution;

  vtkLatticeTetrahedraSource(const vtkLatticeTetrahedraSource&) = delete;
  void operator=(const vtkLatticeTetrahedraSource&) = delete;
};

#endif
