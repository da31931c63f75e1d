// SPDX-License-Identifier: BSD-3-Clause
// deform-volume: deforms a volume from the command line.
#include "Coverage.h"
#include "Failure.h"
#include "Files.h"
#include "ImageAxes.h"
#include "LabelVolume.h"
#include "MapWriting.h"
#include "MeshMaking.h"
#include "Messages.h"
#include "Movie.h"
#include "Options.h"
#include "Picture.h"
#include "PointsFile.h"
#include "ProgressBar.h"
#include "TimingTable.h"
#include "VolumeReading.h"
#include "VolumeWriting.h"
#include "WorldSpace.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDeformVolumeFilter.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <optional>
#include <unistd.h>

namespace
{
void ListDevices()
{
  const auto names = vtkSmartPointer<vtkStringArray>::Take(vtkDeformVolumeFilter::GetDeviceNames());
  if (names->GetNumberOfValues() == 0)
  {
    throw Failure("there is no OpenCL device. Install an OpenCL driver, such as PoCL for CPUs (on "
                  "Debian and Ubuntu the package pocl-opencl-icd)");
  }
  for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i)
  {
    std::cout << names->GetValue(i) << "\n";
  }
}

// Reports files that cannot be written before the long computations begin.
void CheckOutputs(const Options& options)
{
  for (const NamedFile& output : options.GetOutputs())
  {
    const std::string& path = output.Path;
    std::string folder = vtksys::SystemTools::GetFilenamePath(path);
    folder = !folder.empty() ? folder : path[0] == '/' ? "/" : ".";
    if (!vtksys::SystemTools::FileIsDirectory(folder))
    {
      throw Failure("cannot write " + path + ": there is no folder " + folder);
    }
    if (vtksys::SystemTools::FileIsDirectory(path))
    {
      throw Failure("cannot write " + path + ": there is a folder of this name");
    }
    if (vtksys::SystemTools::FileIsFIFO(path) &&
      HasSuffix(path, { ".nii", ".vti", ".vtu", ".vtp" }))
    {
      throw Failure("cannot write " + path +
        ": the writer of this format does not write into pipes. Give another name or format");
    }
    const std::string& existing = vtksys::SystemTools::FileExists(path) ? path : folder;
    if (access(existing.c_str(), W_OK) != 0)
    {
      throw Failure("cannot write " + path + ": there is no permission to write " + existing);
    }
  }
  if (!options.Image.empty() || !options.Movie.empty())
  {
    CheckDisplay();
  }
}

// The default background: 0 for labels and for types without negative values. Otherwise the minimum
// of the volume, since 0 may be tissue: in CT, the minimum is air.
double FindBackground(const Options& options, vtkImageData* volume)
{
  vtkDataArray* scalars = volume->GetPointData()->GetScalars();
  scalars = scalars ? scalars : volume->GetPointData()->GetArray(0);
  if (!scalars || options.AreLabels(scalars) || scalars->GetNumberOfComponents() != 1 ||
    scalars->GetDataTypeMin() >= 0.0)
  {
    return 0.0;
  }
  double range[2];
  scalars->GetFiniteRange(range);
  return range[0] <= range[1] ? range[0] : 0.0;
}

// Checks the names of arrays before the long computations begin.
void CheckArrays(const Options& options, vtkPointData* arrays)
{
  const auto require = [arrays](const char* option, const std::string& name)
  {
    if (arrays->GetArray(name.c_str()))
    {
      return;
    }
    std::string names;
    for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
    {
      if (arrays->GetArray(i) && arrays->GetArrayName(i))
      {
        names += std::string(names.empty() ? "" : ", ") + arrays->GetArrayName(i);
      }
    }
    throw Failure(
      option + (" " + name) + ": the volume has no such array of numbers. It has " + names);
  };
  const auto refuse = [arrays](const char* option, const char* name)
  {
    if (arrays->GetArray(name))
    {
      throw Failure(std::string(option) + ": the volume has a point array \"" + name +
        "\", which is the name of an array that is computed. Rename or remove it");
    }
  };
  for (const std::string& name : options.CategoricalArrays)
  {
    require("--categorical", name);
  }
  for (const std::string& name : options.DensityArrays)
  {
    require("--density-array", name);
    refuse("--density-array", "Jacobian");
  }
  if (!options.Jacobians.empty())
  {
    refuse("--jacobian", "Jacobian");
  }
  if (!options.FoldCounts.empty())
  {
    refuse("--fold-count", "FoldCount");
  }
  if (!options.InverseFields.empty())
  {
    refuse("--inverse-field", "RestPosition");
  }
}

