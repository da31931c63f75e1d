// SPDX-License-Identifier: BSD-3-Clause
// Checks for the tests of vtkTetGenMesher and vtkLatticeTetrahedraSource.
#ifndef DeformVolumeMeshChecks_h
#define DeformVolumeMeshChecks_h

#include "../Common/CheckedCondition.h"

#include <vtkAlgorithm.h>
#include <vtkCellArray.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkTestErrorObserver.h>
#include <vtkUnstructuredGrid.h>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace meshChecks
{

inline int& Failures()
{
  static int failures = 0;
  return failures;
}

#define VERIFY(condition) CHECK_CONDITION(condition, meshChecks::Failures())

#define VERIFY_CONTAINS(text, part)                                                                \
  do                                                                                               \
  {                                                                                                \
    const std::string foundText = (text);                                                          \
    const std::string expectedPart = (part);                                                       \
    if (foundText.find(expectedPart) == std::string::npos)                                         \
    {                                                                                              \
      ++meshChecks::Failures();                                                                    \
      std::cerr << __FILE__ << ':' << __LINE__ << ": expected a text with \"" << expectedPart      \
                << "\" instead of \"" << foundText << "\"\n";                                      \
    }                                                                                              \
  } while (false)

#define VERIFY_NEAR(value, expected, tolerance)                                                    \
  do                                                                                               \
  {                                                                                                \
    const double found = (value);                                                                  \
    if (!(std::abs(found - (expected)) <= (tolerance)))                                            \
    {                                                                                              \
      ++meshChecks::Failures();                                                                    \
      std::cerr << __FILE__ << ':' << __LINE__ << ": " << #value << " is " << found                \
                << ", expected " << (expected) << " within " << (tolerance) << '\n';               \
    }                                                                                              \
  } while (false)

/// Updates an algorithm, and checks that it reports one error that contains a text, and has an
/// empty output.
class FailureCheck
{
public:
  explicit FailureCheck(vtkAlgorithm* algorithm)
    : Algorithm(algorithm)
  {
    algorithm->AddObserver(vtkCommand::ErrorEvent, this->Errors);
    algorithm->AddObserver(vtkCommand::ErrorEvent, this->Counter);
    algorithm->AddObserver(vtkCommand::WarningEvent, this->Errors);
    // The executive reports each failure again.
    algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, this->ExecutiveErrors);
  }

  void Fails(const std::string& text) { this->FailsWithAny({ text }); }

  /// For messages that contain the output of a program, which differs between its versions.
  void FailsWithAny(const std::vector<std::string>& texts)
  {
    this->Algorithm->Modified();
    this->VerifyFailure(texts);
    this->VerifyFailure(texts); // the error is reported again, although nothing has changed
  }

  /// The executive reports the error.
  void IsRefused(const std::string& text)
  {
    this->Update();
    if (this->ExecutiveErrors->GetErrorMessage().find(text) == std::string::npos)
    {
      ++Failures();
      std::cerr << "Expected the error of the executive \"" << text << "\", got "
                << this->ExecutiveErrors->GetErrorMessage() << '\n';
    }
    this->VerifyEmpty(text);
  }

  void Succeeds()
  {
    this->Update();
    if (this->Errors->GetError() || this->Errors->GetWarning() || this->ExecutiveErrors->GetError())
    {
      ++Failures();
      std::cerr << "Expected no error and no warning, got: " << this->Errors->GetErrorMessage()
                << this->Errors->GetWarningMessage() << this->ExecutiveErrors->GetErrorMessage()
                << '\n';
    }
  }

  /// There is no error, and a warning that contains the text.
  void Warns(const std::string& text)
  {
    this->Update();
    if (this->Errors->GetError() ||
      this->Errors->GetWarningMessage().find(text) == std::string::npos)
    {
      ++Failures();
      std::cerr << "Expected a warning with \"" << text
                << "\", got: " << this->Errors->GetErrorMessage()
                << this->Errors->GetWarningMessage() << '\n';
    }
  }

private:
  class CountingObserver : public vtkCommand
  {
  public:
    static CountingObserver* New() { return new CountingObserver; }
    void Execute(vtkObject*, unsigned long, void*) override { ++this->Count; }
    int Count = 0;
  };

  void VerifyFailure(const std::vector<std::string>& texts)
  {
    this->Clear();
    const bool updated = this->Algorithm->GetExecutive()->Update() != 0;
    const std::string message = this->Errors->GetErrorMessage();
    if (updated || this->Counter->Count != 1 ||
      std::none_of(texts.begin(), texts.end(),
        [&](const std::string& text) { return message.find(text) != std::string::npos; }))
    {
      ++Failures();
      std::cerr << "Expected one error with \"" << texts.front() << "\", got "
                << this->Counter->Count << ": " << message << '\n';
    }
    this->VerifyEmpty(texts.front());
  }

  void Clear()
  {
    this->Errors->Clear();
    this->ExecutiveErrors->Clear();
    this->Counter->Count = 0;
  }

  void Update()
  {
    this->Clear();
    this->Algorithm->Modified();
    this->Algorithm->Update();
  }

  void VerifyEmpty(const std::string& text)
  {
    auto* output = vtkUnstructuredGrid::SafeDownCast(this->Algorithm->GetOutputDataObject(0));
    if (output && (output->GetNumberOfCells() || output->GetNumberOfPoints()))
    {
      ++Failures();
      std::cerr << "Expected an empty output after the error \"" << text << "\", got "
                << output->GetNumberOfCells() << " cells and " << output->GetNumberOfPoints()
                << " points\n";
    }
  }

  vtkAlgorithm* Algorithm;
  vtkNew<vtkTest::ErrorObserver> Errors;
  vtkNew<vtkTest::ErrorObserver> ExecutiveErrors;
  vtkNew<CountingObserver> Counter;
};

