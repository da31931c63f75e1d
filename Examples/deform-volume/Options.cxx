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

#include <initializer_list>
#include <iostream>

namespace
{
/// Options that need more than their own text to be right.
struct RawOptions
{
  std::string Lattice;
  std::vector<std::string> Pushes;
  std::vector<std::string> Pulls;
  std::vector<std::string> Fixations;
  std::vector<std::string> Materials;
  std::string Gravity = "0,0,0";
  std::vector<std::string> Carvings;
  std::vector<std::string> Transforms;
  std::string View;
  std::string Outside = "discard";
  std::string Bounds = "deformed";
};

/// What no range holds is of a tissue.
void SetTissue(const CLI::App& program, const std::string& tissue, Options& options)
{
  if (!options.Tissue.empty())
  {
    throw UsageError("--material " + tissue + ": the body is already of --material " +
      options.Tissue + ". Give one of them a range of values, MINIMUM:MAXIMUM=TISSUE");
  }
  for (const char* option : { "--young", "--poisson", "--density" })
  {
    if (program.count(option))
    {
      throw UsageError("--material " + tissue + " sets what " + option +
        " sets. Leave one of them out, or give the tissue a range of values, "
        "MINIMUM:MAXIMUM=TISSUE");
    }
  }
  options.Tissue = tissue;
  const std::array<double, 3> values = *FindTissue(tissue);
  options.YoungModulus = values[0];
  options.PoissonRatio = values[1];
  options.Density = values[2];
}

void Complete(const CLI::App& program, const RawOptions& raw, Options& options)
{
  if (!raw.Lattice.empty())
  {
    options.Lattice = ParseNumbers<int, 3>(
      "--lattice", raw.Lattice, "three node counts NX,NY,NZ with commas between them");
    for (const int nodes : options.Lattice)
    {
      if (nodes < 2)
      {
        throw UsageError("--lattice " + raw.Lattice + ": each axis needs at least 2 nodes");
      }
    }
  }
  for (const std::string& text : raw.Pushes)
  {
    options.Pushes.push_back(ParsePush(text));
  }
  for (const std::string& text : raw.Pulls)
  {
    options.Pulls.push_back(ParsePull(text));
  }
  for (const std::string& text : raw.Fixations)
  {
    options.Fixations.push_back(ParseFixation(text));
  }
  for (const std::string& text : raw.Materials)
  {
    if (FindTissue(text))
    {
      SetTissue(program, text, options);
    }
    else
    {
      options.Materials.push_back(ParseMaterial(text));
    }
  }
  options.Gravity = ParseNumbers<double, 3>(
    "--gravity", raw.Gravity, "three numbers X,Y,Z with commas between them");
  for (const std::string& text : raw.Carvings)
  {
    options.Carvings.push_back(ParseCarving(text));
  }
#ifndef DEFORMVOLUME_HAVE_ITK
  if (!raw.Transforms.empty())
  {
    throw UsageError("--transform: this program was built without ITK, which reads transforms");
  }
#endif
  for (const std::string& text : raw.Transforms)
  {
    options.Transforms.push_back(ParseTransform(text));
  }
  if (!raw.View.empty())
  {
    options.View = ParseNumbers<double, 3>("--view", raw.View, "three numbers X,Y,Z");
    if (*options.View == std::array<double, 3>{ { 0.0, 0.0, 0.0 } })
    {
      throw UsageError("--view 0,0,0 is no direction");
    }
  }
  options.Extrapolate = raw.Outside == "extrapolate";
  options.VolumeBounds = raw.Bounds == "volume" || !options.Transforms.empty();
  if (!options.Transforms.empty())
  {
    if (program.count("--bounds") && raw.Bounds != "volume")
    {
      throw UsageError("--bounds deformed: a --transform is known on the grid of the volume, or of "
                       "the --reference, where the result lies");
    }
    options.FieldIsInverse = true;
  }
  CheckOptions(options);
}

void AddElasticModel(CLI::App& program, Options& options, RawOptions& raw)
{
  const char* group = "With --model fem or mass-spring";
  program
    .add_option("--fix", raw.Fixations,
      "Nodes that stay where they are: those in a box, those with a z of at most Z, or those in "
      "voxels of the value N. May be given several times")
    ->type_name("box:X0,X1,Y0,Y1,Z0,Z1|below:Z|label:N")
    ->take_all()
    ->expected(1)
    ->group(group);
  program.add_option("--gravity", raw.Gravity, "The acceleration of gravity, in m/s^2")
    ->capture_default_str()
    ->type_name("X,Y,Z")
    ->group(group);
  const auto addNumber = [&](const char* name, double& value, const char* help)
  {
    program.add_option(name, value, help)->capture_default_str()->type_name("NUMBER")->group(group);
  };
  program
    .add_option("--material", raw.Materials,
      "Voxels with values from MINIMUM on, less than MAXIMUM, have the Young modulus E (Pa), the "
      "Poisson ratio NU and the DENSITY, or those of a TISSUE, and each tetrahedron has the mean "
      "of "
      "its voxels. The first range that holds a value counts; what none holds is of the TISSUE "
      "that "
      "is given without a range, or else has --young, --poisson and --density. Tissues: " +
        GetTissues() + ". May be given several times")
    ->type_name("TISSUE|MINIMUM:MAXIMUM=TISSUE|MINIMUM:MAXIMUM=E[,NU[,DENSITY]]")
    ->take_all()
    ->expected(1)
    ->group(group);
  addNumber("--young", options.YoungModulus, "Young modulus, in Pa");
  addNumber("--poisson", options.PoissonRatio, "Poisson ratio, from 0 to less than 0.495");
  addNumber("--density", options.Density, "Density, in kg/m^3");
  addNumber("--duration", options.Duration, "With mass-spring: how long it moves, in s");
}

void AddDeformation(CLI::App& program, Options& options, RawOptions& raw)
{
  const char* group =
    "What deforms the volume (one of --mesh, --field, --transform, --tetgen, --lattice, --model)";
  program
    .add_option("--mesh", options.Mesh,
      "Mesh (" + GetMeshSuffixes() +
        "; cells are split into tetrahedra), or a displacement field (.vti). Of a series in time "
        "the "
        "last step is read")
    ->type_name("FILE")
    ->group(group);
  program
    .add_option("--field", options.Field,
      "Displacement field: .nii or .nii.gz of the shape (X,Y,Z,1,3) with the intent 1006 (vectors "
      "right, anterior, superior) or 1007 (left, posterior, superior, as ITK and ANTs write "
      "them), " +
        std::string(HasITK ? ".mha, .mhd, .nrrd, .nhdr " : "") +
        "or .vti. It is forward: it leads from a point of the volume to where that point goes, see "
        "--field-is-inverse")
    ->type_name("FILE")
    ->group(group);
  program
    .add_flag("--field-is-inverse", options.FieldIsInverse,
      "The --field leads from a point of the result to the point of the volume that is seen there, "
      "as registration programs write it (from the fixed to the moving image)")
    ->group(group);
  program
    .add_option("--field-space", options.FieldSpace,
      "The world of a --field that does not say it itself: lps (x to the left, y to the back, z to "
      "the head) or ras (x to the right, y to the front) [that of the volume]")
    ->check(CLI::IsMember({ "lps", "ras" }))
    ->type_name("SPACE")
    ->group(group);
  program
    .add_option("--transform", raw.Transforms,
      HasITK
        ? "A registration's transform, from the result (the fixed image) to the volume (the moving "
          "one), as ITK, SimpleITK, ANTs and 3D Slicer write it: .h5, .tfm, .txt or .mat with a "
          "matrix, a B-spline, a displacement field or a composition, or a displacement field as "
          "for --field. With ,invert behind its name a matrix is inverted. May be given several "
          "times: points go through the last one first, as with antsApplyTransforms"
        : "A registration's transform, which a program reads that was built with ITK: this one was "
          "not")
    ->type_name("FILE[,invert]")
    ->take_all()
    ->expected(1)
    ->group(group);
  program
    .add_option("--displacement", options.Displacement,
      "Name of the point array of --mesh or of a --field in a .vti file that holds the "
      "displacements, in world units and forward; the points of --mesh are then the mesh at rest")
    ->type_name("NAME")
    ->group(group);
  program
    .add_option("--rest", options.Rest,
      "The mesh at rest, with the cells of --mesh; the points of --mesh are then deformed")
    ->type_name("FILE")
    ->group(group);
  program
    .add_option("--mesh-space", options.MeshSpace,
      "The world of files of --mesh, --rest, --cut and --points (.vtp, .vtu) that do not say it "
      "themselves, as those of "
      "3D "
      "Slicer do: lps (x to the left, y to the back, z to the head) or ras (x to the right, y to "
      "the front) [that of the volume]")
    ->check(CLI::IsMember({ "lps", "ras" }))
    ->type_name("SPACE")
    ->group(group);
  program
    .add_flag("--points-are-deformed", options.PointsAreDeformed,
      "The points of --mesh are deformed already: their displacements lead from the rest "
      "positions to them")
    ->group(group);
  program.add_option("--scale", options.Scale, "Factor on the displacements of --mesh")
    ->capture_default_str()
    ->type_name("NUMBER")
    ->group(group);
  program
    .add_flag(
      "--tetgen", options.TetGen, "Mesh the body that the volume shows with TetGen, then --push")
    ->group(group);
  program
    .add_option("--lattice", raw.Lattice,
      "Mesh of cubes over the whole volume, of five tetrahedra each, with at most so many nodes on "
      "each axis, then --push")
    ->type_name("NX,NY,NZ")
    ->group(group);
  program
    .add_option("--push", raw.Pushes,
      "Move the nodes round X,Y,Z (world coordinates) by DX,DY,DZ (world units), falling smoothly "
      "to nothing at RADIUS (world units). May be given several times: pushes add up")
    ->type_name("X,Y,Z,DX,DY,DZ,RADIUS")
    ->take_all()
    ->expected(1)
    ->group(group);

  program
    .add_option("--model", options.Model,
      "chainmail: each voxel is linked to its neighbours, which follow a --pull as far as their "
      "links do not give way. fem, with --tetgen or --lattice: the mesh comes to equilibrium, by "
      "finite elements. mass-spring, with --lattice: it moves for some time. Units are mm")
    ->check(CLI::IsMember({ "chainmail", "fem", "mass-spring" }))
    ->type_name("NAME")
    ->group(group);
  program
    .add_option("--pull", raw.Pulls,
      "With --model: take the voxels or nodes within RADIUS of X,Y,Z (world coordinates; by "
      "default "
      "the nearest one) and move them by DX,DY,DZ (world units). May be given several times")
    ->type_name("X,Y,Z,DX,DY,DZ[,RADIUS]")
    ->take_all()
    ->expected(1)
    ->group(group);
  AddElasticModel(program, options, raw);

  const char* tools = "What is cut before (alone, or with what deforms the volume)";
  program
    .add_option("--cut", options.Cuts,
      "Cut the volume along a sheet of triangles (" + GetSheetSuffixes() +
        ", world coordinates); with --model fem or "
        "mass-spring the mesh, before it moves, and the volume opens there. May be given several "
        "times")
    ->type_name("FILE")
    ->take_all()
    ->expected(1)
    ->group(tools);
  program
    .add_flag("--smooth-cut", options.SmoothCut,
      "With --cut: divide what a sheet crosses between its two sides, in place of leaving it out. "
      "Needs the resampler exact or automatic")
    ->group(tools);
  program
    .add_option("--carve", raw.Carvings,
      "Carve a sphere out of the volume (world coordinates and units). May be given several times")
    ->type_name("sphere:X,Y,Z,RADIUS")
    ->take_all()
    ->expected(1)
    ->group(tools);

  const char* tetgen = "Mesh of --tetgen";
  program
    .add_option("--isovalue", options.Isovalue,
      "Value from which on a voxel belongs to the body [chosen by the histogram]")
    ->type_name("NUMBER")
    ->group(tetgen);
  program
    .add_option("--pieces", options.Pieces,
      "Of a body in several pieces, mesh all or the largest alone: all or largest. Specks of up to "
      "26 voxels are left out")
    ->capture_default_str()
    ->check(CLI::IsMember({ "all", "largest" }))
    ->type_name("MODE")
    ->group(tetgen);
  program
    .add_option("--edge-length", options.EdgeLength,
      "Length of the tetrahedra's edges, in world units; 0: a twentieth of the diagonal of the "
      "volume, and a tenth with --model fem, which has nodes in the middle of edges as well. "
      "Within a --push, edges are at most a sixth of its radius")
    ->capture_default_str()
    ->check(CLI::NonNegativeNumber)
    ->type_name("NUMBER")
    ->group(tetgen);
  program
    .add_option("--radius-edge-ratio", options.RadiusEdgeRatio,
      "Quality of the tetrahedra: circumscribed radius by shortest edge, 1 to 100")
    ->capture_default_str()
    ->check(CLI::Range(1.0, 100.0))
    ->type_name("NUMBER")
    ->group(tetgen);
  program
    .add_option("--tetgen-executable", options.TetGenExecutable,
      "The TetGen program [the one found when this program was built]")
    ->type_name("FILE")
    ->group(tetgen);
}

/// Options that say nothing about what is asked for are mistakes, and are not ignored.
void AddDependencies(CLI::App& program)
{
  const auto needs = [&](const char* needed, std::initializer_list<const char*> options)
  {
    for (const char* option : options)
    {
      program.get_option(option)->needs(program.get_option(needed));
    }
  };
  needs("--mesh", { "--rest", "--points-are-deformed" });
  needs("--field", { "--field-is-inverse" });
  needs("--tetgen",
    { "--isovalue", "--pieces", "--edge-length", "--radius-edge-ratio", "--tetgen-executable" });
  needs("--model",
    { "--pull", "--fix", "--gravity", "--material", "--young", "--poisson", "--density",
      "--duration", "--frames", "--movie" });
  needs("--label-volume", { "--label-output" });
  needs("--label-output", { "--label-volume" });
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
  for (const char* option : { "--bounds", "--padding", "--file-coordinates" })
  {
    program.get_option("--reference")->excludes(program.get_option(option));
  }
  program.get_option("--keep")->excludes(program.get_option("--outside"));
  program.get_option("--isovalue")->excludes(program.get_option("--labels"));
  for (const char* option : { "--mesh", "--field", "--transform" })
  {
    program.get_option("--write-mesh")->excludes(program.get_option(option));
  }
}

void AddResampling(CLI::App& program, Options& options, RawOptions& raw)
{
  const char* group = "How it is deformed";
  program
    .add_option("--outside", raw.Outside,
      "Voxels outside the mesh: discard, or extrapolate from the nearest tetrahedron")
    ->capture_default_str()
    ->check(CLI::IsMember({ "discard", "extrapolate" }))
    ->type_name("MODE")
    ->group(group);
  program
    .add_option("--keep", options.KeepDistance,
      "Tissue outside the mesh stays where it is: what the nearest point of the mesh does fades to "
      "nothing within DISTANCE (world units; 0: a hard edge)")
    ->check(CLI::NonNegativeNumber)
    ->type_name("DISTANCE")
    ->group(group);
  program
    .add_option("--reference", options.Reference,
      "An image, of the types of VOLUME, whose grid the result gets: its voxels, their spacing, "
      "direction and place. Its values are not used. With --transform that is the fixed image")
    ->type_name("FILE")
    ->group(group);
  program
    .add_option("--bounds", raw.Bounds,
      "Extent of the result: that of the deformed volume, or of the volume at rest")
    ->capture_default_str()
    ->check(CLI::IsMember({ "deformed", "volume" }))
    ->type_name("MODE")
    ->group(group);
  program.add_option("--padding", options.Padding, "Border on each side of the result, in voxels")
    ->capture_default_str()
    ->check(CLI::Range(0, 1000))
    ->type_name("VOXELS")
    ->group(group);
  program
    .add_option("--background", options.Background,
      "Value of the voxels that the deformed volume does not cover [the least value where values "
      "can "
      "be negative, which is air in CT, else 0]")
    ->type_name("NUMBER")
    ->group(group);
  program
    .add_option("--categorical", options.CategoricalArrays,
      "Name of an array of labels, which are never mixed. May be given several times")
    ->type_name("NAME")
    ->take_all()
    ->expected(1)
    ->group(group);
  program.add_flag("--labels", options.Labels, "All arrays hold labels")->group(group);
  program
    .add_option("--density-array", options.DensityArrays,
      "Name of an array of amounts for each unit of volume, such as a dose or an activity: its "
      "values "
      "are divided by how many times as large the deformation makes the volume, so that their sum "
      "stays. They become float, or stay double. May be given several times")
    ->type_name("NAME")
    ->take_all()
    ->expected(1)
    ->group(group);
  program
    .add_option("--resampler", options.Resampler,
      "exact: deforms a mesh of the voxels; mesh-rasterization: looks the volume up from the "
      "deformation mesh, with less memory")
    ->capture_default_str()
    ->check(CLI::IsMember({ "automatic", "exact", "mesh-rasterization" }))
    ->type_name("NAME")
    ->group(group);
  program
    .add_option("--interpolation", options.Interpolation,
      "linear; nearest, which mixes no values, as --labels; or cubic, over 64 voxels, and linear "
      "where some of these are missing or cut off")
    ->capture_default_str()
    ->check(CLI::IsMember({ "nearest", "linear", "cubic" }))
    ->type_name("NAME")
    ->group(group);
  program
    .add_option("--device", options.Device,
      "OpenCL device: cpu, gpu, or a part of a name in --list-devices [the best; or what the "
      "environment variable DEFORMVOLUME_DEVICE says]")
    ->type_name("NAME")
    ->group(group);
}

void AddOutput(CLI::App& program, Options& options, RawOptions& raw)
{
  const char* group = "What is written";
  program
    .add_option("-o,--output", options.Outputs,
      std::string("The deformed volume: .vti (all arrays), ") + FormatsOfOneArray +
        " (the scalars). May be given several times")
    ->type_name("FILE")
    ->take_all()
    ->expected(1)
    ->group(group);
  program
    .add_option("--label-output", options.LabelOutputs,
      std::string(
        "The deformed labels of --label-volume, in files of their own: .vti (all arrays), ") +
        FormatsOfOneArray +
        " (where there is one array). They are 0 where the deformed volume does not reach. May be "
        "given several times")
    ->type_name("FILE")
    ->take_all()
    ->expected(1)
    ->group(group);
  program
    .add_option("--jacobian", options.Jacobians,
      std::string(
        "How many times as large the deformation makes the volume at each voxel of the "
        "result, less than 0 where it turns it inside out, and 0 where the deformed volume "
        "does not reach: .vti, ") +
        FormatsOfOneArray + ". May be given several times")
    ->type_name("FILE")
    ->take_all()
    ->expected(1)
    ->group(group);
  program
    .add_option("--inverse-field", options.InverseFields,
      std::string(
        "The displacement field from each voxel of the result to the point of the volume "
        "that it shows, as ITK, ANTs and 3D Slicer read it (left, posterior, superior; mm): ") +
        FormatsOfOneArray + "; or .vti, in the world of the volume. May be given several times")
    ->type_name("FILE")
    ->take_all()
    ->expected(1)
    ->group(group);
  program
    .add_option("--points-output", options.PointsOutputs,
      "The moved points of --points, in the format and the world of that file: the first one "
      "belongs to the first --points, the second one to the second. Points outside the deformation "
      "stay where they are")
    ->type_name("FILE")
    ->take_all()
    ->expected(1)
    ->group(group);
  program
    .add_option("--write-mesh", options.MeshOutput,
      "The mesh of --tetgen or --lattice at rest, in the world of the volume, with the point array "
      "\"Displacement\" (.vtu). Without any other output and without --push it is the mesh for "
      "another solver")
    ->type_name("FILE")
    ->group(group);
  program
    .add_option("--image", options.Image,
      "Picture of the volume before and after, 700 x 700 pixels each, side by side (.png)")
    ->type_name("FILE")
    ->group(group);
  program
    .add_option("--movie", options.Movie,
      "Pictures like that of --image of the way there, which --model goes in --frames steps: a "
      "file "
      "for each frame (.png: movie.png makes movie0001.png), or a video in Ogg Theora (.ogv)")
    ->type_name("FILE")
    ->group(group);
  program
    .add_option("--frames", options.Frames,
      "How many: handles go as many steps, and mass-spring takes as many parts of --duration")
    ->check(CLI::Range(1, 9999))
    ->type_name("NUMBER")
    ->group(group);
  program
    .add_option("--threshold", options.Threshold,
      "Value from about which on the picture shows something [the isovalue of --tetgen, or a fifth "
      "of the range of values]")
    ->type_name("NUMBER")
    ->group(group);
  program
    .add_option("--view", raw.View,
      "Direction from the volume to the viewer of the picture [one from which a face looks at the "
      "viewer: in front, a little from the side]")
    ->type_name("X,Y,Z")
    ->group(group);
  program.add_flag("-q,--quiet", options.Quiet, "No progress bar and no table of timings")
    ->group(group);
}
}

