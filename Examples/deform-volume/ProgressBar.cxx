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
  if (percent == this->LastPercent)
  {
    return;
  }
  this->LastPercent = percent;
  constexpr int width = 40;
  const std::string done(static_cast<std::size_t>(percent * width / 100), '#');
  std::fprintf(
    stderr, "\r\033[K%-16s [%-*s] %3d %%", this->Label.c_str(), width, done.c_str(), percent);
  std::fflush(stderr);
}
