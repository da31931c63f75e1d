// SPDX-License-Identifier: BSD-3-Clause
#include "PointsFile.h"

#include "Failure.h"
#include "Files.h"
#include "MeshMaking.h"
#include "MeshReading.h"
#include "MeshSpace.h"
#include "Messages.h"
#include "Options.h"
#include "OutputFile.h"
#include "ProgressBar.h"
#include "VTKWriting.h"
#include "Volume.h"

#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDeformGeometryFilter.h>
#include <vtkNew.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkSTLWriter.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cmath>
#include <fstream>

namespace
{
/// The arrays that the filter transforms with the points.
std::vector<std::string> GetTransformedArrays(vtkPointSet* points)
{
  std::vector<std::string> names;
  for (vtkDataArray* array :
    { points->GetPointData()->GetNormals(), points->GetPointData()->GetVectors() })
  {
    if (array && array->GetName())
    {
      names.emplace_back(array->GetName());
    }
  }
  return names;
}

void CheckPoints(vtkPointSet* points, const std::string& path)
{
  if (points->GetNumberOfPoints() == 0)
  {
    throw Failure("cannot use " + path + ": it has no points");
  }
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    const double* point = points->GetPoint(i);
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]) || !std::isfinite(point[2]))
    {
      throw Failure(MakeText("cannot use ", path, ": its point ", i, ", counted from 0, is ",
        point[0], ", ", point[1], ", ", point[2], ", and points must be finite"));
    }
  }
}

void WarnOfCellArrays(vtkPointSet* points, const std::string& path, Messages& messages)
{
  vtkCellData* arrays = points->GetCellData();
  for (vtkDataArray* array : { arrays->GetNormals(), arrays->GetVectors() })
  {
    if (array)
    {
      messages.Warn("The array \"" + std::string(array->GetName() ? array->GetName() : "") +
        "\" of the cells of " + path +
        " is not transformed: only normals and vectors of points are transformed.");
    }
  }
}

vtkSmartPointer<vtkPointSet> Deform(const PointsFile& file, const Options& options,
  const Deformation& deformation, Messages& messages)
{
  vtkNew<vtkDeformGeometryFilter> filter;
  filter->SetInputData(file.Points);
  SetDeformation(filter.Get(), options, deformation);
  // Ignore the filter's warnings, because they name properties of the filter. Warnings about the
  // mesh were printed when the volume was deformed. The warning below replaces the one about points
  // outside the deformation.
  const vtkNew<vtkCallbackCommand> ignored;
  filter->AddObserver(vtkCommand::WarningEvent, ignored);
  const ProgressBar bar(filter, "moving points", !options.Quiet);
  filter->Update();
  messages.Check("cannot move the points of " + file.Path);
  if (filter->GetNumberOfOutsidePoints() > 0)
  {
    messages.Warn(std::to_string(filter->GetNumberOfOutsidePoints()) + " of " +
      std::to_string(file.Points->GetNumberOfPoints()) + " points of " + file.Path +
      " lie outside the deformation. They stay where they are.");
  }
  return filter->GetOutput();
}

bool WriteSTL(vtkPointSet* surface, const std::string& path)
{
  vtkNew<vtkSTLWriter> writer;
  writer->SetFileTypeToBinary();
  writer->SetHeader(("deform-volume. " + GetSpaceComment(surface)).c_str());
  return Write(writer.Get(), surface, path);
}

bool WritePLY(vtkPointSet* surface, const std::string& path)
{
  vtkNew<vtkPLYWriter> writer;
  const std::string space = GetSpaceComment(surface);
  if (!space.empty())
  {
    writer->AddComment(space);
  }
  for (const char* colors : { "RGB", "RGBA" }) // the names of VTK's reader
  {
    if (surface->GetPointData()->HasArray(colors))
    {
      writer->SetArrayName(colors);
      writer->SetEnableAlpha(std::string(colors) == "RGBA");
    }
  }
  return Write(writer.Get(), surface, path);
}

bool WriteVTP(vtkPointSet* surface, const std::string& path)
{
  // If the disk is full, VTK 9.1 crashes while it writes polygons to a file, but not to a string.
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->WriteToOutputStringOn();
  const bool succeeded = WriteXML(writer.Get(), surface, path);
  std::ofstream stream(path, std::ios::binary);
  stream << writer->GetOutputString() << std::flush;
  return succeeded && stream.good();
}

// Writes the moved points of a file, in its format.
bool WritePoints(const PointsFile& file, vtkPointSet* moved, const std::string& path)
{
  if (IsLandmarkFile(path))
  {
    return WriteLandmarks(file.Landmarks, moved, path);
  }
  if (HasSuffix(path, { ".stl" }))
  {
    return WriteSTL(moved, path);
  }
  if (HasSuffix(path, { ".ply" }))
  {
    return WritePLY(moved, path);
  }
  return HasSuffix(path, { ".vtp" })
    ? WriteVTP(moved, path)
    : WriteXML(vtkNew<vtkXMLUnstructuredGridWriter>().Get(), moved, path);
}
}

std::string GetPointFormat(const std::string& path)
{
  for (const char* suffix : { ".vtp", ".vtu", ".stl", ".ply", ".csv", ".mrk.json" })
  {
    if (HasSuffix(path, { suffix }) && (HasJson || !HasSuffix(path, { ".mrk.json" })))
    {
      return suffix;
    }
  }
  return "";
}

std::vector<PointsFile> ReadPoints(const Options& options, const Volume& volume, Messages& messages)
{
  std::vector<PointsFile> files;
  for (const std::string& path : options.Points)
  {
    PointsFile file;
    file.Path = path;
    const bool saysSpace = IsLandmarkFile(path);
    if (saysSpace)
    {
      file.Landmarks = ReadLandmarks(path, messages);
      file.Points = file.Landmarks.Points;
    }
    else
    {
      file.Points = ReadGeometry(path, options, messages);
      WarnOfCellArrays(file.Points, path, messages);
    }
    CheckPoints(file.Points, path);
    file.IsConverted = ConvertToWorldOfVolume(file.Points, GetTransformedArrays(file.Points),
      saysSpace ? "" : options.MeshSpace, path, volume.Axes, messages);
    files.push_back(file);
  }
  return files;
}

void WriteDeformedPoints(const std::vector<PointsFile>& files, const Options& options,
  const Deformation& deformation, Messages& messages)
{
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    const vtkSmartPointer<vtkPointSet> moved = Deform(files[i], options, deformation, messages);
    if (files[i].IsConverted)
    {
      FlipWorldAxes(moved, GetTransformedArrays(moved));
    }
    OutputFile output(options.PointsOutputs[i]);
    output.Finish(messages, WritePoints(files[i], moved, output.GetPath()));
  }
}