struct Summary
{
  double Volume = 0.0;
  double SmallestVolume = std::numeric_limits<double>::infinity();
  glm::dvec3 Centroid = glm::dvec3(0.0);
  vtkIdType BoundaryFaces = 0;
  vtkIdType OverusedFaces = 0;     // shared by more than two tetrahedra
  vtkIdType OpenBoundaryEdges = 0; // that belong to an odd number of boundary faces
  double MeanEdge = 0.0;
  double PoorShare = 0.0; // the share of tetrahedra with a radius-edge ratio over 2
};

inline Summary Summarize(vtkUnstructuredGrid* mesh)
{
  Summary summary;
  std::map<std::array<vtkIdType, 3>, int> faces;
  double edges = 0.0;
  vtkIdType poor = 0;
  const vtkIdType count = mesh->GetNumberOfCells();
  for (vtkIdType cell = 0; cell < count; ++cell)
  {
    vtkIdType size;
    const vtkIdType* ids;
    mesh->GetCellPoints(cell, size, ids);
    if (mesh->GetCellType(cell) != VTK_TETRA || size != 4)
    {
      ++Failures();
      std::cerr << "Cell " << cell << " has the type " << mesh->GetCellType(cell) << " and " << size
                << " points instead of VTK_TETRA and 4\n";
      return summary;
    }
    glm::dvec3 p[4];
    for (int k = 0; k < 4; ++k)
    {
      double point[3];
      mesh->GetPoint(ids[k], point);
      p[k] = glm::dvec3(point[0], point[1], point[2]);
      std::array<vtkIdType, 3> face = { ids[(k + 1) % 4], ids[(k + 2) % 4], ids[(k + 3) % 4] };
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
    const glm::dvec3 a = p[1] - p[0];
    const glm::dvec3 b = p[2] - p[0];
    const glm::dvec3 c = p[3] - p[0];
    const double six = glm::dot(glm::cross(a, b), c);
    summary.Volume += six / 6.0;
    summary.SmallestVolume = std::min(summary.SmallestVolume, six / 6.0);
    summary.Centroid += six / 24.0 * (p[0] + p[1] + p[2] + p[3]);
    double shortest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 4; ++i)
    {
      for (int j = 0; j < i; ++j)
      {
        const double length = glm::distance(p[i], p[j]);
        edges += length;
        shortest = std::min(shortest, length);
      }
    }
    const glm::dvec3 toCenter =
      (glm::dot(a, a) * glm::cross(b, c) + glm::dot(b, b) * glm::cross(c, a) +
        glm::dot(c, c) * glm::cross(a, b)) /
      (2.0 * six);
    poor += glm::length(toCenter) / shortest > 2.0;
  }
  std::map<std::array<vtkIdType, 2>, int> boundaryEdges;
  for (const auto& [face, uses] : faces)
  {
    summary.OverusedFaces += uses > 2;
    if (uses == 1)
    {
      ++summary.BoundaryFaces;
      ++boundaryEdges[{ face[0], face[1] }];
      ++boundaryEdges[{ face[1], face[2] }];
      ++boundaryEdges[{ face[0], face[2] }];
    }
  }
  for (const auto& [edge, uses] : boundaryEdges)
  {
    summary.OpenBoundaryEdges += uses % 2;
  }
  summary.Centroid /= summary.Volume;
  summary.MeanEdge = edges / (6.0 * count);
  summary.PoorShare = static_cast<double>(poor) / count;
  return summary;
}

} // namespace meshChecks

#endif
