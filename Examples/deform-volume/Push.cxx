// SPDX-License-Identifier: BSD-3-Clause
#include "Push.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>

bool Push::Folds() const
{
  // The profile (1 - t^2)^2 falls most steeply at t^2 = 1/3.
  const double steepest = 8.0 / (3.0 * std::sqrt(3.0));
  return vtkMath::Norm(this->Displacement.data()) * steepest >= this->Radius;
}

long long ApplyPushes(const std::vector<Push>& pushes, vtkUnstructuredGrid* mesh)
{
  const vtkIdType numberOfNodes = mesh->GetNumberOfPoints();
  vtkNew<vtkDoubleArray> displacements;
  displacements->SetName(PushArrayName);
  displacements->SetNumberOfComponents(3);
  displacements->SetNumberOfTuples(numberOfNodes);
  long long moved = 0;
  for (vtkIdType node = 0; node < numberOfNodes; ++node)
  {
    double position[3];
    mesh->GetPoint(node, position);
    double sum[3] = { 0.0, 0.0, 0.0 };
    bool moves = false;
    for (const Push& push : pushes)
    {
      const double t2 =
        vtkMath::Distance2BetweenPoints(position, push.Center.data()) / (push.Radius * push.Radius);
      if (t2 < 1.0)
      {
        const double weight = (1.0 - t2) * (1.0 - t2);
        for (int axis = 0; axis < 3; ++axis)
        {
          sum[axis] += weight * push.Displacement[axis];
        }
        moves = true;
      }
    }
    displacements->SetTypedTuple(node, sum);
    moved += moves;
  }
  mesh->GetPointData()->AddArray(displacements);
  mesh->GetPointData()->SetActiveVectors(PushArrayName);
  return moved;
}

double GetLongestEdge(const Push& push, vtkUnstructuredGrid* mesh)
{
  double longest = 0.0;
  vtkCellArray* cells = mesh->GetCells();
  vtkIdType size;
  const vtkIdType* ids;
  for (cells->InitTraversal(); cells->GetNextCell(size, ids);)
  {
    for (vtkIdType i = 0; i < size; ++i)
    {
      double end[3];
      mesh->GetPoint(ids[i], end);
      if (vtkMath::Distance2BetweenPoints(end, push.Center.data()) >= push.Radius * push.Radius)
      {
        continue;
      }
      for (vtkIdType j = 0; j < size; ++j)
      {
        double other[3];
        mesh->GetPoint(ids[j], other);
        longest = std::max(longest, vtkMath::Distance2BetweenPoints(end, other));
      }
    }
  }
  return std::sqrt(longest);
}