void SetUp(vtkDeformVolumeFilter* filter, const Options& options, vtkImageData* volume,
  const LabelVolume& labels, vtkImageData* reference, const Deformation& deformation)
{
  filter->SetInputData(options.LabelOutputs.empty() ? volume : labels.AddTo(volume, filter).Get());
  filter->SetReferenceData(reference);
  SetDeformation(filter, options, deformation);
  filter->SetOpenSplits(options.OpenSplits || options.CutsMesh());
  // With a reference, the mode has no effect, and the filter would warn of it.
  filter->SetOutputBoundsMode(options.Bounds == "volume" && !reference
      ? vtkDeformVolumeFilter::VOLUME_BOUNDS
      : vtkDeformVolumeFilter::DEFORMED_BOUNDS);
  filter->SetPadding(options.Padding);
  if (options.Spacing)
  {
    filter->SetOutputSpacingModeToCustomSpacing();
    filter->SetCustomSpacing(options.Spacing->data());
  }
  filter->SetBackgroundValue(options.Background.value_or(FindBackground(options, volume)));
  const std::map<std::string, int> resamplers{ { "automatic", vtkDeformVolumeFilter::AUTOMATIC },
    { "exact", vtkDeformVolumeFilter::EXACT },
    { "mesh-rasterization", vtkDeformVolumeFilter::MESH_RASTERIZATION } };
  filter->SetResampler(resamplers.at(options.Resampler));
  const std::map<std::string, int> interpolations{ { "nearest",
                                                     vtkDeformVolumeFilter::NEAREST_INTERPOLATION },
    { "linear", vtkDeformVolumeFilter::LINEAR_INTERPOLATION },
    { "cubic", vtkDeformVolumeFilter::CUBIC_INTERPOLATION } };
  filter->SetInterpolation(interpolations.at(options.Interpolation));
  filter->SetDevice(options.Device);
  for (const std::string& name : options.CategoricalArrays)
  {
    filter->AddCategoricalArray(name.c_str());
  }
  for (const std::string& name : options.DensityArrays)
  {
    filter->AddDensityArray(name.c_str());
  }
  AskForMaps(options, filter);
  vtkPointData* arrays = volume->GetPointData();
  for (int i = 0; options.Labels && i < arrays->GetNumberOfArrays(); ++i)
  {
    filter->AddCategoricalArray(arrays->GetArrayName(i));
  }
}

PictureOptions GetPictureOptions(
  const Options& options, const Volume& volume, const Deformation& deformation)
{
  PictureOptions picture;
  picture.Threshold = options.Threshold ? *options.Threshold
    : deformation.Isovalue              ? *deformation.Isovalue
                                        : FindThreshold(volume.Image);
  picture.View = options.View ? *options.View : GetFaceView(volume.Axes);
  return picture;
}

void PrintInputs(const Volume& volume, const LabelVolume& labels, const Deformation& deformation,
  const std::vector<std::string>& tools)
{
  const auto print = [](const char* title, const std::string& text)
  {
    if (!text.empty())
    {
      std::cout << title << text << "\n";
    }
  };
  vtkDataArray* scalars = volume.Image->GetPointData()->GetScalars();
  print("volume     ", DescribeSize(volume.Image) + " voxels, " + scalars->GetDataTypeAsString());
  print("labels     ", labels.Describe());
  if (deformation.Data)
  {
    print(vtkImageData::SafeDownCast(deformation.Data) ? "field      " : "mesh       ",
      MakeText(deformation.Data->GetNumberOfElements(vtkDataObject::POINT), " nodes, ",
        deformation.Data->GetNumberOfElements(vtkDataObject::CELL), " cells"));
  }
  for (const std::string& edges : deformation.Edges)
  {
    print("edges      ", edges);
  }
  print("body       ", deformation.Body);
  print("fixed      ", deformation.Fixed);
  print("moved      ", deformation.Motion);
  print("cut        ", deformation.Cut);
  for (const std::string& tool : tools)
  {
    print("cut        ", tool);
  }
}

// Returns the number that an array holds in place of a background. scalars: may be null, as those
// of a result are if their type cannot be resampled.
double GetHeld(double background, vtkDataArray* scalars)
{
  const int type = scalars ? scalars->GetDataType() : VTK_DOUBLE;
  return type == VTK_FLOAT || type == VTK_DOUBLE
    ? background
    : std::clamp(std::nearbyint(background), scalars->GetDataTypeMin(), scalars->GetDataTypeMax());
}

void PrintResult(vtkDeformVolumeFilter* filter)
{
  std::cout << "result     " << DescribeSize(filter->GetOutput()) << " voxels, background "
            << GetHeld(
                 filter->GetBackgroundValue(), filter->GetOutput()->GetPointData()->GetScalars())
            << "\n\n"
            << filter->GetSummary() << "\n\n";
}

