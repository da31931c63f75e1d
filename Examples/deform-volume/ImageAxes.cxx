// SPDX-License-Identifier: BSD-3-Clause
#include "ImageAxes.h"

#include <vtkImageData.h>
#include <vtkMath.h>
#include <vtkMatrix3x3.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

vtkSmartPointer<vtkMatrix4x4> GetAxes(vtkImageData* image)
{
  auto axes = vtkSmartPointer<vtkMatrix4x4>::New();
  int extent[6];
  image->GetExtent(extent);
  double first[3];
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], first);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      axes->SetElement(row, column, image->GetDirectionMatrix()->GetElement(row, column));
    }
    axes->SetElement(row, 3, first[row]);
  }
  return axes;
}

bool SetAxes(vtkImageData* image, vtkMatrix4x4* axes)
{
  double columns[3][3];
  double spacing[3];
  for (int column = 0; column < 3; ++column)
  {
    for (int row = 0; row < 3; ++row)
    {
      columns[column][row] = axes->GetElement(row, column);
    }
    const double length = vtkMath::Normalize(columns[column]);
    if (!(length > 0.0) || !std::isfinite(length))
    {
      return false;
    }
    // Files hold single precision: what is one up to its rounding leaves the spacing as it is.
    const double factor = std::abs(length - 1.0) < 1e-5 ? 1.0 : length;
    spacing[column] = image->GetSpacing()[column] * factor;
  }
  for (int column = 0; column < 3; ++column)
  {
    if (std::abs(vtkMath::Dot(columns[column], columns[(column + 1) % 3])) > 1e-4)
    {
      return false;
    }
  }
  image->SetSpacing(spacing);
  image->SetOrigin(axes->GetElement(0, 3), axes->GetElement(1, 3), axes->GetElement(2, 3));
  image->SetDirectionMatrix(columns[0][0], columns[1][0], columns[2][0], columns[0][1],
    columns[1][1], columns[2][1], columns[0][2], columns[1][2], columns[2][2]);
  return true;
}

void FlipWorldAxes(vtkMatrix4x4* axes)
{
  for (int row = 0; row < 2; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      // Adding zero keeps a negative zero out of the file.
      axes->SetElement(row, column, 0.0 - axes->GetElement(row, column));
    }
  }
}

std::string ReadHeaderField(const std::string& path, const std::string& name, char separator)
{
  // The header ends before the data: in a MetaImage with the field that says where the data are,
  // in an NRRD file with an empty line.
  constexpr int maximumLines = 200;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  for (int i = 0; i < maximumLines && std::getline(file, line); ++i)
  {
    if (!line.empty() && line.back() == '\r')
    {
      line.pop_back();
    }
    if (line.empty() || line.rfind("ElementDataFile", 0) == 0)
    {
      break;
    }
    const std::size_t place = line.find(separator);
    if (place != std::string::npos &&
      line.substr(0, line.find_last_not_of(" \t", place - 1) + 1) == name)
    {
      return line.substr(place + 1);
    }
  }
  return "";
}

std::vector<double> FindNumbers(const std::string& text)
{
  std::vector<double> numbers;
  const char* place = text.c_str();
  while (*place)
  {
    char* end = nullptr;
    const double number = std::strtod(place, &end);
    if (end == place)
    {
      ++place;
      continue;
    }
    numbers.push_back(number);
    place = end;
  }
  return numbers;
}
