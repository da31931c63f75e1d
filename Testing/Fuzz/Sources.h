// SPDX-License-Identifier: BSD-3-Clause
// Sources of pipelines: one that makes the requested part of a volume, and one whose mesh varies in
// time.
#ifndef Fuzz_Sources_h
#define Fuzz_Sources_h

#include <vtkDataObject.h>
#include <vtkImageAlgorithm.h>
#include <vtkImageData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridAlgorithm.h>

#include <vector>

namespace fuzz
{

class PartSource : public vtkImageAlgorithm
{
public:
  static PartSource* New();
  vtkTypeMacro(PartSource, vtkImageAlgorithm);

  vtkSmartPointer<vtkImageData> Volume;

protected:
  PartSource() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override;
};

class TimeSource : public vtkUnstructuredGridAlgorithm
{
public:
  static TimeSource* New();
  vtkTypeMacro(TimeSource, vtkUnstructuredGridAlgorithm);

  /// One mesh for each time step. Times are 0, 1, 2...
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> Steps;

protected:
  TimeSource() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* output) override;
};

} // namespace fuzz

#endif