// Reads the grid of the result, in the world coordinates of the volume.
Volume ReadReference(const Options& options, const Volume& volume, Messages& messages)
{
  ReadingOptions reading;
  reading.Frame = 0; // all frames have the same grid
  reading.CanBeFlat = true;
  Volume reference = ReadVolume(options.Reference, reading, messages, !options.Quiet);
  reference.Image->GetPointData()->Initialize();
  reference.Image->GetCellData()->Initialize();
  if (reference.Axes != volume.Axes && reference.Axes != WorldAxes::Unknown &&
    volume.Axes != WorldAxes::Unknown)
  {
    FlipWorldAxes(reference.Image);
  }
  return reference;
}

// Integers hold no NaN, and 0 may be tissue.
void CheckBackground(const Options& options, vtkDataArray* scalars, Messages& messages)
{
  const int type = scalars->GetDataType();
  if (options.Background && std::isnan(*options.Background) && type != VTK_FLOAT &&
    type != VTK_DOUBLE)
  {
    throw Failure("--background nan needs a volume of real numbers, and the values of " +
      options.Volume + " are of the type " + scalars->GetDataTypeAsString());
  }
  if (options.Background && GetHeld(*options.Background, scalars) != *options.Background &&
    !std::isnan(*options.Background))
  {
    messages.Warn(MakeText("--background ", *options.Background, ": the values of ", options.Volume,
      " are integers from ", scalars->GetDataTypeMin(), " to ", scalars->GetDataTypeMax(),
      ". The background is ", GetHeld(*options.Background, scalars), "."));
  }
}

void CheckCoverage(vtkImageData* result)
{
  const char* covered = GetCoverage(result);
  if (std::all_of(covered, covered + result->GetNumberOfPoints(), [](char is) { return is == 0; }))
  {
    throw Failure("nothing is written, because the deformed volume covers no voxel of the result");
  }
}

// Returns the result with 0 outside the deformed volume in all arrays but the scalars: the default
// background is a value of the scalars, and other arrays hold other quantities.
vtkSmartPointer<vtkImageData> ClearOutside(vtkImageData* result)
{
  auto cleared = vtkSmartPointer<vtkImageData>::New();
  cleared->ShallowCopy(result);
  vtkPointData* arrays = cleared->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = arrays->GetArray(i);
    if (array && array->GetName() && array != arrays->GetScalars())
    {
      arrays->AddArray(CopyCovered(result, array->GetName()));
    }
  }
  return cleared;
}

// A few tetrahedra that are inside out are normal, for example at the handles of ChainMail.
void WarnOfFolds(const Options& options, const LabelVolume& labels, vtkIdType voxels,
  vtkDeformVolumeFilter* filter, Messages& messages)
{
  constexpr vtkIdType few = 1000;
  const vtkIdType inverted = filter->GetNumberOfInvertedTetrahedra();
  if (options.FieldIsInverse && inverted > 0)
  {
    messages.Warn("The field folds: it leads several points of the result to the "
                  "same point of the volume, which is shown more than once.");
  }
  else if (inverted > voxels / few)
  {
    messages.Warn("The deformation folds the volume: it turns " + std::to_string(inverted) +
      " of the tetrahedra between its voxels inside out. Where parts of the result overlap, only "
      "one of them is shown. Check the displacements, and whether they are in the unit of the "
      "volume.");
  }
  else if (const vtkIdType hidden = filter->GetNumberOfHiddenVoxels(); hidden > voxels / few)
  {
    const std::string lost = labels.DescribeLost(filter->GetOutput());
    messages.Warn("Parts of the result overlap, as where a part that is cut out moves into other "
                  "tissue. Only one of them is shown, and " +
      std::to_string(hidden) + " voxels of the others are hidden" +
      (lost.empty() ? "" : ", among them all with the labels " + lost) +
      ". --fold-count shows where.");
  }
}

