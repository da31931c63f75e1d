// SPDX-License-Identifier: BSD-3-Clause
#include "MeshReading.h"

#include "Failure.h"
#include "Files.h"
#include "MeshContents.h"
#include "MeshFormats.h"
#include "MeshSpace.h"
#include "Messages.h"
#include "NetcdfFile.h"
#include "Options.h"
#include "ProgressBar.h"
#include "SheetFile.h"
#include "Volume.h"

#include <vtkAlgorithm.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkSTLReader.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>
#include <vtkVersionMacros.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLGenericDataObjectReader.h>
#include <vtkXMLPartitionedDataSetCollectionReader.h>
#include <vtkXMLPartitionedDataSetReader.h>
#include <vtkXMLUtilities.h>
#include <vtksys/SystemTools.hxx>

#ifdef DEFORMVOLUME_HAVE_EXODUS
#include <vtkExodusIIReader.h>
#endif
#ifdef DEFORMVOLUME_HAVE_VTKHDF
#include <vtkHDFReader.h>
#include <vtk_hdf5.h>
#endif

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>

namespace
{
/// A file to read, and parameters of reading it.
struct Source
{
  std::string Path;
  const char* Label;
  Messages& Log;
  bool ShowProgress;
  /// Whether displacements will be added to the points.
  bool PointsAreAtRest = false;
  /// Whether the first time step is read instead of the last one.
  bool IsFirst = false;
};

void CheckReading(const Source& source, const std::string& format)
{
  const std::string words = source.Log.TakeError();
  if (!words.empty())
  {
    // VTK's messages about infinite numbers in XML files name classes. In text of legacy files it
    // cannot read such numbers.
    const bool mayBeInfinite =
      NamesCode(words) || words.find("Error reading ascii data") != std::string::npos;
    throw Failure("cannot read " + source.Path + ": it is not a valid " + format +
      ", or it is damaged or cut off" +
      (mayBeInfinite ? ", or has numbers that are not finite" : " (" + words + ")"));
  }
}

/// Calls Messages::BeginReading() and Messages::EndReading().
class Reading
{
public:
  explicit Reading(Messages& log)
    : Log(log)
  {
    log.BeginReading();
  }
  ~Reading() { this->Log.EndReading(); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

private:
  Messages& Log;
};

void WarnOfSteps(const Source& source, std::size_t steps, double time)
{
  source.Log.Warn(MakeText(source.Path, " holds ", steps, " time steps; the ",
    source.IsFirst ? "first" : "last", " one, of the time ", time, ", is read."));
}

void Update(vtkAlgorithm* reader, const Source& source, const std::string& format)
{
  const ProgressBar bar(reader, source.Label, source.ShowProgress);
  const Reading reading(source.Log);
  reader->UpdateInformation();
  CheckReading(source, format);
  vtkInformation* information = reader->GetOutputInformation(0);
  const int steps = information->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
  if (steps > 1)
  {
    const double time = information->Get(
      vtkStreamingDemandDrivenPipeline::TIME_STEPS(), source.IsFirst ? 0 : steps - 1);
    WarnOfSteps(source, steps, time);
    reader->UpdateTimeStep(time);
  }
  else
  {
    reader->Update();
  }
  CheckReading(source, format);
}

template <typename Reader>
vtkSmartPointer<vtkDataObject> ReadBy(
  Reader* reader, const Source& source, const std::string& format)
{
  reader->SetFileName(source.Path.c_str());
  Update(reader, source, format);
  return reader->GetOutputDataObject(0);
}

vtkSmartPointer<vtkDataObject> ReadXML(const Source& source)
{
  const char* const format = "XML file of VTK";
  // Before VTK 9.2 the generic reader does not know these types.
  if (HasSuffix(source.Path, { ".vtpc" }))
  {
    vtkNew<vtkXMLPartitionedDataSetCollectionReader> reader;
    return ReadBy(reader.Get(), source, format);
  }
  if (HasSuffix(source.Path, { ".vtpd" }))
  {
    vtkNew<vtkXMLPartitionedDataSetReader> reader;
    return ReadBy(reader.Get(), source, format);
  }
  vtkNew<vtkXMLGenericDataObjectReader> reader;
  return ReadBy(reader.Get(), source, format);
}

vtkSmartPointer<vtkDataObject> ReadLegacy(const Source& source)
{
  vtkNew<vtkGenericDataObjectReader> reader;
  reader->ReadAllScalarsOn();
  reader->ReadAllVectorsOn();
  reader->ReadAllNormalsOn();
  reader->ReadAllTensorsOn();
  reader->ReadAllColorScalarsOn();
  reader->ReadAllTCoordsOn();
  reader->ReadAllFieldsOn();
  const vtkSmartPointer<vtkDataObject> data = ReadBy(reader.Get(), source, "legacy file of VTK");
  const std::string header = reader->GetHeader() ? reader->GetHeader() : "";
  KeepSpace(data, header.c_str());
  // FEBio Studio writes this header. FEBio writes "time 0.5" and points at rest.
  if (source.PointsAreAtRest && header.rfind("vtk output at time", 0) == 0)
  {
    source.Log.Warn(source.Path +
      " is an export of FEBio Studio, which writes deformed points. Give --points-are-deformed; "
      "without that option, the displacements are added twice.");
  }
  return data;
}

bool BeginsWith(const std::string& path, std::initializer_list<std::string> beginnings)
{
  std::string first(8, '\0');
  std::ifstream(path, std::ios::binary).read(&first[0], 8);
  for (const std::string& beginning : beginnings)
  {
    if (first.compare(0, beginning.size(), beginning) == 0)
    {
      return true;
    }
  }
  return false;
}

#ifdef DEFORMVOLUME_HAVE_EXODUS
vtkSmartPointer<vtkDataObject> ReadExodus(const Source& source)
{
  const char* const format = "Exodus file";
  vtkNew<vtkExodusIIReader> reader;
  // Checked first, because the library writes to standard error if a file has another format.
  if (!BeginsWith(source.Path, { "CDF", "\x89HDF" }) || !reader->CanReadFile(source.Path.c_str()))
  {
    source.Log.DisplayErrorText("It does not begin as netCDF files do");
  }
  else if (BeginsWith(source.Path, { "CDF" }) && IsNetcdfCutOff(source.Path))
  {
    source.Log.DisplayErrorText("It ends before its data do");
  }
  CheckReading(source, format);
  reader->SetFileName(source.Path.c_str());
  reader->ApplyDisplacementsOff();
  reader->UpdateInformation();
  CheckReading(source, format);
  reader->SetAllArrayStatus(vtkExodusIIReader::NODAL, 1);
  for (int i = 0; i < reader->GetNumberOfObjects(vtkExodusIIReader::ELEM_BLOCK); ++i)
  {
    reader->SetObjectStatus(vtkExodusIIReader::ELEM_BLOCK, i, 1);
  }
  return ReadBy(reader.Get(), source, format);
}
#endif

#ifdef DEFORMVOLUME_HAVE_VTKHDF
bool HasTimeSteps(const std::string& path)
{
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0)
  {
    return false;
  }
  const bool hasSteps = H5Lexists(file, "/VTKHDF/Steps", H5P_DEFAULT) > 0;
  H5Fclose(file);
  return hasSteps;
}

vtkSmartPointer<vtkDataObject> ReadHDF(const Source& source)
{
  const char* const format = "VTKHDF file that VTK " VTK_VERSION " reads";
  // Do not let the library write its error stack to standard error.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  vtkNew<vtkHDFReader> reader;
  if (!BeginsWith(source.Path, { "\x89HDF" }) || !reader->CanReadFile(source.Path.c_str()))
  {
    source.Log.DisplayErrorText("It does not begin as HDF5 files of VTK do");
  }
  CheckReading(source, format);
  reader->SetFileName(source.Path.c_str());
  reader->UpdateInformation();
  CheckReading(source, format);
  // Readers of earlier versions of VTK read all steps as parts of one mesh.
  if (HasTimeSteps(source.Path) &&
    !reader->GetOutputInformation(0)->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS()))
  {
    throw Failure("cannot read " + source.Path +
      ": it holds time steps, which VTK " VTK_VERSION
      " does not read. Save the last one as .vtu in ParaView (File > Save Data)");
  }
  return ReadBy(reader.Get(), source, format);
}
#endif

