// SPDX-License-Identifier: BSD-3-Clause
#include "ProgressBar.h"

#include <vtkAlgorithm.h>
#include <vtkCommand.h>

#include <algorithm>
#include <cstdio>
#include <unistd.h>

ProgressBar::ProgressBar(vtkAlgorithm* algorithm, const std::string& label, bool wanted)
  : Algorithm(algorithm)
  , Label(label)
{
  if (wanted && isatty(STDERR_FILENO))
  {
    this->Observer = algorithm->AddObserver(vtkCommand::ProgressEvent, this, &ProgressBar::Show);
  }
}

ProgressBar::~ProgressBar()
{
  if (this->Observer)
  {
    this->Algorithm->RemoveObserver(this->Observer);
    std::fputs("\r\033[K", stderr);
  }
}

void ProgressBar::Show(vtkObject*, unsigned long, void*)
{
  const int percent = std::clamp(static_cast<int>(100.0 * this->Algorithm->GetProgress()), 0, 100);
  const char* text = this->Algorithm->GetProgressText();
  const std::string label = text ? text : this->Label;
  if (percent == this->LastPercent && label == this->LastLabel)
  {
    return;
  }
  this->LastPercent = percent;
  this->LastLabel = label;
  constexpr int width = 40;
  const std::string done(static_cast<std::size_t>(percent * width / 100), '#');
  std::fprintf(stderr, "\r\033[K%-17s [%-*s] %3d %%", label.c_str(), width, done.c_str(), percent);
  std::fflush(stderr);
}