void DeformVolume(const Options& options, Messages& messages)
{
  CheckOutputs(options);
  TimingTable timings;

  const Stopwatch reading;
  const ReadingOptions readingOptions{ options.FileCoordinates, options.Frame };
  Volume volume = ReadVolume(options.Volume, readingOptions, messages, !options.Quiet);
  ChooseScalars(volume.Image, options.Volume);
  CheckArrays(options, volume.Image->GetPointData());
  CheckBackground(options, volume.Image->GetPointData()->GetScalars(), messages);
  volume.Axes =
    ResolveSpace("--volume-space", options.VolumeSpace, options.Volume, volume.Axes, messages);
  const LabelVolume labels(options, volume, messages);
  volume.Labels = labels.GetScalars();
  Volume reference;
  if (!options.Reference.empty())
  {
    reference = ReadReference(options, volume, messages);
  }
  timings.Add("read volume", reading.GetSeconds());
  const Stopwatch readingPoints;
  const std::vector<PointsFile> points = ReadPoints(options, volume, messages);
  if (!points.empty())
  {
    timings.Add("read points", readingPoints.GetSeconds());
  }

  const Stopwatch cutting;
  Volume cut = volume;
  const std::vector<std::string> tools = CutAndCarve(options, cut, messages);
  if (options.HasTools())
  {
    timings.Add("cut and carve", cutting.GetSeconds());
  }

  vtkNew<vtkDeformVolumeFilter> filter;
  const auto deform = [&](const Deformation& deformation)
  {
    if (!filter->GetInput())
    {
      SetUp(filter, options, cut.Image, labels, reference.Image, deformation);
    }
    filter->SetDeformationData(deformation.Data);
    const ProgressBar bar(filter, "deforming", !options.Quiet);
    filter->Update();
    messages.Check(
      "cannot deform the volume" + (options.Mesh.empty() ? "" : " with " + options.Mesh));
  };
  std::optional<Movie> movie;
  double movieTime = 0.0;
  const auto takeFrame = [&](const Deformation& deformation)
  {
    if (!options.Movie.empty())
    {
      const Stopwatch drawing;
      if (!movie)
      {
        movie.emplace(volume.Image, GetPictureOptions(options, volume, deformation), options.Movie);
      }
      deform(deformation);
      movie->Add(filter->GetOutput(), messages);
      movieTime += drawing.GetSeconds();
    }
  };
  const Stopwatch meshing;
  const Deformation deformation = MakeDeformation(
    options, cut, reference.Image ? reference.Image : cut.Image, messages, takeFrame);
  if (movie)
  {
    movie->Finish(messages);
    timings.Add("deform and draw frames", movieTime);
  }
  timings.Add(!options.Field.empty() ? "read field"
      : !options.Transforms.empty()  ? "read transform"
      : options.HasElasticModel()    ? "simulate"
      : !options.Model.empty()       ? "pull by ChainMail"
      : options.Mesh.empty()         ? "make mesh"
                                     : "read mesh",
    meshing.GetSeconds() - movieTime);

  if (!options.WritesResult())
  {
    if (!options.Quiet)
    {
      PrintInputs(volume, labels, deformation, tools);
      std::cout << "\n";
      timings.Print(std::cout);
    }
    return;
  }

  const Stopwatch deforming;
  deform(deformation);
  CheckCoverage(filter->GetOutput());
  WarnOfFolds(options, labels, volume.Image->GetNumberOfPoints(), filter, messages);
  timings.Add("deform", deforming.GetSeconds());

  Volume result = volume;
  result.Image = filter->GetOutput();
  if (reference.Image)
  {
    result.Forms = reference.Forms;
  }
  const Stopwatch writing;
  if (!options.LabelOutputs.empty())
  {
    Volume deformedLabels = result;
    deformedLabels.Image = labels.TakeFrom(result.Image);
    for (const std::string& output : options.LabelOutputs)
    {
      WriteVolume(deformedLabels, output, messages, !options.Quiet);
    }
  }
  WriteMaps(options, result, messages);
  if (!options.Background && !options.Outputs.empty() && filter->GetBackgroundValue() != 0.0)
  {
    result.Image = ClearOutside(result.Image);
  }
  for (const std::string& output : options.Outputs)
  {
    WriteVolume(result, output, messages, !options.Quiet);
  }
  if (!options.Outputs.empty() || !options.Jacobians.empty() || !options.FoldCounts.empty() ||
    !options.InverseFields.empty() || !options.LabelOutputs.empty())
  {
    timings.Add("write volume", writing.GetSeconds());
  }
  if (!points.empty())
  {
    const Stopwatch moving;
    WriteDeformedPoints(points, options, deformation, messages);
    timings.Add("move points", moving.GetSeconds());
  }
  if (!options.Image.empty())
  {
    const Stopwatch drawing;
    Picture picture(volume.Image, GetPictureOptions(options, volume, deformation));
    WritePNG(picture.Draw(result.Image, Picture::Aim::Tight, messages), options.Image, messages);
    timings.Add("draw picture", drawing.GetSeconds());
  }
  if (!options.Quiet)
  {
    PrintInputs(volume, labels, deformation, tools);
    PrintResult(filter);
    timings.Print(std::cout);
  }
}
}

int main(int argc, char* argv[])
{
  Options options;
  if (const std::optional<int> code = ParseCommandLine(argc, argv, options))
  {
    return *code;
  }
  return RunProgram("deform-volume",
    [&options](Messages& messages)
    {
      if (options.ListDevices)
      {
        ListDevices();
      }
      else
      {
        DeformVolume(options, messages);
      }
    });
}
