// SPDX-License-Identifier: BSD-3-Clause
#include "Options.h"

#include "Failure.h"
#include "MeshFormats.h"
#include "OptionChecks.h"
#include "OptionTexts.h"
#include "PointsFile.h"
#include "VolumeReading.h"
#include "VolumeWriting.h"

#include <CLI/CLI.hpp>

#include <vtkDataArray.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <initializer_list>
#include <iostream>
#include <regex>

namespace
{
/// Refuses negative numbers. CLI::NonNegativeNumber prints the largest double in its message.
const CLI::Validator NotNegative([](std::string& text)
  { return std::strtod(text.c_str(), nullptr) < 0.0 ? text + " is negative" : std::string(); },
  "");

/// Refuses NaN, which the range checks of CLI11 accept, and infinity.
const CLI::Validator Finite(
  [](std::string& text)
  {
    return std::isfinite(std::strtod(text.c_str(), nullptr)) ? std::string()
                                                             : text + " is not a finite number";
  },
  "");

/// Refuses the empty text of shell variables that are not set, which CLI11 reads as the number 0.
const CLI::Validator NotEmpty([](std::string& text)
  { return text.empty() ? std::string("the argument is empty") : std::string(); },
  "");

/// Refuses integers such as 010, which CLI11 reads as octal numbers.
const CLI::Validator Decimal(
  [](std::string& text)
  {
    static const std::regex octal("[+-]?0.+");
    return std::regex_match(text, octal) ? text + " begins with 0. Give a decimal number"
                                         : std::string();
  },
  "");

/// Adds options under a heading of --help.
class OptionGroup
{
public:
  explicit OptionGroup(CLI::App& program, const std::string& heading = "Options")
    : Program(program)
    , Heading(heading)
  {
  }

  template <typename Value>
  CLI::Option* Add(
    const std::string& name, Value& value, const std::string& type, const std::string& help)
  {
    return this->Program.add_option(name, value, help)->type_name(type)->group(this->Heading);
  }

  /// value: a double, or an optional one.
  template <typename Value>
  CLI::Option* AddNumber(
    const std::string& name, Value& value, const std::string& help, const char* type = "NUMBER")
  {
    return this->Add(name, value, type, help)->check(Finite);
  }

  /// An option that may be given several times.
  void AddList(const std::string& name, std::vector<std::string>& values, const std::string& type,
    const std::string& help)
  {
    this->Add(name, values, type, help)->take_all()->expected(1);
  }

  /// An option whose argument a function parses.
  template <typename Value, typename Parsed>
  CLI::Option* Add(const std::string& name, Value& value, Parsed (*parse)(const std::string&),
    const std::string& type, const std::string& help)
  {
    return this->Program
      .add_option_function<std::string>(
        name, [&value, parse](const std::string& text) { value = parse(text); }, help)
      ->type_name(type)
      ->group(this->Heading);
  }

  /// An option that may be given several times, and whose arguments a function parses.
  template <typename Value>
  void AddList(const std::string& name, std::vector<Value>& values,
    Value (*parse)(const std::string&), const std::string& type, const std::string& help)
  {
    this->AddEach(
      name, [&values, parse](const std::string& text) { values.push_back(parse(text)); }, type,
      help);
  }

  /// Calls take with each argument of an option that may be given several times.
  void AddEach(const std::string& name, const std::function<void(const std::string&)>& take,
    const std::string& type, const std::string& help)
  {
    this->Program
      .add_option_function<std::vector<std::string>>(
        name,
        [take](const std::vector<std::string>& texts)
        { std::for_each(texts.begin(), texts.end(), take); },
        help)
      ->type_name(type)
      ->group(this->Heading)
      ->take_all()
      ->expected(1);
  }

  void AddChoice(const std::string& name, std::string& value, const std::string& type,
    const std::vector<std::string>& choices, const std::string& help)
  {
    this->Add(name, value, type, help)->capture_default_str()->check(CLI::IsMember(choices));
  }

