// SPDX-License-Identifier: BSD-3-Clause
#include "ElasticModel.h"

#include "ChainMail.h"
#include "Failure.h"
#include "MeshMaking.h"
#include "MeshReading.h"
#include "Messages.h"
#include "Options.h"
#include "ProgressBar.h"
#include "Volume.h"

#include <vtkAppendPolyData.h>
#include <vtkBoundingBox.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFiniteElementDeformation.h>
#include <vtkIdList.h>
#include <vtkMassSpringDeformation.h>
#include <vtkMaterialFromVolume.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStaticCellLocator.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <iomanip>
#include <map>
#include <set>
#include <vector>

namespace
{
// Gives tetrahedra the mean of the materials of their voxels. find(voxel): the index of a material.
// what: what is found, for messages.
template <typename Find>
vtkSmartPointer<vtkUnstructuredGrid> AddMeans(const std::string& what,
  vtkMaterialFromVolume* filter, vtkImageData* volume, vtkUnstructuredGrid* mesh,
  const Options& options, Messages& messages, const Find& find)
{
  vtkNew<vtkUnsignedCharArray> indices;
  indices->SetName("deform-volume: materials"); // arrays of files are unlikely to have this name
  indices->SetNumberOfValues(volume->GetNumberOfPoints());
  for (vtkIdType voxel = 0; voxel < volume->GetNumberOfPoints(); ++voxel)
  {
    indices->SetValue(voxel, static_cast<unsigned char>(find(voxel)));
  }
  vtkNew<vtkImageData> image;
  image->ShallowCopy(volume);
  image->GetPointData()->AddArray(indices);
  filter->SetInputData(mesh);
  filter->SetVolumeData(image);
  filter->SetMaterialArrayName(indices->GetName());
  const ProgressBar bar(filter, what, !options.Quiet);
  filter->Update();
  messages.Check("cannot find the " + what + " of the mesh");
  return filter->GetOutput();
}

// Fixes nodes whose nearest voxel has a label of --fix, and the nodes of tetrahedra of whose voxels
// at least half have one. Warns if much of the tissue with these labels can move.
void FixLabels(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  vtkUnsignedCharArray* fixed, Messages& messages)
{
  std::map<double, bool> isUsed; // for each label
  for (const Fixation& fixation : options.Fixations)
  {
    if (fixation.Which == Fixation::Kind::Label)
    {
      isUsed[fixation.Value] = false;
    }
  }
  if (isUsed.empty())
  {
    return;
  }
  vtkDataArray* values = volume.GetLabels();
  const auto has = [&](vtkIdType voxel)
  {
    const auto found = isUsed.find(values->GetComponent(voxel, 0));
    return found != isUsed.end() && (found->second = true);
  };
  // The mean density of a tetrahedron minus 1 is the share of its voxels with a label.
  vtkNew<vtkMaterialFromVolume> filter;
  filter->SetMaterial(0, 1.0, 0.0, 1.0);
  filter->SetMaterial(1, 1.0, 0.0, 2.0);
  filter->SetDefaultMaterial(0);
  const auto means =
    AddMeans("labels of --fix", filter, volume.Image, mesh, options, messages, has);
  vtkDataArray* densities = means->GetCellData()->GetArray("Density");
  for (const Fixation& fixation : options.Fixations)
  {
    if (fixation.Which == Fixation::Kind::Label && !isUsed[fixation.Value])
    {
      double range[2];
      values->GetFiniteRange(range, 0);
      throw Failure("--fix " + fixation.Text + ": no voxel of " +
        MakeText(volume.Labels ? "--label-volume" : "the volume", " has this value. Values are ",
          range[0], " to ", range[1]));
    }
  }
  for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
  {
    const vtkIdType voxel = volume.Image->FindPoint(mesh->GetPoint(node));
    if (voxel >= 0 && has(voxel))
    {
      fixed->SetValue(node, 1);
    }
  }
  vtkNew<vtkIdList> nodes;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    if (densities->GetComponent(cell, 0) < 1.5)
    {
      continue;
    }
    mesh->GetCellPoints(cell, nodes);
    for (const vtkIdType node : *nodes)
    {
      fixed->SetValue(node, 1);
    }
  }
  double all = 0.0;
  double loose = 0.0;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    mesh->GetCellPoints(cell, nodes);
    const double part = (densities->GetComponent(cell, 0) - 1.0) * GetVolume(mesh, cell);
    all += part;
    const bool isFixed = std::all_of(
      nodes->begin(), nodes->end(), [fixed](vtkIdType node) { return fixed->GetValue(node) != 0; });
    loose += isFixed ? 0.0 : part;
  }
  constexpr double much = 0.2;
  if (!(loose < much * all))
  {
    messages.Warn(MakeText(std::setprecision(3), all > 0.0 ? 100.0 * loose / all : 100.0,
      " % of the tissue with the labels of --fix is in tetrahedra with nodes that are not fixed, "
      "and can move. Use smaller tetrahedra: ",
      options.HasLattice() ? "more nodes of --lattice." : "a smaller --edge-length."));
  }
}

