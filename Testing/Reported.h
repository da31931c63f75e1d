// SPDX-License-Identifier: BSD-3-Clause
// Reads numbers from the text of vtkDeformVolumeFilter::GetSummary().
#ifndef Reported_h
#define Reported_h

#include <vtkDeformVolumeFilter.h>
#include <vtkType.h>

#include <algorithm>
#include <stdexcept>
#include <string>

/// Returns the seconds in the line "name: seconds" of the summary. Throws if there is no such line.
inline double GetReportedSeconds(vtkDeformVolumeFilter* filter, const std::string& name)
{
  const std::string summary = "\n" + filter->GetSummary() + "\n";
  const std::size_t begin = summary.find("\n" + name + ": ");
  if (begin == std::string::npos)
  {
    throw std::runtime_error("The summary has no line \"" + name + "\":" + summary);
  }
  const std::size_t value = begin + name.size() + 3;
  std::string text = summary.substr(value, summary.find('\n', value) - value);
  text.erase(std::remove(text.begin(), text.end(), ','), text.end());
  return std::stod(text);
}

/// Returns the count in the line "name: count"; 0 before the first execution.
inline vtkIdType GetReported(vtkDeformVolumeFilter* filter, const std::string& name)
{
  return filter->GetSummary().empty() ? 0
                                      : static_cast<vtkIdType>(GetReportedSeconds(filter, name));
}

#endif
