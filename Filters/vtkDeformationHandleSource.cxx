// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformationHandleSource.h"

#include "PieceRequest.h"

#include "vtkCellArray.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkDeformationHandleSource);

namespace
{

bool IsFinite(const double position[3])
{
  return std::all_of(position, position + 3, [](double value) { return std::isfinite(value); });
}

} // namespace

vtkDeformationHandleSource::vtkDeformationHandleSource()
{
  this->SetNumberOfInputPorts(0);
}

int vtkDeformationHandleSource::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  outputVector->GetInformationObject(0)->Set(CAN_HANDLE_PIECE_REQUEST(), 1);
  return 1;
}

int vtkDeformationHandleSource::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkPolyData* output = vtkPolyData::GetData(outputVector);
  output->Initialize();
  vtkInformation* info = outputVector->GetInformationObject(0);
  if (!deformvolume::IsFirstPiece(outputVector))
  {
    return 1;
  }
  if (!IsFinite(this->RestPosition) || !IsFinite(this->Position))
  {
    vtkErrorMacro("RestPosition or Position is not finite. Set finite coordinates.");
    info->Set(
      vtkDemandDrivenPipeline::DATA_NOT_GENERATED(), 1); // so that the next update fails, too
    return deformvolume::GetResultOfError(outputVector);
  }
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkIdType point = points->InsertNextPoint(this->Position);
  vtkNew<vtkCellArray> vertices;
  vertices->InsertNextCell(1, &point);
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("RestPosition");
  rest->SetNumberOfComponents(3);
  rest->InsertNextTuple(this->RestPosition);
  output->SetPoints(points);
  output->SetVerts(vertices);
  output->GetPointData()->AddArray(rest);
  return 1;
}

void vtkDeformationHandleSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "RestPosition: " << this->RestPosition[0] << " " << this->RestPosition[1] << " "
     << this->RestPosition[2] << "\n";
  os << indent << "Position: " << this->Position[0] << " " << this->Position[1] << " "
     << this->Position[2] << "\n";
}