std::optional<int> ParseCommandLine(int argc, char* argv[], Options& options)
{
  CLI::App program("Deforms a volume with a tetrahedral mesh or a displacement field, at full "
                   "resolution, on an OpenCL device.\n",
    "deform-volume");
  const std::string placed = HasITK
    ? "s-form,\nor else their q-form (x to the right, y to the front, z to the head); DICOM "
      "series, "
      "MetaImage\nand NRRD files by origin and direction (x to the left, y to the back, z to the "
      "head, unless an\nNRRD file says otherwise); .vti files as they are. "
    : "s-form,\nor else their q-form (x to the right, y to the front, z to the head); .vti files "
      "as "
      "they are.\n";
  program.footer(
    "World coordinates are those of the file, mostly in mm: NIfTI files are placed by their " +
    placed +
    "All lengths are in these units. A --field is\n"
    "turned into the world of the volume, its vectors included.\n\n"
    "Exit codes: 0 success, 1 failure, 2 wrong usage.\n\n"
    "Example: dent a head to a depth of 15 mm\n"
    "  deform-volume head.nii.gz --tetgen --push 0,88,-50,0,-15,0,30 -o dented.nii.gz");
  options.RadiusEdgeRatio = 1.414;
  RawOptions raw;
  program.add_option("VOLUME", options.Volume, std::string("The volume: ") + ReadFormats)
    ->type_name("FILE");
  program
    .add_option("--frame", options.Frame,
      std::string("Which volume of a file with several in time, counted from 0 (NIfTI") +
        (HasITK ? ", MetaImage, NRRD)" : ")"))
    ->check(CLI::NonNegativeNumber)
    ->type_name("NUMBER");
  program
    .add_option("--volume-space", options.VolumeSpace,
      std::string("The world of a volume whose file does not say it (.vti") +
        (HasITK ? ", some .nrrd" : "") + "): lps or ras, see --field-space")
    ->check(CLI::IsMember({ "lps", "ras" }))
    ->type_name("SPACE");
  program
    .add_option("--label-volume", options.LabelVolume,
      "Labels of the voxels of VOLUME, on its grid, in a file of the same types: whole numbers, "
      "which are deformed with it and never mixed")
    ->type_name("FILE");
  program
    .add_option("--points", options.Points,
      std::string("Points, surfaces or landmarks that belong to VOLUME: ") + PointFormats +
        ". They move with the tissue, from VOLUME (the moving image) to the result (the fixed "
        "image). antsApplyTransformsToPoints leads points the opposite way by the same transforms. "
        "The first line of a .csv file names its columns, which begin with x,y,z; its world is "
        "lps. May be given several times")
    ->type_name("FILE")
    ->take_all()
    ->expected(1);
  program.add_flag("--file-coordinates", options.FileCoordinates,
    std::string(
      "Do as VTK's and ParaView's readers do: no direction, and origin 0 for NIfTI files") +
      (HasITK ? " and DICOM series" : ""));
  program.add_flag(
    "--list-devices", options.ListDevices, "List the OpenCL devices, the best first, and end");
  AddDeformation(program, options, raw);
  AddResampling(program, options, raw);
  AddOutput(program, options, raw);
  AddDependencies(program);
  try
  {
    program.parse(argc, argv);
    Complete(program, raw, options);
  }
  catch (const CLI::CallForHelp& help)
  {
    return program.exit(help);
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