vtkSmartPointer<vtkDataObject> ReadMeshFile(const Source& source);

/// Returns the files that a .pvd file names, by time.
std::map<double, std::vector<std::string>> FindFiles(const Source& source)
{
  const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
    vtkXMLUtilities::ReadElementFromFile(source.Path.c_str()));
  CheckReading(source, "collection of files (.pvd)");
  vtkXMLDataElement* collection = root ? root->FindNestedElementWithName("Collection") : nullptr;
  if (!collection)
  {
    throw Failure("cannot read " + source.Path + ": it is not a collection of files (.pvd)");
  }
  std::string folder = vtksys::SystemTools::GetFilenamePath(source.Path);
  folder = folder.empty() ? "." : folder;
  std::map<double, std::vector<std::string>> files;
  std::map<std::pair<double, std::string>, int> counts; // of files with the same time and part
  for (int i = 0; i < collection->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* entry = collection->GetNestedElement(i);
    const char* file = entry->GetAttribute("file");
    if (!file)
    {
      continue;
    }
    double time = 0.0;
    const char* text = entry->GetAttribute("timestep");
    if (text && (!entry->GetScalarAttribute("timestep", time) || !std::isfinite(time)))
    {
      throw Failure("cannot read " + source.Path + ": the time step \"" + text +
        "\" of a file is not a number");
    }
    const char* part = entry->GetAttribute("part");
    ++counts[{ time, part ? part : "" }];
    files[time].push_back(vtksys::SystemTools::CollapseFullPath(file, folder));
  }
  if (files.empty())
  {
    throw Failure("cannot read " + source.Path + ": it names no files");
  }
  for (const auto& [place, count] : counts)
  {
    if (count > 1 && place.first == files.rbegin()->first)
    {
      source.Log.Warn(source.Path + " names " + std::to_string(count) +
        " files with the same attributes timestep and part, or without them. They are read as "
        "parts of one mesh.");
    }
  }
  return files;
}

