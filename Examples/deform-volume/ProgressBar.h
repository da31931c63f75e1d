// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgressBar_h
#define DeformVolumeProgressBar_h

#include <string>

class vtkAlgorithm;
class vtkObject;

/// Shows the progress of an algorithm in a line of the terminal, which begins with the algorithm's
/// progress text, or else with the label. The destructor erases the line. Nothing is shown if
/// standard error is not a terminal, or if `wanted` is false.
class ProgressBar
{
public:
  ProgressBar(vtkAlgorithm* algorithm, const std::string& label, bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

private:
  void Show(vtkObject* caller, unsigned long event, void* data);

  vtkAlgorithm* Algorithm;
  std::string Label;
  unsigned long Observer = 0;
  int LastPercent = -1;
  std::string LastLabel;
};

#endif