  void AddFlag(const std::string& name, bool& value, const std::string& help)
  {
    this->Program.add_flag(name, value, help)->group(this->Heading);
  }

private:
  CLI::App& Program;
  std::string Heading;
};

/// Sets the tissue of voxels that are in no range of --material.
void SetTissue(const CLI::App& program, const std::string& tissue, Options& options)
{
  if (!options.Tissue.empty())
  {
    throw UsageError("--material " + tissue + ": --material " + options.Tissue +
      " already sets the tissue of the body. Give one of the two a range of values, "
      "MINIMUM:MAXIMUM=TISSUE");
  }
  for (const char* option : { "--young", "--poisson", "--density" })
  {
    if (program.count(option))
    {
      throw UsageError("--material " + tissue + " and " + option +
        " set the same property. Remove one of them, or give the tissue a range of values, "
        "MINIMUM:MAXIMUM=TISSUE");
    }
  }
  options.Tissue = tissue;
  const std::array<double, 3> values = *FindTissue(tissue);
  options.YoungModulus = values[0];
  options.PoissonRatio = values[1];
  options.Density = values[2];
}

/// Refuses options that are given but have no effect with this model.
void CheckModelOptions(const CLI::App& program, const Options& options)
{
  for (const char* option :
    { "--fix", "--material", "--gravity", "--young", "--poisson", "--density" })
  {
    if (program.count(option) && !options.HasElasticModel())
    {
      throw UsageError(std::string(option) + " requires --model fem or --model mass-spring");
    }
  }
  if (program.count("--duration") && options.Model != "mass-spring")
  {
    throw UsageError("--duration requires --model mass-spring");
  }
  if (!(options.Duration > 0.0))
  {
    throw UsageError("--duration must be greater than 0");
  }
}

/// Sets what follows from the options, and checks them.
void Complete(const CLI::App& program, Options& options)
{
  if (!options.Transforms.empty())
  {
    if (program.count("--bounds") && options.Bounds != "volume")
    {
      throw UsageError("--bounds deformed cannot be used with --transform: the result has the grid "
                       "of the volume, or of --reference");
    }
    options.Bounds = "volume";
    options.FieldIsInverse = true;
  }
  CheckModelOptions(program, options);
  CheckOptions(options);
}

void AddElasticModel(CLI::App& program, Options& options)
{
  OptionGroup group(program, "With --model fem or mass-spring");
  group.AddList("--fix", options.Fixations, ParseFixation, "box:X0,X1,Y0,Y1,Z0,Z1|below:Z|label:N",
    "Fixed nodes: nodes in a box, nodes with a z coordinate of at most Z, or nodes in voxels of "
    "the label N and nodes of tetrahedra of whose voxels at least half have it. Labels are those "
    "of --label-volume, or else the values of VOLUME. May be given several times");
  group
    .Add("--gravity", options.Gravity, ParseGravity, "X,Y,Z", "Acceleration of gravity, in m/s^2")
    ->default_str("0,0,0");
  const auto addNumber = [&](const char* name, double& value, const char* help)
  { group.AddNumber(name, value, help)->capture_default_str(); };
  group.AddEach(
    "--material",
    [&program, &options](const std::string& text)
    {
      if (FindTissue(text))
      {
        SetTissue(program, text, options);
      }
      else
      {
        options.Materials.push_back(ParseMaterial(text));
      }
    },
    "TISSUE|VOXELS=TISSUE|VOXELS=E[,NU[,DENSITY]]",
    "Material of voxels: Young modulus E (Pa), Poisson ratio NU and DENSITY (kg/m^3), or the "
    "values of a TISSUE. VOXELS is MINIMUM:MAXIMUM for values of at least MINIMUM and less than "
    "MAXIMUM, or label:N for a label, as in --fix. Each tetrahedron gets the mean of its voxels. "
    "If several apply to a voxel, the first one is used. Other voxels get the TISSUE that is "
    "given without VOXELS, or else --young, --poisson and --density; with --tetgen, those outside "
    "the body have the material of the nearest voxel of the body. "
    "Tissues: " +
      GetTissues() + ". May be given several times");
  addNumber("--young", options.YoungModulus, "Young modulus, in Pa");
  addNumber("--poisson", options.PoissonRatio, "Poisson ratio, from 0 to less than 0.495");
  addNumber("--density", options.Density, "Density, in kg/m^3");
  addNumber("--duration", options.Duration,
    "With mass-spring: duration of the simulation, in s. Handles move during its first half");
}

void AddDeformation(CLI::App& program, Options& options)
{
  OptionGroup group(
    program, "Deformation (one of --mesh, --field, --transform, --tetgen, --lattice, --model)");
  group.Add("--mesh", options.Mesh, "FILE",
    "Mesh (" + GetMeshSuffixes() +
      "; cells are split into tetrahedra), or displacement field (.vti). Of a time series, the "
      "last time step is read");
  group.Add("--field", options.Field, "FILE",
    "Displacement field: .nii or .nii.gz of the shape (X,Y,Z,1,3) with the intent 1006 (vectors "
    "right, anterior, superior) or 1007 (left, posterior, superior, as written by ITK and "
    "ANTs), " +
      std::string(HasITK ? ".mha, .mhd, .nrrd, .nhdr " : "") +
      "or .vti. Without --field-is-inverse, it leads from each point of the volume to the "
      "deformed position of that point");
  group.AddFlag("--field-is-inverse", options.FieldIsInverse,
    "The --field leads from each point of the result to the point of the volume that is shown "
    "there, as written by registration programs (from the fixed to the moving image)");
  group.AddChoice("--field-space", options.FieldSpace, "SPACE", { "lps", "ras" },
    "World coordinates of a --field whose file does not state them: lps (x to the left, y to the "
    "back, z to the head) or ras (x to the right, y to the front, z to the head) [those of the "
    "volume]");
  group.AddList("--transform", options.Transforms, ParseTransform, "FILE[,invert]",
    HasITK ? "Transform of a registration, from the result (the fixed image) to the volume (the "
             "moving image), as written by ITK, SimpleITK, ANTs and 3D Slicer: .h5, .tfm, .txt "
             "or .mat with a matrix, a B-spline, a displacement field or a composition, or a "
             "displacement field as for --field. With ,invert after the file name, a matrix is "
             "inverted. May be given several times: the last transform is applied first, as in "
             "antsApplyTransforms"
           : "Transform of a registration. Not available: this program was built without ITK");
  group.Add("--displacement", options.Displacement, "NAME",
    "Name of the point array that holds the displacements, in world units, from rest to deformed "
    "positions: an array of --mesh, or of a --field in a .vti file. The points of --mesh are "
    "then at rest");
  group.Add("--rest", options.Rest, "FILE",
    "Mesh at rest, with the same cells as --mesh. The points of --mesh are then the deformed "
    "positions. Of a time series, the first time step is read");
  group.AddChoice("--mesh-space", options.MeshSpace, "SPACE", { "lps", "ras" },
    "World coordinates of files of --mesh, --rest, --cut and --points (.vtp, .vtu, .stl, .ply) "
    "that do not state them (files of 3D Slicer do): lps (x to the left, y to the back, z to the "
    "head) or ras (x to the right, y to the front, z to the head) [those of the volume]");
  group.AddFlag("--points-are-deformed", options.PointsAreDeformed,
    "The points of --mesh are already deformed. The displacements lead from the positions at "
    "rest to these points");
  group.AddFlag("--open-splits", options.OpenSplits,
    "A gap opens where the --mesh is split: where neighboring cells have nodes of their own, as "
    "in a mesh that --write-mesh has written after a --cut. Otherwise tissue is stretched over "
    "the gap");
  group
    .AddNumber("--scale", options.Scale,
      "Factor by which the displacements of --mesh or --field are multiplied")
    ->capture_default_str();
  group.AddFlag("--tetgen", options.TetGen,
    "Make a mesh of the body in the volume with TetGen. Use with --push or --model");
  group.Add("--lattice", options.Lattice, ParseLattice, "NX,NY,NZ",
    "Make a mesh of cubes that covers the whole volume, with at most NX, NY and NZ nodes on the "
    "axes. Each cube has five tetrahedra. Use with --push or --model");
  group.AddList("--push", options.Pushes, ParsePush, "X,Y,Z,DX,DY,DZ,RADIUS",
    "Move the nodes around X,Y,Z (world coordinates) by DX,DY,DZ (world units). The displacement "
    "decreases smoothly to 0 at the distance RADIUS (world units). May be given several times: "
    "displacements are added");

  group.AddChoice("--model", options.Model, "NAME", { "chainmail", "fem", "mass-spring" },
    "chainmail: voxels are linked to their neighbors, and follow a --pull as far as the limits "
    "of their links require. fem, with --tetgen or --lattice: the equilibrium of the mesh, by "
    "finite elements. mass-spring, with --lattice: a simulation of the mesh for --duration. "
    "Units of length are mm");
  group.AddList("--pull", options.Pulls, ParsePull, "X,Y,Z,DX,DY,DZ[,RADIUS]",
    "With --model: move the voxels or nodes within RADIUS of X,Y,Z (world coordinates) by "
    "DX,DY,DZ (world units). Without RADIUS, only the nearest voxel or node is moved. May be "
    "given several times");
  AddElasticModel(program, options);

  OptionGroup tools(
    program, "Cuts and carvings of the volume at rest (alone, or with a deformation)");
  tools.AddList("--cut", options.Cuts, "FILE",
    "Cut the volume along a sheet of triangles (" + GetSheetSuffixes() +
      ", world coordinates). With --model fem or mass-spring, the sheet cuts the mesh at rest "
      "along the nearest faces of its tetrahedra, and the volume opens there. May be given "
      "several times");
  tools.AddFlag("--smooth-cut", options.SmoothCut,
    "With --cut: divide tetrahedra that a sheet crosses between its two sides, instead of "
    "leaving them out. Requires --resampler exact or automatic");
  tools.AddList("--carve", options.Carvings, ParseCarving, "sphere:X,Y,Z,RADIUS",
    "Carve a sphere out of the volume (world coordinates and units). Voxels within about one "
    "voxel of its surface may stay. May be given several times");

  OptionGroup tetgen(program, "Mesh made by --tetgen");
  tetgen.AddNumber("--isovalue", options.Isovalue,
    "Minimum value of voxels of the body [computed from the histogram]");
  tetgen.AddChoice("--pieces", options.Pieces, "MODE", { "all", "largest" },
    "Which pieces of the body are meshed: all, or only the largest one. Pieces of at most 26 "
    "voxels are left out");
  tetgen
    .AddNumber("--edge-length", options.EdgeLength,
      "Target length of the edges of the tetrahedra, in world units. 0: a twentieth of the "
      "diagonal of the volume, or with --model fem a tenth, because fem adds nodes in the middle "
      "of edges. Within a --push, edges are not longer than a sixth of its radius. The mesh "
      "extends half an edge length beyond the body, or with --model fem a tenth")
    ->capture_default_str()
    ->check(NotNegative);
  tetgen
    .AddNumber("--radius-edge-ratio", options.RadiusEdgeRatio,
      "Quality of the tetrahedra: maximum ratio of the radius of the circumscribed sphere to the "
      "shortest edge, 1 to 100")
    ->capture_default_str()
    ->check(CLI::Range(1.0, 100.0));
  tetgen.Add("--tetgen-executable", options.TetGenExecutable, "FILE",
    "TetGen program [the environment variable DEFORMVOLUME_TETGEN, or else the program that was "
    "found when deform-volume was built, or else tetgen in PATH]");
}

/// Makes options that have no effect without another option an error.
void AddDependencies(CLI::App& program)
{
  const auto needs = [&](const char* needed, std::initializer_list<const char*> options)
  {
    for (const char* option : options)
    {
      program.get_option(option)->needs(program.get_option(needed));
    }
  };
  needs("--mesh", { "--rest", "--points-are-deformed", "--open-splits" });
  needs("--field", { "--field-is-inverse", "--field-space" });
  needs("--tetgen",
    { "--isovalue", "--pieces", "--edge-length", "--radius-edge-ratio", "--tetgen-executable" });
  // CheckModelOptions() checks the other options of --model.
  needs("--model", { "--pull", "--frames", "--movie" });
  needs("--label-volume", { "--label-output" });
  needs("--points", { "--points-output" });
  needs("--points-output", { "--points" });
  needs("--movie", { "--frames" });
  needs("--frames", { "--movie" });
  needs("--cut", { "--smooth-cut" });
  program.get_option("--scale")->excludes(program.get_option("--rest"));
  program.get_option("--points-are-deformed")->excludes(program.get_option("--rest"));
  for (const char* option : { "--field", "--transform" })
  {
    program.get_option(option)->excludes(program.get_option("--file-coordinates"));
  }
  program.get_option("--transform")->excludes(program.get_option("--spacing"));
  for (const char* option : { "--bounds", "--padding", "--spacing", "--file-coordinates" })
  {
    program.get_option("--reference")->excludes(program.get_option(option));
  }
  program.get_option("--keep")->excludes(program.get_option("--outside"));
  program.get_option("--keep")->excludes(program.get_option("--open-splits"));
  program.get_option("--isovalue")->excludes(program.get_option("--labels"));
}

void AddResampling(CLI::App& program, Options& options)
{
  OptionGroup group(program, "Resampling");
  group.AddChoice("--outside", options.Outside, "MODE", { "discard", "extrapolate" },
    "What happens to voxels outside the mesh or field: discard leaves them out, extrapolate "
    "moves them with the nearest tetrahedron");
  group
    .AddNumber("--keep", options.KeepDistance,
      "Tissue outside the mesh or field stays where it is. The displacement of the boundary fades "
      "to zero over DISTANCE, the fade distance (world units). With 0, nothing outside moves",
      "DISTANCE")
    ->check(NotNegative);
  group.Add("--reference", options.Reference, "FILE",
    "Image, in a format of VOLUME, whose grid the result gets: size, spacing, direction and "
    "origin. Its values are not used. With --transform, give the fixed image");
  group.AddChoice("--bounds", options.Bounds, "MODE", { "deformed", "volume" },
    "Bounds of the result: those of the deformed volume, or those of the volume at rest");
  group.Add("--spacing", options.Spacing, ParseSpacing, "X,Y,Z",
    "Distances between the voxels of the result along its axes, in world units [those of the "
    "volume]. Smaller ones show thin layers that the deformation makes");
  group
    .Add("--padding", options.Padding, "VOXELS",
      "Width of a border on each side of the result, in voxels")
    ->capture_default_str()
    ->check(Decimal)
    ->check(CLI::Range(0, 1000));
  group.Add("--background", options.Background, "NUMBER",
    "Value of voxels outside the deformed volume, in all arrays but those of --density-array, "
    "which are 0 there [scalars: their minimum, such as air in CT; 0 if they are labels, have "
    "several components, or have a type without negative values; other arrays: 0]");
  group.AddList("--categorical", options.CategoricalArrays, "NAME",
    "Name of an array of labels, which is not interpolated. May be given several times");
  group.AddFlag("--labels", options.Labels, "All arrays hold labels");
  group.AddList("--density-array", options.DensityArrays, "NAME",
    "Name of an array that holds an amount per unit of volume, such as a dose or an activity. "
    "Its values are divided by the Jacobian determinant, so that the deformation preserves the "
    "total amount. The result is float, or double for an array of doubles. May be given several "
    "times");
  group.AddChoice("--resampler", options.Resampler, "NAME",
    { "automatic", "exact", "mesh-rasterization" },
    "exact: resamples over tetrahedra whose vertices are the voxels; mesh-rasterization: over "
    "the tetrahedra of the deformation mesh, with less memory; automatic: exact if the memory is "
    "sufficient");
  group.AddChoice("--interpolation", options.Interpolation, "NAME",
    { "nearest", "linear", "cubic" },
    "linear; nearest, which takes the value of one voxel of the cell, usually the nearest one, as "
    "--labels does; or cubic, which uses 64 voxels, and is linear where some of them are missing "
    "or cut off. With an inverse field or mesh-rasterization, nearest takes the nearest voxel, and "
    "for cubic, voxels beyond the border are extrapolated linearly");
  group.Add("--device", options.Device, "NAME",
    "OpenCL device: cpu, gpu, or a part of a name that --list-devices prints [the environment "
    "variable DEFORMVOLUME_DEVICE, or else the best device]");
}

void AddOutput(CLI::App& program, Options& options)
{
  OptionGroup group(program, "Output");
  group.AddList("-o,--output", options.Outputs, "FILE",
    std::string("The deformed volume: .vti (all arrays), ") + FormatsOfOneArray +
      " (the scalars). May be given several times");
  group.AddList("--label-output", options.LabelOutputs, "FILE",
    std::string("The deformed labels of --label-volume: .vti (all arrays), ") + FormatsOfOneArray +
      " (only if there is one array). Labels are 0 outside the deformed volume. May be given "
      "several times");
  group.AddList("--jacobian", options.Jacobians, "FILE",
    std::string("The Jacobian determinant of the deformation (deformed by undeformed volume) at "
                "each voxel of the result: .vti, ") +
      FormatsOfOneArray +
      ". It is negative where the deformation turns tissue inside out, and 0 outside the "
      "deformed volume. May be given several times");
  group.AddList("--fold-count", options.FoldCounts, "FILE",
    std::string("How many parts of the volume lie at each voxel of the result, of which one is "
                "shown: .vti, ") +
      FormatsOfOneArray +
      ". 1 where nothing overlaps, 0 outside the deformed volume. Not for an inverse field. May be "
      "given several times");
  group.AddList("--inverse-field", options.InverseFields, "FILE",
    std::string(
      "The displacement field from each voxel of the result to the point of the volume that is "
      "shown there, as read by ITK, ANTs and 3D Slicer (left, posterior, superior; mm): ") +
      FormatsOfOneArray +
      "; or .vti, in the world coordinates of the volume. May be given several times");
  group.AddList("--points-output", options.PointsOutputs, "FILE",
    "The moved points of --points, in the format and the world coordinates of that file. Give "
    "one for each --points, in the same order. Points outside the deformation stay where they "
    "are");
  group.Add("--write-mesh", options.MeshOutput, "FILE",
    "The mesh of --tetgen or --lattice at rest, in the world coordinates of the volume, with the "
    "point array \"Displacement\" (.vtu). If it is the only output, --push is not needed: the "
    "mesh can be the input of another solver");
  group.Add("--image", options.Image, "FILE",
    "Picture of the volume before and after the deformation, side by side, 700 x 700 pixels each "
    "(.png)");
  group.Add("--movie", options.Movie, "FILE",
    "Pictures like that of --image for each of the --frames steps of --model: one file for each "
    "frame (.png: movie.png makes movie0001.png), or a video in Ogg Theora (.ogv)");
  group
    .Add("--frames", options.Frames, "NUMBER",
      "Number of frames of --movie: the number of steps in which handles move, and into which "
      "mass-spring divides --duration")
    ->check(Decimal)
    ->check(CLI::Range(1, 9999));
  group.AddNumber("--threshold", options.Threshold,
    "Minimum value that the picture shows, approximately [the isovalue of --tetgen, or a fifth "
    "of the range of values]");
  group.Add("--view", options.View, ParseView, "X,Y,Z",
    "Direction from the volume to the viewer of the picture [from in front of a head, slightly "
    "to its side]");
  group.AddFlag("-q,--quiet", options.Quiet, "Print only warnings and errors");
}
}

