// SPDX-License-Identifier: BSD-3-Clause
// A vtkDeformVolumeFilter under test, whose messages are kept.
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

/// Keeps messages of objects without an observer. There should be none.
class StrayMessages : public vtkOutputWindow
{
public:
  static StrayMessages* New();
  vtkTypeMacro(StrayMessages, vtkOutputWindow);
  void DisplayText(const char* text) override;

  /// Returns the messages since the last call.
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

  /// Updates the filter. part: the requested extent, or null for the whole output; time: the
  /// requested time, or null.
  Outcome Update(const int* part, const double* time);

  vtkDeformVolumeFilter* GetFilter() { return this->Filter; }

private:
  vtkNew<vtkDeformVolumeFilter> Filter;
  vtkNew<Messages> Said;
};

} // namespace fuzz

#endif
