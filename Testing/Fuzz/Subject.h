// SPDX-License-Identifier: BSD-3-Clause
// A vtkDeformVolumeFilter whose updates end in an output or in one error.
#ifndef Fuzz_Subject_h
#define Fuzz_Subject_h

#include "vtkDeformVolumeFilter.h"

#include <vtkCommand.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <array>
#include <string>
#include <vector>

namespace fuzz
{

/// Keeps the messages of an object instead of printing them.
class Messages : public vtkCommand
{
public:
  static Messages* New() { return new Messages; }
  void Execute(vtkObject* caller, unsigned long event, void* data) override;

  std::vector<std::string> Errors;
};

/// Keeps what is said by objects that nobody observes. Nothing should be.
class StrayMessages : public vtkOutputWindow
{
public:
  static StrayMessages* New();
  vtkTypeMacro(StrayMessages, vtkOutputWindow);
  void DisplayText(const char* text) override;

  /// What has been said since the last call.
  std::string Take();

private:
  std::string Texts;
};

struct Outcome
{
  std::vector<std::string> Errors;
  vtkSmartPointer<vtkImageData> Output;
  vtkIdType Covered = 0;
  vtkIdType Inverted = 0;
  vtkIdType Flat = 0;
  int Resampler = 0;
  bool IsPart = false; // only some of its bricks were resampled
};

class Subject
{
public:
  Subject();

  /// part: an extent of the output, or null for all of it; time: null for none.
  Outcome Update(const int* part, const double* time);

  vtkDeformVolumeFilter* GetFilter() { return this->Filter; }

private:
  vtkNew<vtkDeformVolumeFilter> Filter;
  vtkNew<Messages> Said;
};

} // namespace fuzz

#endif