// Whether a node lies below the plane or in the box. tolerance: a length that is more than the
// rounding errors of coordinates.
bool Fixes(const Fixation& fixation, const double point[3], double tolerance)
{
  vtkBoundingBox box(fixation.Bounds.data());
  box.Inflate(tolerance);
  return fixation.Which == Fixation::Kind::Below ? point[2] <= fixation.Value + tolerance
                                                 : box.ContainsPoint(point) != 0;
}

void AddFixedNodes(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  Messages& messages, Deformation& deformation)
{
  const vtkIdType number = mesh->GetNumberOfPoints();
  vtkNew<vtkUnsignedCharArray> fixed;
  fixed->SetName("Fixed");
  fixed->SetNumberOfTuples(number);
  fixed->Fill(0.0);
  const double* spacing = volume.Image->GetSpacing();
  const double tolerance =
    1e-3 * std::min({ std::abs(spacing[0]), std::abs(spacing[1]), std::abs(spacing[2]) });
  for (const Fixation& fixation : options.Fixations)
  {
    if (fixation.Which == Fixation::Kind::Label)
    {
      continue; // see FixLabels()
    }
    bool isAny = false;
    for (vtkIdType node = 0; node < number; ++node)
    {
      if (Fixes(fixation, mesh->GetPoint(node), tolerance))
      {
        fixed->SetValue(node, 1);
        isAny = true;
      }
    }
    if (!isAny)
    {
      throw Failure("--fix " + fixation.Text +
        " fixes no node of the mesh. Positions are world coordinates of the volume");
    }
  }
  FixLabels(options, volume, mesh, fixed, messages);
  mesh->GetPointData()->AddArray(fixed);
  if (!options.Fixations.empty())
  {
    const unsigned char* values = fixed->GetPointer(0);
    deformation.Fixed = MakeText(
      std::count(values, values + number, 1), " of ", number, " nodes at corners of tetrahedra");
  }
  // With --pull this is an error of the model.
  if (options.Pulls.empty() && fixed->GetRange()[0] > 0.0)
  {
    messages.Warn("--fix fixes all nodes of the mesh, so nothing moves. Positions are "
                  "world coordinates of the volume.");
  }
}

// Warns if pulls move the whole body: it follows them without a strain.
void WarnOfLooseBody(const Options& options, Messages& messages)
{
  const bool areEqual = std::all_of(options.Pulls.begin(), options.Pulls.end(),
    [&](const Pull& pull) { return pull.Displacement == options.Pulls.front().Displacement; });
  if (options.Fixations.empty() && !options.Pulls.empty() && areEqual &&
    options.Gravity == std::array<double, 3>())
  {
    messages.Warn("Nothing holds the body, so --pull moves all of it without a deformation. Hold a "
                  "part of it with --fix, or with a --pull whose displacement is 0.");
  }
}

