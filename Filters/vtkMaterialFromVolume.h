// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkMaterialFromVolume
 * @brief   give the tetrahedra of a mesh the stiffness of the voxels in them
 *
 * vtkMaterialFromVolume looks up the material of each voxel of a volume in a table, by its label or
 * by ranges of its value. Each tetrahedron gets the mean of the Young modulus, the Poisson ratio
 * and the density of the voxels that it holds, each voxel counting alike. The elastic filters
 * (vtkElasticDeformation) read them.
 *
 * A voxel on the border of several tetrahedra counts for one of them. A tetrahedron that holds no
 * voxel gets the material of the voxel that is nearest to its centroid, and one outside the volume
 * the default material.
 *
 * @par Port 0, the mesh:
 * vtkUnstructuredGrid of vtkTetra or vtkQuadraticTetra cells in the world coordinates of the
 * volume. Edges of the latter count as straight. Cells of fewer than three dimensions have the
 * default material.
 *
 * @par Port 1, the volume:
 * vtkImageData of at least two voxels on each axis: any extent, origin, spacing and direction
 * matrix. It is asked for whole. Its point array of one component and any numeric type has the
 * materials, see MaterialArrayName. Points that vtkGhostType marks as hidden or duplicate do not
 * count.
 *
 * @par Output:
 * The mesh, with the cell arrays "YoungModulus" (Pa), "PoissonRatio" and "Density" (kg/m^3) of
 * doubles, one component each, in place of arrays of these names. All else is shared with the
 * input.
 *
 * @par Errors:
 * Each is one vtkErrorMacro that says what is wrong and what to do, and the output is then empty: a
 * volume that is flat or has no valid spacing; an array that is not there or has several
 * components; a "vtkGhostType" of another type or size; a value that has no material; a Young
 * modulus or a density of 0 or less, or a Poisson ratio of less than 0 or of 0.495 and more; cells
 * that are not tetrahedra; coordinates that are not finite.
 *
 * @sa vtkFiniteElementDeformation vtkMassSpringDeformation vtkChainMailDeformation
 */
#ifndef vtkMaterialFromVolume_h
#define vtkMaterialFromVolume_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class VTKDEFORMVOLUME_EXPORT vtkMaterialFromVolume : public vtkUnstructuredGridAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkMaterialFromVolume* New();
  vtkTypeMacro(vtkMaterialFromVolume, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Connect the volume (port 1).
   */
  void SetVolumeConnection(vtkAlgorithmOutput* output);
  void SetVolumeData(vtkDataObject* data);
  ///@}

  ///@{
  /**
   * A material. index: a whole number from 0 to 255 (a double, since panels of ParaView pass
   * nothing else); youngModulus: in Pa, greater than 0; poissonRatio: 0 or more, less than 0.495;
   * density: in kg/m^3, greater than 0. Others are an error of the next execution.
   *
   * There are five materials by default, all of them engineering values: 0, air: 100, 0, 100;
   * 1, soft tissue: 1e4, 0.3, 1000; 2, muscle: 5e4, 0.4, 1060; 3, cartilage: 1e6, 0.4, 1100;
   * 4, bone: 1e7, 0.3, 1900. Air is a very soft tissue, so that a mesh may hold some. Bone is less
   * stiff than in nature (1e10), where soft tissue does not bend it either, as time steps of
   * springs become shorter with stiffness.
   */
  void SetMaterial(double index, double youngModulus, double poissonRatio, double density);
  /**
   * The values of a material, in this order; false, and no change, where there is none.
   */
  bool GetMaterialValues(int index, double values[3]);
  /**
   * Remove all materials that SetMaterial() has set, the default ones included.
   */
  void ClearMaterials();
  int GetNumberOfMaterials();
  ///@}

  ///@{
  /**
   * Set/Get the tissue that an index stands for: an index from 0 to 255, and a value of
   * vtkElasticDeformation::MaterialPresetType, such as vtkElasticDeformation::LIVER. Its Young
   * modulus, Poisson ratio and density are used in place of those of SetMaterial(), whichever is
   * called first. Others are an error, and change nothing. CUSTOM, the default of all indices:
   * those of SetMaterial() are used.
   *
   * The numbers are those of vtkElasticDeformation::GetMaterialPresetValues(); their limits are in
   * Documents/physics.md.
   */
  void SetMaterialPreset(int index, int preset);
  int GetMaterialPreset(int index);
  /**
   * Set all indices to CUSTOM.
   */
  void ClearMaterialPresets();
  /**
   * The number of indices that stand for a tissue.
   */
  int GetNumberOfMaterialPresets();
  ///@}

  ///@{
  /**
   * Set/Get the name of the point array of the volume with the material of each voxel; any numeric
   * type. Without ranges (AddMaterialRange()) its values are indices of materials, as labels are.
   * "": the active scalars where there are ranges, and DefaultMaterial everywhere where there are
   * none. Default "".
   */
  vtkSetMacro(MaterialArrayName, std::string);
  vtkGetMacro(MaterialArrayName, std::string);
  ///@}

  ///@{
  /**
   * Voxels with a value of minimum or more, and less than maximum, have a material. The first range
   * that holds a value counts; where none does, DefaultMaterial. The index is a whole number from 0
   * to 255.
   */
  void AddMaterialRange(double minimum, double maximum, double index);
  void ClearMaterialRanges();
  int GetNumberOfMaterialRanges();
  ///@}

  ///@{
  /**
   * Set/Get the index of the material of voxels that have no other one, and of tetrahedra outside
   * the volume. Default 1, soft tissue.
   */
  vtkSetClampMacro(DefaultMaterial, int, 0, 255);
  vtkGetMacro(DefaultMaterial, int);
  ///@}

  ///@{
  /**
   * Tetrahedra of the last execution that hold no voxel and have the material of the nearest one,
   * and those outside the volume, or where no voxel counts, which have the default material.
   */
  vtkGetMacro(NumberOfTetrahedraWithoutVoxels, vtkIdType);
  vtkGetMacro(NumberOfTetrahedraOutside, vtkIdType);
  ///@}

protected:
  vtkMaterialFromVolume();
  ~vtkMaterialFromVolume() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int ComputePipelineMTime(vtkInformation* request, vtkInformationVector** input,
    vtkInformationVector* output, int requestFromOutputPort, vtkMTimeType* mtime) override;

private:
  vtkMaterialFromVolume(const vtkMaterialFromVolume&) = delete;
  void operator=(const vtkMaterialFromVolume&) = delete;

  void Execute(vtkInformationVector** input, vtkInformationVector* output);

  std::string MaterialArrayName;
  int DefaultMaterial = 1;
  vtkIdType NumberOfTetrahedraWithoutVoxels = 0;
  vtkIdType NumberOfTetrahedraOutside = 0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
