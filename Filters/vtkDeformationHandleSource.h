// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformationHandleSource
 * @brief   a handle that holds a point of a body and drags it elsewhere
 *
 * vtkDeformationHandleSource makes a handle for vtkChainMailDeformation or vtkElasticDeformation:
 * the current position of the handle, and the position in the body at rest that it holds.
 * vtkAppendPolyData joins several handles.
 *
 * @par Output:
 * vtkPolyData with one point at Position, in double precision, and one vertex cell. Its point array
 * RestPosition (vtkDoubleArray, 3 components) has the position at rest, in world coordinates. The
 * first piece has the point, all others are empty.
 *
 * @par Errors:
 * A position that is not finite.
 *
 * @sa vtkChainMailDeformation vtkElasticDeformation
 */
#ifndef vtkDeformationHandleSource_h
#define vtkDeformationHandleSource_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

class VTKDEFORMVOLUME_EXPORT vtkDeformationHandleSource : public vtkPolyDataAlgorithm
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkDeformationHandleSource* New();
  vtkTypeMacro(vtkDeformationHandleSource, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Set/Get the position in the body at rest that the handle holds, in world coordinates. Default:
   * 0, 0, 0.
   */
  vtkSetVector3Macro(RestPosition, double);
  vtkGetVector3Macro(RestPosition, double);
  ///@}

  ///@{
  /**
   * Set/Get the current position of the handle, in world coordinates. Default: 0, 0, 0.
   */
  vtkSetVector3Macro(Position, double);
  vtkGetVector3Macro(Position, double);
  ///@}

protected:
  vtkDeformationHandleSource();
  ~vtkDeformationHandleSource() override = default;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

  double RestPosition[3] = { 0.0, 0.0, 0.0 };
  double Position[3] = { 0.0, 0.0, 0.0 };

private:
  vtkDeformationHandleSource(const vtkDeformationHandleSource&) = delete;
  void operator=(const vtkDeformationHandleSource&) = delete;
};

#endif