std::vector<NamedFile> Options::GetOutputs() const
{
  std::vector<NamedFile> outputs;
  const auto add = [&outputs](const char* option, const std::vector<std::string>& paths)
  {
    for (const std::string& path : paths)
    {
      if (!path.empty())
      {
        outputs.push_back({ option, path });
      }
    }
  };
  add("--output", this->Outputs);
  add("--label-output", this->LabelOutputs);
  add("--jacobian", this->Jacobians);
  add("--fold-count", this->FoldCounts);
  add("--inverse-field", this->InverseFields);
  add("--points-output", this->PointsOutputs);
  add("--write-mesh", { this->MeshOutput });
  add("--image", { this->Image });
  add("--movie", { this->Movie });
  return outputs;
}

bool Options::WritesResult() const
{
  const std::vector<NamedFile> outputs = this->GetOutputs();
  return std::any_of(outputs.begin(), outputs.end(),
    [](const NamedFile& output) { return output.Option != "--write-mesh"; });
}

bool Options::UsesLabels() const
{
  return std::any_of(this->Fixations.begin(), this->Fixations.end(),
           [](const Fixation& fixation) { return fixation.Which == Fixation::Kind::Label; }) ||
    std::any_of(this->Materials.begin(), this->Materials.end(),
      [](const MaterialOfValues& material) { return material.IsOfLabel; });
}