// Without a radius, a pull moves the nearest node, which may be far from its position.
void WarnOfFarPulls(const Options& options, vtkUnstructuredGrid* mesh, Messages& messages)
{
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(mesh);
  locator->BuildLocator();
  for (const Pull& pull : options.Pulls)
  {
    double closest[3];
    vtkIdType cell = -1;
    int part = 0;
    double square = 0.0;
    locator->FindClosestPoint(pull.Point.data(), closest, cell, part, square);
    if (pull.Radius == 0.0 && cell >= 0 && square > mesh->GetCell(cell)->GetLength2())
    {
      messages.Warn(MakeText(std::setprecision(3), "The --pull at ", pull.Point[0], ",",
        pull.Point[1], ",", pull.Point[2], " is ", std::sqrt(square),
        " mm outside the mesh, and moves the nearest node. Are X,Y,Z of --pull world coordinates "
        "of the volume?"));
    }
  }
}

void WarnOfUnusedMaterials(const Options& options, const Volume& volume, Messages& messages)
{
  for (const MaterialOfValues& material : options.Materials)
  {
    vtkDataArray* values =
      material.IsOfLabel ? volume.GetLabels() : volume.Image->GetPointData()->GetScalars();
    bool isUsed = false;
    for (vtkIdType voxel = 0; voxel < values->GetNumberOfTuples() && !isUsed; ++voxel)
    {
      const double value = values->GetComponent(voxel, 0);
      isUsed = value >= material.Minimum && value < material.Maximum;
    }
    if (!isUsed)
    {
      double range[2];
      values->GetFiniteRange(range, 0);
      messages.Warn(material.IsOfLabel
          ? MakeText("No voxel has the label ", material.Minimum, " of --material. Labels are ",
              range[0], " to ", range[1], ".")
          : MakeText("No voxel has a value of the range ", material.Minimum, ":", material.Maximum,
              " of --material. Values of the volume are ", range[0], " to ", range[1], "."));
    }
  }
}

// Gives negative values of voxels the value of the nearest voxel that has another one. The distance
// is the number of steps between voxels.
void FillFromNearest(vtkImageData* volume, std::vector<int>& values)
{
  int dimensions[3];
  volume->GetDimensions(dimensions);
  const vtkIdType steps[3] = { 1, dimensions[0], vtkIdType{ dimensions[0] } * dimensions[1] };
  std::deque<vtkIdType> front;
  for (std::size_t voxel = 0; voxel < values.size(); ++voxel)
  {
    if (values[voxel] >= 0)
    {
      front.push_back(static_cast<vtkIdType>(voxel));
    }
  }
  for (; !front.empty(); front.pop_front())
  {
    const vtkIdType voxel = front.front();
    for (int axis = 0; axis < 3; ++axis)
    {
      const vtkIdType index = voxel / steps[axis] % dimensions[axis];
      for (const int side : { -1, 1 })
      {
        const auto neighbor = static_cast<std::size_t>(voxel + side * steps[axis]);
        if (index + side >= 0 && index + side < dimensions[axis] && values[neighbor] < 0)
        {
          values[neighbor] = values[static_cast<std::size_t>(voxel)];
          front.push_back(static_cast<vtkIdType>(neighbor));
        }
      }
    }
  }
}

