// SPDX-License-Identifier: BSD-3-Clause
// Checks for the tests of vtkTetGenMesher and vtkLatticeTetrahedraSource.
#ifndef DeformVolumeMeshChecks_h
#define DeformVolumeMeshChecks_h

#include "HasPart.h"

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
    EXPECT_TRUE(HasPart(this->ExecutiveErrors->GetErrorMessage(), text));
    this->VerifyEmpty(text);
  }

  void Succeeds()
  {
    this->Update();
    EXPECT_FALSE(this->Errors->GetError()) << this->Errors->GetErrorMessage();
    EXPECT_FALSE(this->Errors->GetWarning()) << this->Errors->GetWarningMessage();
    EXPECT_FALSE(this->ExecutiveErrors->GetError()) << this->ExecutiveErrors->GetErrorMessage();
  }

  /// There is no error, and a warning that contains the text.
  void Warns(const std::string& text)
  {
    this->Update();
    EXPECT_FALSE(this->Errors->GetError()) << this->Errors->GetErrorMessage();
    EXPECT_TRUE(HasPart(this->Errors->GetWarningMessage(), text));
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
    EXPECT_FALSE(this->Algorithm->GetExecutive()->Update());
    EXPECT_EQ(this->Counter->Count, 1);
    const std::string message = this->Errors->GetErrorMessage();
    EXPECT_TRUE(std::any_of(texts.begin(), texts.end(),
      [&](const std::string& text) { return message.find(text) != std::string::npos; }))
      << "expected \"" << texts.front() << "\" instead of \"" << message << "\"";
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
    EXPECT_EQ(output ? output->GetNumberOfCells() : 0, 0) << "after the error: " << text;
    EXPECT_EQ(output ? output->GetNumberOfPoints() : 0, 0) << "after the error: " << text;
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
  double LongestEdge = 0.0;
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
      ADD_FAILURE() << "Cell " << cell << " has the type " << mesh->GetCellType(cell) << " and "
                    << size << " points instead of VTK_TETRA and 4";
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
        summary.LongestEdge = std::max(summary.LongestEdge, length);
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