vtkSmartPointer<vtkDataObject> ReadCollection(const Source& source)
{
  const std::map<double, std::vector<std::string>> files = FindFiles(source);
  const auto& [time, parts] = source.IsFirst ? *files.begin() : *files.rbegin();
  if (files.size() > 1)
  {
    WarnOfSteps(source, files.size(), time);
  }
  vtkNew<vtkMultiBlockDataSet> blocks;
  for (const std::string& part : parts)
  {
    if (HasSuffix(part, { ".pvd" }))
    {
      throw Failure("cannot read " + source.Path + ": it names another .pvd file, " + part);
    }
    const unsigned int block = blocks->GetNumberOfBlocks();
    blocks->SetBlock(block,
      ReadMeshFile({ part, source.Label, source.Log, source.ShowProgress, source.PointsAreAtRest,
        source.IsFirst }));
    blocks->GetMetaData(block)->Set(
      vtkCompositeDataSet::NAME(), vtksys::SystemTools::GetFilenameName(part).c_str());
  }
  return parts.size() == 1 ? vtkSmartPointer<vtkDataObject>(blocks->GetBlock(0)) : blocks;
}

/// A function that reads files with one of some suffixes.
struct Format
{
  std::vector<const char*> Suffixes;
  vtkSmartPointer<vtkDataObject> (*Read)(const Source& source);
};

/// advice: the message for a file in none of the formats.
vtkSmartPointer<vtkDataObject> ReadInFormat(
  const Source& source, const std::vector<Format>& formats, const std::string& advice)
{
  CheckReadable(source.Path);
  for (const Format& format : formats)
  {
    if (HasSuffix(source.Path, format.Suffixes))
    {
      return format.Read(source);
    }
  }
  throw Failure("cannot read " + source.Path + advice);
}

vtkSmartPointer<vtkDataObject> ReadMeshFile(const Source& source)
{
  const std::vector<Format> formats{
    { { ".vtu", ".pvtu", ".vtm", ".vtmb", ".vts", ".pvts", ".vtr", ".pvtr", ".vti", ".pvti",
        ".vtpd", ".vtpc", ".vtp", ".pvtp" },
      ReadXML },
    { { ".vtk" }, ReadLegacy },
    { { ".pvd" }, ReadCollection },
#ifdef DEFORMVOLUME_HAVE_EXODUS
    { { ".e", ".exo", ".ex2" }, ReadExodus },
#endif
#ifdef DEFORMVOLUME_HAVE_VTKHDF
    { { ".vtkhdf" }, ReadHDF },
#endif
  };
  return ReadInFormat(source, formats,
    " as a mesh: a mesh is a file of the types " + GetMeshSuffixes() +
      ", or a displacement field (.vti). " + GetMeshConversion(source.Path));
}