// Gives the tetrahedra the materials of their voxels, by --material. A mesh of --tetgen extends
// beyond the body. There, air without a material counts as the nearest voxel of the body.
void AddMaterials(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  const Deformation& deformation, Messages& messages)
{
  if (options.Materials.empty())
  {
    return;
  }
  WarnOfUnusedMaterials(options, volume, messages);
  constexpr int defaultMaterial = 255;
  vtkNew<vtkMaterialFromVolume> filter;
  filter->ClearMaterials();
  filter->SetMaterial(defaultMaterial, options.YoungModulus, options.PoissonRatio, options.Density);
  filter->SetDefaultMaterial(defaultMaterial);
  int index = 0;
  for (const MaterialOfValues& material : options.Materials)
  {
    filter->SetMaterial(index, material.YoungModulus,
      material.PoissonRatio.value_or(options.PoissonRatio),
      material.Density.value_or(options.Density));
    ++index;
  }
  vtkDataArray* values = volume.Image->GetPointData()->GetScalars();
  vtkDataArray* labels = volume.GetLabels();
  const auto isOfBody = [&](double value)
  {
    return !options.TetGen ||
      (deformation.Isovalue ? value >= *deformation.Isovalue : value != 0.0);
  };
  const auto find = [&](vtkIdType voxel)
  {
    for (int i = 0; i < index; ++i)
    {
      const MaterialOfValues& material = options.Materials[i];
      const double value = (material.IsOfLabel ? labels : values)->GetComponent(voxel, 0);
      if (value >= material.Minimum && value < material.Maximum)
      {
        return i;
      }
    }
    return isOfBody(values->GetComponent(voxel, 0)) ? defaultMaterial : -1;
  };
  std::vector<int> indices(static_cast<std::size_t>(values->GetNumberOfTuples()));
  for (std::size_t voxel = 0; voxel < indices.size(); ++voxel)
  {
    indices[voxel] = find(static_cast<vtkIdType>(voxel));
  }
  FillFromNearest(volume.Image, indices);
  mesh->ShallowCopy(AddMeans("materials", filter, volume.Image, mesh, options, messages,
    [&](vtkIdType voxel) { return indices[static_cast<std::size_t>(voxel)]; }));
}

// Returns one surface of all sheets of --cut.
vtkSmartPointer<vtkPolyData> ReadSheets(
  const Options& options, const Volume& volume, Messages& messages)
{
  vtkNew<vtkAppendPolyData> sheets;
  for (const std::string& path : options.Cuts)
  {
    sheets->AddInputData(ReadSheet(path, options, volume, messages));
  }
  sheets->Update();
  return sheets->GetOutput();
}

// Returns how far split faces of a mesh at rest are from the sheet at most. Their nodes have copies
// at the same position.
double FindDistance(vtkPointSet* mesh, vtkPolyData* sheet)
{
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(sheet);
  locator->BuildLocator();
  std::set<std::array<double, 3>> positions;
  double farthest = 0.0;
  for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
  {
    std::array<double, 3> position;
    mesh->GetPoint(node, position.data());
    if (!positions.insert(position).second)
    {
      double closest[3];
      vtkIdType cell = -1;
      int part = 0;
      double square = 0.0;
      locator->FindClosestPoint(position.data(), closest, cell, part, square);
      farthest = std::max(farthest, square);
    }
  }
  return std::sqrt(farthest);
}

// Describes the cuts in the mesh of a model.
std::string DescribeCut(vtkElasticDeformation* model, vtkPolyData* sheet, Messages& messages)
{
  const vtkIdType faces = model->GetNumberOfSplitFaces();
  if (faces == 0)
  {
    messages.Warn(
      "No sheet of --cut crosses the mesh. Are they in the world coordinates of the volume?");
  }
  const std::string split = MakeText(faces, " faces of tetrahedra of the mesh split");
  return faces == 0 ? split
                    : MakeText(split, std::setprecision(3), ", at most ",
                        FindDistance(model->GetOutput(), sheet), " mm from the sheet");
}

// Returns the length of the longest difference between vectors of two arrays.
double FindLongestDifference(vtkDataArray* vectors, vtkDataArray* others)
{
  double longest = 0.0;
  for (vtkIdType i = 0; i < vectors->GetNumberOfTuples(); ++i)
  {
    longest =
      std::max(longest, vtkMath::Distance2BetweenPoints(vectors->GetTuple(i), others->GetTuple(i)));
  }
  return std::sqrt(longest);
}

void SetUp(vtkElasticDeformation* model, const Options& options, vtkUnstructuredGrid* mesh)
{
  model->SetInputData(mesh);
  model->SetHandleRadius(options.Pulls.empty() ? 0.0 : options.Pulls.front().Radius);
  model->SetGravity(options.Gravity.data());
  model->SetYoungModulus(options.YoungModulus);
  model->SetPoissonRatio(options.PoissonRatio);
  model->SetDensity(options.Density);
  model->SetLengthUnitToMillimetre();
}
}

