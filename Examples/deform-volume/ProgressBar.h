// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeProgressBar_h
#define DeformVolumeProgressBar_h

#include <string>

class vtkAlgorithm;
class vtkObject;

/// A line on the terminal that shows how far an algorithm has come, for as long as this object
/// lives. It begins with the label, or with the algorithm's progress text where there is one. Shows
/// nothing where standard error is no terminal, or where it is not wanted.
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
