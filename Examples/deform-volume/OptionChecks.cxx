// SPDX-License-Identifier: BSD-3-Clause
#include "OptionChecks.h"

#include "Failure.h"
#include "FieldReading.h"
#include "Files.h"
#include "Messages.h"
#include "Movie.h"
#include "Options.h"
#include "PointsFile.h"
#include "VolumeWriting.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace
{
/// Checks the extension of an output. CheckPoints() checks those of --points-output.
void CheckName(const NamedFile& output)
{
  const auto check = [&output](bool canBeWritten, const char* extensions)
  {
    if (!canBeWritten)
    {
      throw UsageError(output.Option + " " + output.Path + ": the name must end in " + extensions);
    }
  };
  if (output.Option == "--image")
  {
    check(HasSuffix(output.Path, { ".png" }), ".png");
  }
  else if (output.Option == "--movie")
  {
    check(CanWriteMovie(output.Path), ".png, or, if VTK was built with Ogg Theora, in .ogv");
  }
  else if (output.Option == "--write-mesh")
  {
    check(HasSuffix(output.Path, { ".vtu" }), ".vtu");
  }
  else if (output.Option != "--points-output")
  {
    check(CanWriteVolume(output.Path), WrittenFormats);
  }
}

/// Returns the files to write for one argument.
std::vector<std::string> GetWrittenFiles(const Options& options, const NamedFile& output)
{
  std::vector<std::string> files;
  if (output.Option == "--movie" && HasSuffix(output.Path, { ".png" }))
  {
    for (int frame = 1; frame <= options.Frames; ++frame)
    {
      files.push_back(GetFramePath(output.Path, frame));
    }
    return files;
  }
  files.push_back(output.Path);
  if (HasSuffix(output.Path, { ".mhd", ".nhdr" }))
  {
    files.push_back(output.Path.substr(0, output.Path.rfind('.')) + ".raw"); // the values
  }
  return files;
}

/// Returns the files to read for one argument. Files that the header of a volume may name are
/// among them.
std::vector<std::string> GetReadFiles(const std::string& path)
{
  std::vector<std::string> files{ path };
  if (!HasSuffix(path, { ".mhd", ".mha", ".nhdr", ".nrrd" }))
  {
    return files;
  }
  const std::string folder =
    vtksys::SystemTools::GetFilenamePath(vtksys::SystemTools::CollapseFullPath(path));
  std::ifstream header(path);
  std::string line;
  constexpr std::streamoff longestHeader = 1 << 20;
  while (std::getline(header, line) && line.find('\0') == std::string::npos &&
    header.tellg() < longestHeader)
  {
    // The name of a file is a line of its own, or follows "ElementDataFile =" or "data file:".
    const std::size_t sign = line.find_first_of("=:");
    const std::string name = Trim(sign == std::string::npos ? line : line.substr(sign + 1));
    if (!name.empty())
    {
      files.push_back(vtksys::SystemTools::CollapseFullPath(name, folder));
    }
  }
  return files;
}

/// Whether two paths lead to one file, which need not exist.
bool AreSame(const std::string& first, const std::string& second)
{
  return vtksys::SystemTools::CollapseFullPath(first) ==
    vtksys::SystemTools::CollapseFullPath(second) ||
    vtksys::SystemTools::SameFile(first, second);
}

std::vector<std::string> GetInputs(const Options& options)
{
  std::vector<std::string> inputs{ options.Volume, options.LabelVolume, options.Mesh, options.Rest,
    options.Field, options.Reference };
  inputs.insert(inputs.end(), options.Cuts.begin(), options.Cuts.end());
  inputs.insert(inputs.end(), options.Points.begin(), options.Points.end());
  for (const TransformFile& transform : options.Transforms)
  {
    inputs.push_back(transform.Path);
  }
  inputs.erase(std::remove(inputs.begin(), inputs.end(), ""), inputs.end());
  return inputs;
}

void CheckWrittenOnce(const NamedFile& file, const NamedFile& other, const std::string& path,
  const std::string& otherPath)
{
  // The files of one option have the same values.
  const bool areSameValues =
    file.Option == other.Option && path != file.Path && otherPath != other.Path;
  if (areSameValues || !AreSame(path, otherPath))
  {
    return;
  }
  throw UsageError((path == file.Path ? path + " is written twice"
                                      : path + " is written twice, for " + other.Option + " " +
                         other.Path + " and for " + file.Option + " " + file.Path) +
    ". Give " + file.Option + " another name");
}

/// Inputs must not be overwritten, and outputs must not overwrite one another. That includes the
/// files that hold the values of .mhd and .nhdr files.
void CheckOverwriting(const Options& options)
{
  std::vector<std::pair<NamedFile, std::string>> written;
  for (const NamedFile& output : options.GetOutputs())
  {
    const std::vector<std::string> files = GetWrittenFiles(options, output);
    for (const std::string& file : files)
    {
      for (const auto& [other, otherFile] : written)
      {
        CheckWrittenOnce(output, other, file, otherFile);
      }
    }
    for (const std::string& file : files)
    {
      written.emplace_back(output, file);
    }
  }
  for (const std::string& input : GetInputs(options))
  {
    const std::vector<std::string> files = GetReadFiles(input);
    for (const auto& [output, file] : written)
    {
      for (const std::string& read : files)
      {
        if (AreSame(file, read))
        {
          throw UsageError(file +
            (read == input ? " is an input" : " holds the values of the input " + input) +
            ", and would be overwritten. Give " +
            (file == output.Path ? "the output" : output.Option + " " + output.Path) +
            " another name");
        }
      }
    }
  }
}

/// Each file of --points needs a file of --points-output in the same format.
void CheckPoints(const Options& options)
{
  if (options.Points.size() != options.PointsOutputs.size())
  {
    throw UsageError("--points is given " + std::to_string(options.Points.size()) +
      " times and --points-output " + std::to_string(options.PointsOutputs.size()) +
      " times. Give one --points-output for each --points, in the same order");
  }
  for (std::size_t i = 0; i < options.Points.size(); ++i)
  {
    const std::string format = GetPointFormat(options.Points[i]);
    if (format.empty())
    {
      throw UsageError("--points " + options.Points[i] + ": the name must end in " + PointFormats +
        (HasSuffix(options.Points[i], { ".fcsv" }) ? ". In 3D Slicer, save the points as .mrk.json"
                                                   : ""));
    }
    if (GetPointFormat(options.PointsOutputs[i]) != format)
    {
      throw UsageError("--points-output " + options.PointsOutputs[i] + ": the name must end in " +
        format + ", as that of " + options.Points[i] + " does");
    }
  }
}

/// --model needs a suitable mesh and pulls. All pulls have one radius, because a model has only
/// one.
void CheckModel(const Options& options)
{
  if (options.HasElasticModel())
  {
    if (!options.TetGen && !options.HasLattice())
    {
      throw UsageError("--model " + options.Model + " needs a mesh. Give --tetgen or --lattice");
    }
    if (options.Model == "mass-spring" && options.TetGen)
    {
      throw UsageError("--model mass-spring needs the cubes of --lattice. Give --lattice, or use "
                       "--model fem with --tetgen");
    }
    if (!options.Pushes.empty())
    {
      throw UsageError("--push cannot be used with --model " + options.Model + ". Use --pull");
    }
  }
  if (options.CutsMesh() && (options.SmoothCut || options.KeepDistance))
  {
    throw UsageError(std::string(options.SmoothCut ? "--smooth-cut" : "--keep") +
      " cannot be used with --model " + options.Model + ", where --cut splits the mesh");
  }
  if (options.Model == "chainmail" && options.Pulls.empty())
  {
    throw UsageError("--model chainmail needs at least one --pull X,Y,Z,DX,DY,DZ[,RADIUS]");
  }
  for (const Pull& pull : options.Pulls)
  {
    if (pull.Radius != options.Pulls.front().Radius)
    {
      throw UsageError(MakeText("all --pull must have the same radius, but the radii ",
        options.Pulls.front().Radius, " and ", pull.Radius, " are given"));
    }
  }
}

/// There must be one deformation, and options that apply to it.
void CheckDeformation(const Options& options)
{
  CheckModel(options);
  const bool makesMesh = options.TetGen || options.HasLattice();
  const int deformations = !options.Mesh.empty() + !options.Field.empty() +
    !options.Transforms.empty() + options.TetGen + options.HasLattice() +
    (options.Model == "chainmail");
  if (deformations > 1 || (deformations == 0 && !options.HasTools()))
  {
    throw UsageError("exactly one of --mesh, --field, --transform, --tetgen, --lattice and --model "
                     "chainmail must be given; none is needed with --cut or --carve");
  }
  if (deformations == 0 &&
    (options.Outside == "extrapolate" || options.KeepDistance ||
      options.Resampler == "mesh-rasterization"))
  {
    throw UsageError(std::string(options.KeepDistance       ? "--keep"
                         : options.Outside == "extrapolate" ? "--outside extrapolate"
                                                            : "--resampler mesh-rasterization") +
      " needs a deformation, such as --mesh, --field or --tetgen. Without one, nothing moves");
  }
  if (options.Mesh.empty() && options.Field.empty() &&
    (!options.Displacement.empty() || options.Scale != 1.0))
  {
    throw UsageError(std::string(options.Scale != 1.0 ? "--scale" : "--displacement") +
      " requires --mesh or --field");
  }
  if (!makesMesh && !options.Pushes.empty())
  {
    throw UsageError(std::string("--push requires --tetgen or --lattice") +
      (options.Model.empty() ? "" : ". Use --pull with --model chainmail"));
  }
  if (!makesMesh && !options.MeshOutput.empty())
  {
    throw UsageError("--write-mesh requires --tetgen or --lattice");
  }
  if (makesMesh && options.Model.empty() && options.Pushes.empty() &&
    (options.WritesResult() || options.MeshOutput.empty()))
  {
    throw UsageError("--tetgen and --lattice need at least one --push X,Y,Z,DX,DY,DZ,RADIUS, or "
                     "--model");
  }
  if (!options.Mesh.empty() && options.Displacement.empty() == options.Rest.empty())
  {
    throw UsageError("--mesh needs either --displacement (the name of an array of vectors) or "
                     "--rest (the mesh at rest)");
  }
  if (!options.Displacement.empty() && IsFieldFile(options.Field) && !IsVTKFile(options.Field))
  {
    throw UsageError("--displacement names an array of a .vti file; " + options.Field +
      " has only one set of vectors");
  }
}
}