vtkSmartPointer<vtkDataObject> ReadSTL(const Source& source)
{
  const char* const format = "STL file";
  if (IsStlCutOff(source.Path))
  {
    source.Log.DisplayErrorText("It ends before its triangles do");
  }
  CheckReading(source, format);
  vtkNew<vtkSTLReader> reader;
  const vtkSmartPointer<vtkDataObject> sheet = ReadBy(reader.Get(), source, format);
  KeepSpace(sheet, reader->GetHeader());
  return sheet;
}

vtkSmartPointer<vtkDataObject> ReadPLY(const Source& source)
{
  const char* const format = "PLY file";
  if (IsPlyCutOff(source.Path))
  {
    source.Log.DisplayErrorText("It ends before its header or its elements do");
  }
  CheckReading(source, format);
  vtkNew<vtkPLYReader> reader;
  const vtkSmartPointer<vtkDataObject> sheet = ReadBy(reader.Get(), source, format);
  for (vtkIdType i = 0; i < reader->GetComments()->GetNumberOfValues(); ++i)
  {
    KeepSpace(sheet, reader->GetComments()->GetValue(i).c_str());
  }
  return sheet;
}

vtkSmartPointer<vtkDataObject> ReadOBJ(const Source& source)
{
  vtkNew<vtkOBJReader> reader;
  const vtkSmartPointer<vtkDataObject> sheet = ReadBy(reader.Get(), source, "OBJ file");
  KeepSpace(sheet, reader->GetComment());
  return sheet;
}

vtkSmartPointer<vtkDataObject> ReadSheetFile(const Source& source)
{
  const std::vector<Format> formats{ { { ".vtp", ".pvtp" }, ReadXML }, { { ".vtk" }, ReadLegacy },
    { { ".stl" }, ReadSTL }, { { ".ply" }, ReadPLY }, { { ".obj" }, ReadOBJ } };
  return ReadInFormat(source, formats,
    " as a sheet: a sheet is a file of the types " + GetSheetSuffixes() + ". " +
      GetSheetConversion(source.Path));
}
}

vtkSmartPointer<vtkDataObject> ReadMesh(const std::string& path, const std::string& displacement,
  bool isRest, const Options& options, const Volume& volume, Messages& messages)
{
  const vtkSmartPointer<vtkDataObject> mesh = ReadMeshFile({ path, "reading mesh", messages,
    !options.Quiet, !displacement.empty() && !options.PointsAreDeformed, isRest });
  CheckMesh(mesh, displacement, path);
  ConvertToWorldOfVolume(mesh, { displacement }, options.MeshSpace, path, volume.Axes, messages);
  return mesh;
}

vtkSmartPointer<vtkPolyData> ReadSheet(
  const std::string& path, const Options& options, const Volume& volume, Messages& messages)
{
  const vtkSmartPointer<vtkDataObject> sheet =
    ReadSheetFile({ path, "reading sheet", messages, !options.Quiet });
  CheckSheet(sheet, path);
  ConvertToWorldOfVolume(sheet, {}, options.MeshSpace, path, volume.Axes, messages);
  return vtkPolyData::SafeDownCast(sheet);
}

vtkSmartPointer<vtkPointSet> ReadGeometry(
  const std::string& path, const Options& options, Messages& messages)
{
  CheckReadable(path);
  const Source source{ path, "reading points", messages, !options.Quiet };
  const vtkSmartPointer<vtkDataObject> object = HasSuffix(path, { ".stl" }) ? ReadSTL(source)
    : HasSuffix(path, { ".ply" })                                           ? ReadPLY(source)
                                                                            : ReadXML(source);
  const bool isSurface = !HasSuffix(path, { ".vtu" });
  if (!object || !object->IsA(isSurface ? "vtkPolyData" : "vtkUnstructuredGrid"))
  {
    throw Failure("cannot read " + path + ": it does not hold " +
      (isSurface ? "polygonal data, as .vtp files do" : "an unstructured grid, as .vtu files do"));
  }
  return vtkPointSet::SafeDownCast(object);
}