void DeformByElasticModel(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  Messages& messages, Deformation& deformation, const FrameTaker& takeFrame)
{
  AddFixedNodes(options, volume, mesh, messages, deformation);
  AddMaterials(options, volume, mesh, deformation, messages);
  WarnOfFarPulls(options, mesh, messages);
  // update(part): moves the handles by this fraction of their displacements, or simulates this
  // fraction of --duration.
  const auto run = [&](vtkElasticDeformation* model, const auto& update)
  {
    SetUp(model, options, mesh);
    const bool cuts = !options.Cuts.empty();
    const auto sheet = cuts ? ReadSheets(options, volume, messages) : nullptr;
    model->SetSheetData(sheet);
    const int frames = std::max(options.Frames, 1);
    for (int frame = 1; frame <= frames; ++frame)
    {
      {
        const ProgressBar bar(model, "simulating", !options.Quiet);
        update(double(frame) / frames);
      }
      messages.Check("cannot simulate the body");
      deformation.Data = model->GetOutput();
      deformation.Displacement = "Displacement";
      takeFrame(deformation);
    }
    if (cuts)
    {
      deformation.Cut = DescribeCut(model, sheet, messages);
    }
    WarnOfLooseBody(options, messages);
  };
  if (options.Model == "fem")
  {
    vtkNew<vtkFiniteElementDeformation> model;
    model->SetModeToConverged();
    run(model,
      [&](double part)
      {
        model->SetHandlesData(MakeHandles(options.Pulls, part));
        model->Update();
      });
    if (!model->GetIsConverged())
    {
      throw Failure("cannot simulate the body: no equilibrium was found. Reduce --gravity or the "
                    "displacements of --pull, or increase --young");
    }
    deformation.Motion = MakeText(model->GetNumberOfNewtonSteps(),
      " steps to equilibrium, strain energy ", model->GetStrainEnergy(), " J");
  }
  else
  {
    vtkNew<vtkMassSpringDeformation> model;
    model->SetDevice(options.Device);
    model->SetEndTime(options.Duration); // without a time range, VTK ignores all but the first time
    model->SetFrameTime(options.Duration); // handles move during the whole of an update
    double simulated = 0.0;
    double step = 0.0;
    // Handles move during the first half of --duration. A jump would turn tetrahedra inside out.
    const auto simulate = [&](double part)
    {
      if (part > simulated)
      {
        model->SetHandlesData(MakeHandles(options.Pulls, std::min(1.0, 2.0 * part)));
        model->UpdateTimeStep(part * options.Duration);
        messages.Check("cannot simulate the body");
        simulated = part;
        step = std::max(step, model->GetTimeStepInUse());
      }
    };
    vtkNew<vtkDoubleArray> before;
    double seconds = 0.0; // from before to the end
    run(model,
      [&](double part)
      {
        simulate(std::min(part, 0.5));
        if (part == 1.0)
        {
          simulate(0.99);
          before->DeepCopy(model->GetOutput()->GetPointData()->GetArray("Displacement"));
          seconds = (1.0 - simulated) * options.Duration;
        }
        simulate(part);
      });
    vtkDataArray* displacements = model->GetOutput()->GetPointData()->GetArray("Displacement");
    const double speed = FindLongestDifference(displacements, before) / seconds;
    deformation.Motion = MakeText(options.Duration, " s, in steps of ", 1e3 * step,
      " ms, at the end at up to ", std::setprecision(3), speed, " mm/s");
    constexpr double fast = 0.1; // of the longest displacement, in a second
    if (options.Movie.empty() && speed > fast * displacements->GetMaxNorm())
    {
      messages.Warn(MakeText(std::setprecision(3), "The springs still move by up to ", speed,
        " mm/s at the end of --duration. Use a longer one, or --model fem, for the "
        "shape at rest."));
    }
  }
}