void CheckResampler(const Options& options, bool isForwardField)
{
  const bool isExact = options.Resampler == "exact";
  if (options.FieldIsInverse)
  {
    if (isExact)
    {
      throw UsageError(
        "--resampler exact cannot be used with an inverse field (--field-is-inverse or "
        "--transform), which has no positions for the voxels. Remove --resampler");
    }
    if (options.SmoothCut)
    {
      throw UsageError(
        "--smooth-cut requires a mesh or a forward field. An inverse field (--field-is-inverse or "
        "--transform) has no positions for the two sides of a cut");
    }
    return;
  }
  if (options.Resampler == "mesh-rasterization")
  {
    const std::string what = "--resampler mesh-rasterization";
    if (isForwardField)
    {
      throw UsageError(what +
        " needs a --mesh, --tetgen, --lattice or inverse field. It cannot be used with a forward "
        "field or with --model chainmail");
    }
    const std::string other = options.Outside == "extrapolate" ? "--outside extrapolate"
      : options.SmoothCut                                      ? "--smooth-cut"
      : options.KeepDistance                                   ? "--keep"
      : !options.Jacobians.empty()                             ? "--jacobian"
      : !options.FoldCounts.empty()                            ? "--fold-count"
      : !options.DensityArrays.empty()                         ? "--density-array"
                                                               : "";
    if (!other.empty())
    {
      throw UsageError(what + " cannot be used with " + other);
    }
  }
}