bool Options::AreLabels(vtkDataArray* array) const
{
  const std::vector<std::string>& names = this->CategoricalArrays;
  return this->Labels ||
    (array->GetName() && std::find(names.begin(), names.end(), array->GetName()) != names.end());
}

std::optional<int> ParseCommandLine(int argc, char* argv[], Options& options)
{
  CLI::App program("Deforms a volume with a tetrahedral mesh or a displacement field, at full "
                   "resolution, on an OpenCL device.\n",
    "deform-volume");
  const std::string placed = HasITK
    ? "s-form,\nor else their q-form (x to the right, y to the front, z to the head); DICOM "
      "series, MetaImage\nand NRRD files by origin and direction (x to the left, y to the back, z "
      "to the head, unless an\nNRRD file states another space); .vti files by origin and "
      "direction.\n"
    : "s-form,\nor else their q-form (x to the right, y to the front, z to the head); .vti files "
      "by origin and\ndirection.\n";
  program.footer(
    "World coordinates are those of the file, usually in mm. NIfTI files are placed by their " +
    placed +
    "All lengths are in world units. A --field is converted to the world coordinates of the\n"
    "volume, including its vectors.\n\n"
    "Square brackets in the description of an option hold its default.\n\n"
    "Exit codes: 0 success, 1 failure, 2 wrong usage.\n\n"
    "Example: dent a head to a depth of 15 mm\n"
    "  deform-volume head.nii.gz --tetgen --push 0,88,-50,0,-15,0,30 -o dented.nii.gz");
  OptionGroup general(program);
  general.Add("VOLUME", options.Volume, "FILE", std::string("The volume: ") + ReadFormats);
  general
    .Add("--frame", options.Frame, "NUMBER",
      std::string(
        "Index of the volume to read from a file with several time steps, counted from 0 (NIfTI") +
        (HasITK ? ", MetaImage, NRRD)" : ")"))
    ->check(Decimal)
    ->check(NotNegative);
  general.AddChoice("--volume-space", options.VolumeSpace, "SPACE", { "lps", "ras" },
    std::string("World coordinates of a volume whose file does not state them (.vti") +
      (HasITK ? ", some .nrrd" : "") + "): lps or ras, see --field-space");
  general.Add("--label-volume", options.LabelVolume, "FILE",
    "Labels of the voxels of VOLUME, on the same grid, in one of the formats of VOLUME. Labels "
    "must be integers. They are deformed with VOLUME, and not interpolated. Labels of --fix and "
    "--material are those of this file");
  general.AddList("--points", options.Points, "FILE",
    std::string("Points, surfaces or landmarks that belong to VOLUME: ") + PointFormats +
      ". They move with the tissue, from VOLUME (the moving image) to the result (the fixed "
      "image). With the same transforms, antsApplyTransformsToPoints moves points in the "
      "opposite direction. The first line of a .csv file must name its columns, starting with "
      "x,y,z; its world coordinates are lps. May be given several times");
  general.AddFlag("--file-coordinates", options.FileCoordinates,
    std::string("Use the coordinates of VTK's and ParaView's readers: no direction, and the origin "
                "0 for NIfTI files") +
      (HasITK ? " and DICOM series" : ""));
  general.AddFlag(
    "--list-devices", options.ListDevices, "List the OpenCL devices, the best first, and exit");
  program.set_version_flag("--version", "deform-volume " DEFORMVOLUME_VERSION);
  AddDeformation(program, options);
  AddResampling(program, options);
  AddOutput(program, options);
  AddDependencies(program);
  for (CLI::Option* option : program.get_options())
  {
    // Without allow_extra_args(), an option that may be given several times would take VOLUME.
    option->check(NotEmpty)->allow_extra_args(false);
  }
  try
  {
    program.parse(argc, argv);
    Complete(program, options);
  }
  catch (const CLI::Success& request) // --help or --version
  {
    return program.exit(request);
  }
  catch (const CLI::ParseError& error)
  {
    std::cerr << "deform-volume: " << error.what() << "\n";
    return 2;
  }
  catch (const UsageError& error)
  {
    std::cerr << "deform-volume: " << error.what() << "\n";
    return 2;
  }
  return std::nullopt;
}
