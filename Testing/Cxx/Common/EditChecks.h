// SPDX-License-Identifier: BSD-3-Clause
// Sheets, labels and checks for the tests of vtkCutVolume and vtkCarveVolume.
#ifndef EditChecks_h
#define EditChecks_h

#include "ArrayMaking.h"
#include "FilterTesting.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPolyData.h>
#include <vtkShortArray.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace filterTesting
{

/// The volumes of most tests of vtkCutVolume and of vtkCarveVolume.
constexpr Extent CutBox{ { 0, 8, 0, 8, 0, 8 } };
constexpr Extent CarvedBox{ { -2, 14, 0, 13, 1, 15 } };

inline int CountActive(const std::vector<unsigned char>& mask)
{
  int count = 0;
  for (const unsigned char byte : mask)
  {
    for (int t = 0; t < 5; ++t)
    {
      count += byte >> t & 1;
    }
  }
  return count;
}

/// A sheet of triangles. Each three points are one triangle, in continuous indices of the volume.
inline vtkSmartPointer<vtkPolyData> MakeSheet(
  vtkImageData* volume, const std::vector<glm::dvec3>& indices)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  auto sheet = vtkSmartPointer<vtkPolyData>::New();
  sheet->AllocateEstimate(static_cast<vtkIdType>(indices.size() / 3), 3);
  for (std::size_t i = 0; i < indices.size(); ++i)
  {
    const glm::dvec3 point = GetWorld(volume, indices[i]);
    points->InsertNextPoint(&point.x);
    if (i % 3 == 2)
    {
      const auto last = static_cast<vtkIdType>(i);
      const vtkIdType ids[3] = { last - 2, last - 1, last };
      sheet->InsertNextCell(VTK_TRIANGLE, 3, ids);
    }
  }
  sheet->SetPoints(points);
  return sheet;
}

/// A parallelogram with a corner and the edges u and v, in continuous indices.
inline vtkSmartPointer<vtkPolyData> MakePlane(
  vtkImageData* volume, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v)
{
  return MakeSheet(
    volume, { corner, corner + u, corner + u + v, corner + u + v, corner, corner + v });
}

inline vtkSmartPointer<vtkPolyData> MakePlaneX(vtkImageData* volume, double x)
{
  return MakePlane(volume, glm::dvec3(x, -50, -50), glm::dvec3(0, 120, 0), glm::dvec3(0, 0, 120));
}

/// Adds an array "label", and returns it: 7 where x is greater than 5.5, elsewhere 3.
inline vtkSmartPointer<vtkShortArray> AddLabels(vtkImageData* volume)
{
  auto labels = MakeArray<vtkShortArray>("label", volume->GetNumberOfPoints());
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    labels->SetValue(id, GetPoint(volume, id).x > 5.5 ? 7 : 3);
  }
  volume->GetPointData()->AddArray(labels);
  return labels;
}

/// A filter that edits active tetrahedra.
template <typename FilterT>
struct Edited : Observed<FilterT>
{
  /// Updates the filter and checks that it reports no error and no warning.
  void Update()
  {
    this->Filter->Update();
    EXPECT_EQ(this->Observer->GetErrorMessage(), "");
    EXPECT_EQ(this->Observer->GetWarningMessage(), "");
    this->ClearMessages();
  }

  /// Updates the filter twice. Each time it must report one error that contains these words, and
  /// have an empty output.
  void Fails(const std::string& words)
  {
    this->Filter->Modified();
    this->VerifyFailure(words);
  }

  std::vector<unsigned char> CopyMask()
  {
    this->Update();
    auto* array = vtkUnsignedCharArray::SafeDownCast(
      this->Filter->GetOutput()->GetCellData()->GetArray("ActiveTetrahedra"));
    EXPECT_NE(array, nullptr);
    std::vector<unsigned char> mask;
    if (array)
    {
      mask.resize(static_cast<std::size_t>(array->GetNumberOfTuples()));
      std::copy_n(array->GetPointer(0), mask.size(), mask.begin());
    }
    return mask;
  }

  /// The number of tetrahedra that are switched off, in a volume whose tetrahedra were all active.
  int CountOff()
  {
    const std::vector<unsigned char> mask = this->CopyMask();
    const int off = 5 * static_cast<int>(mask.size()) - CountActive(mask);
    EXPECT_EQ(this->Filter->GetNumberOfSwitchedOffTetrahedra(), off);
    return off;
  }
};

/// An aborted update has an empty output and reports no error. The next update makes the edits.
/// edit: sets the edits of a filter.
template <typename FilterT>
void CheckAborts(const std::function<void(FilterT*, vtkImageData*)>& edit)
{
  const auto volume = MakeVolume({ { 0, 60, 0, 60, 0, 40 } });
  Edited<FilterT> whole;
  whole.Filter->SetInputData(volume);
  edit(whole.Filter, volume);
  const std::vector<unsigned char> expected = whole.CopyMask();
  EXPECT_LT(CountActive(expected), 5 * static_cast<int>(expected.size()));
  Edited<FilterT> aborted;
  aborted.Filter->SetInputData(volume);
  edit(aborted.Filter, volume);
  aborted.Abort();
  EXPECT_EQ(aborted.Filter->GetNumberOfSwitchedOffTetrahedra(), 0);
  EXPECT_EQ(aborted.CopyMask(), expected);
}

} // namespace filterTesting

#endif