void CheckOptions(const Options& options)
{
  if (options.ListDevices)
  {
    return;
  }
  if (options.Volume.empty())
  {
    throw UsageError("no VOLUME is given. deform-volume --help lists the arguments");
  }
  CheckDeformation(options);
  CheckResampler(options, !options.Field.empty() || options.Model == "chainmail");
  CheckPoints(options);
  if (!options.LabelVolume.empty() && options.LabelOutputs.empty() && !options.UsesLabels())
  {
    throw UsageError("--label-volume requires --label-output, --fix label:N or --material label:N");
  }
  if (!options.MeshSpace.empty() && options.Mesh.empty() && options.Cuts.empty() &&
    std::all_of(options.Points.begin(), options.Points.end(), IsLandmarkFile))
  {
    throw UsageError(
      "--mesh-space requires --mesh or --cut, or --points of the types .vtp, .vtu, .stl or .ply");
  }
  if (!options.WritesResult() && options.MeshOutput.empty())
  {
    throw UsageError(
      "nothing to write. Give an output such as --output, --image, --movie or --write-mesh");
  }
  for (const NamedFile& output : options.GetOutputs())
  {
    CheckName(output);
  }
  if (options.Image.empty() && options.Movie.empty() && (options.Threshold || options.View))
  {
    throw UsageError(
      std::string(options.View ? "--view" : "--threshold") + " requires --image or --movie");
  }
  CheckOverwriting(options);
  if (options.HasElasticModel() && options.WritesResult() && options.Pulls.empty() &&
    options.Gravity == std::array<double, 3>{})
  {
    throw UsageError(
      "--model " + options.Model + " needs a --pull or --gravity, without which nothing moves");
  }
}
