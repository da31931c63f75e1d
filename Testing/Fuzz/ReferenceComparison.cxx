// SPDX-License-Identifier: BSD-3-Clause
#include "Comparison.h"

#include "RandomDisplacements.h"
#include "Reference.h"

#include <vtkAOSDataArrayTemplate.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace fuzz
{

namespace
{

// The reference is slow.
constexpr vtkIdType LARGEST_VOLUME = 1500;
constexpr vtkIdType LARGEST_OUTPUT = 60000;

vtkUnsignedCharArray* GetMask(vtkDataSetAttributes* attributes, const char* name)
{
  return vtkUnsignedCharArray::SafeDownCast(attributes->GetAbstractArray(name));
}

// Returns the factors from indices of the volume to indices of the output.
std::array<double, 3> GetScale(vtkImageData* output, vtkImageData* volume)
{
  std::array<double, 3> scale;
  for (int axis = 0; axis < 3; ++axis)
  {
    scale[axis] = volume->GetSpacing()[axis] / output->GetSpacing()[axis];
  }
  return scale;
}

// Finds the deformed positions of the voxels. Returns false if they are not exact.
bool FindPositions(vtkImageData* output, vtkImageData* volume, vtkDataSet* deformation,
  double factor, reference::SamplingMesh& mesh)
{
  vtkDataArray* vectors = deformation->GetPointData()->GetArray(DISPLACEMENTS);
  if (!vectors || deformation->GetNumberOfPoints() != volume->GetNumberOfPoints())
  {
    return false;
  }
  const std::array<double, 3> scale = GetScale(output, volume);
  for (vtkIdType point = 0; point < volume->GetNumberOfPoints(); ++point)
  {
    double rest[3];
    double node[3];
    volume->GetPoint(point, rest);
    deformation->GetPoint(point, node);
    reference::Position position;
    reference::Position displacement;
    const std::int64_t size[3] = { reference::GetSize(mesh.Voxels, 0),
      reference::GetSize(mesh.Voxels, 1), reference::GetSize(mesh.Voxels, 2) };
    const std::int64_t offset[3] = { point % size[0], point / size[0] % size[1],
      point / (size[0] * size[1]) };
    for (int axis = 0; axis < 3; ++axis)
    {
      const double index = static_cast<double>(mesh.Voxels[2 * axis] + offset[axis]);
      const double moved = factor * vectors->GetComponent(point, axis);
      const double exact = 256.0 * (index * scale[axis] + moved / output->GetSpacing()[axis]);
      if (node[axis] != rest[axis] || exact != std::nearbyint(exact) || std::abs(exact) > 1e9)
      {
        return false;
      }
      position[axis] = static_cast<std::int64_t>(exact);
      displacement[axis] =
        position[axis] - static_cast<std::int64_t>(std::floor(256.0 * index * scale[axis]));
    }
    mesh.Positions.push_back(position);
    mesh.Displacements.push_back(displacement);
  }
  return true;
}

void FindMasks(vtkImageData* volume, reference::SamplingMesh& mesh)
{
  const char* const ghosts = vtkDataSetAttributes::GhostArrayName();
  mesh.Present.assign(static_cast<std::size_t>(volume->GetNumberOfPoints()), true);
  if (vtkUnsignedCharArray* points = GetMask(volume->GetPointData(), ghosts))
  {
    for (vtkIdType point = 0; point < volume->GetNumberOfPoints(); ++point)
    {
      mesh.Present[static_cast<std::size_t>(point)] =
        (points->GetValue(point) &
          (vtkDataSetAttributes::HIDDENPOINT | vtkDataSetAttributes::DUPLICATEPOINT)) == 0;
    }
  }
  if (vtkDataArray* distances = volume->GetPointData()->GetArray("BoundaryDistance"))
  {
    for (vtkIdType point = 0; point < volume->GetNumberOfPoints(); ++point)
    {
      mesh.Distances.push_back(static_cast<float>(distances->GetComponent(point, 0)));
    }
  }
  vtkUnsignedCharArray* crossed = GetMask(volume->GetCellData(), "CutTetrahedra");
  if (vtkDataArray* distances = volume->GetPointData()->GetArray("CutDistance"))
  {
    mesh.Crossed.assign(
      crossed->GetPointer(0), crossed->GetPointer(0) + volume->GetNumberOfCells());
    for (vtkIdType point = 0; point < volume->GetNumberOfPoints(); ++point)
    {
      mesh.CutDistances.push_back(static_cast<float>(distances->GetComponent(point, 0)));
    }
  }
  mesh.Active.assign(static_cast<std::size_t>(volume->GetNumberOfCells()), 31);
  vtkUnsignedCharArray* active = GetMask(volume->GetCellData(), "ActiveTetrahedra");
  vtkUnsignedCharArray* hidden = GetMask(volume->GetCellData(), ghosts);
  for (vtkIdType cell = 0; cell < volume->GetNumberOfCells(); ++cell)
  {
    unsigned char& bits = mesh.Active[static_cast<std::size_t>(cell)];
    bits = active ? active->GetValue(cell) & 31 : bits;
    bits = hidden && (hidden->GetValue(cell) & vtkDataSetAttributes::HIDDENCELL) ? 0 : bits;
  }
}

template <typename T>
bool IsRight(const reference::Containing& winner, const T* input, int components, int component,
  T value, bool categorical, long double slack)
{
  const std::int64_t exact = categorical ? winner.GetNearestVertex() : winner.GetSingleVertex();
  if (exact >= 0)
  {
    return std::memcmp(&input[exact * components + component], &value, sizeof(T)) == 0;
  }
  const long double expected = winner.Interpolate(input, components, component);
  const long double magnitude = winner.Magnitude(input, components, component);
  if (!std::isfinite(expected) || !std::isfinite(magnitude))
  {
    return std::isnan(expected) ? value != value : static_cast<long double>(value) == expected;
  }
  // The rounding of the result, and the errors of a sum in double precision.
  long double tolerance = std::numeric_limits<double>::epsilon() * 8.0L * magnitude + slack;
  if (std::is_integral<T>::value && sizeof(T) == 8)
  {
    // The kernels interpolate differences to the value of one of the vertices, with nine roundings
    // at most. Differences may be larger than the result by the value of that vertex.
    for (const std::int64_t vertex : winner.Vertices)
    {
      const auto of = static_cast<long double>(input[vertex * components + component]);
      tolerance = std::max(
        tolerance, std::numeric_limits<double>::epsilon() * 4.5L * (magnitude + std::fabs(of)));
    }
  }
  tolerance += std::is_integral<T>::value
    ? 0.5L
    : std::numeric_limits<T>::epsilon() * std::fabs(expected) * 0.51L +
      static_cast<long double>(std::numeric_limits<T>::denorm_min());
  return std::fabs(static_cast<long double>(value) - expected) <= tolerance;
}

// Describes all tetrahedra that contain a voxel. The first one is the one that writes the voxel.
template <typename T>
std::string Describe(const std::vector<reference::Containing>& candidates, const T* input,
  int components, int component)
{
  std::ostringstream text;
  for (const reference::Containing& one : candidates)
  {
    text << (text.tellp() > 0 ? "; " : " ") << one.Interpolate(input, components, component)
         << " of tetrahedron " << one.Tetrahedron << " of cell " << one.Cell
         << (one.Inverted ? ", inverted" : "") << (one.Generic ? ", generic" : "");
    for (int k = 0; k < 4; ++k)
    {
      text << (k == 0 ? ", weights " : " ") << one.Numerators[k] << " of voxel " << one.Vertices[k];
    }
  }
  return text.str();
}

template <typename T>
std::string CompareArray(const reference::Result& result, vtkDataArray* source, vtkDataArray* array,
  bool categorical, bool cubic)
{
  // Copy the values to contiguous memory, because arrays may have any layout.
  vtkNew<vtkAOSDataArrayTemplate<T>> copy;
  copy->DeepCopy(source);
  const T* input = copy->GetPointer(0);
  const auto* output = static_cast<const T*>(array->GetVoidPointer(0));
  const int components = source->GetNumberOfComponents();
  // The kernel for CPUs interpolates these types in single precision.
  long double slack = 0.0L;
  if (components == 1 && !categorical && (std::is_same<T, float>::value || sizeof(T) <= 2))
  {
    for (vtkIdType id = 0; id < source->GetNumberOfTuples(); ++id)
    {
      const auto value = std::fabs(static_cast<long double>(input[id]));
      slack = std::isfinite(value) ? std::max(slack, 1e-5L * value) : slack;
    }
  }
  for (std::size_t voxel = 0; voxel < result.Voxels.size(); ++voxel)
  {
    if (result.Voxels[voxel].empty())
    {
      continue;
    }
    const reference::Containing& winner = result.Voxels[voxel].front();
    if (cubic && !categorical && winner.GetSingleVertex() < 0)
    {
      continue; // the reference has linear interpolation only
    }
    for (int component = 0; component < components; ++component)
    {
      const T value = output[voxel * static_cast<std::size_t>(components) + component];
      if (!IsRight(winner, input, components, component, value, categorical, slack))
      {
        return std::string("array ") + source->GetName() + " is " + std::to_string(value) +
          " at point " + std::to_string(voxel) + " where the reference has" +
          Describe(result.Voxels[voxel], input, components, component);
      }
    }
  }
  return "";
}

std::string CompareArrays(const reference::Result& result, vtkImageData* output,
  vtkImageData* volume, const Settings& settings)
{
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  for (std::size_t voxel = 0; voxel < result.Voxels.size(); ++voxel)
  {
    const bool covered = mask->GetComponent(static_cast<vtkIdType>(voxel), 0) != 0.0;
    if (covered == result.Voxels[voxel].empty())
    {
      return "point " + std::to_string(voxel) +
        (covered ? " is covered, but not by the reference"
                 : " is not covered, but it is by the reference");
    }
  }
  std::string message;
  for (int i = 0; i < output->GetPointData()->GetNumberOfArrays() && message.empty(); ++i)
  {
    vtkDataArray* array = output->GetPointData()->GetArray(i);
    vtkDataArray* source = volume->GetPointData()->GetArray(array->GetName());
    if (array == mask || !source ||
      (settings.HasDensity && source->GetName() == std::string("value")))
    {
      continue;
    }
    const bool categorical = IsCategorical(settings, array->GetName());
    const bool cubic = settings.Interpolation == vtkDeformVolumeFilter::CUBIC_INTERPOLATION;
    switch (array->GetDataType())
    {
      vtkTemplateMacro(message = CompareArray<VTK_TT>(result, source, array, categorical, cubic));
      default:
        break;
    }
  }
  return message;
}

} // namespace

std::optional<std::string> CompareWithReference(vtkImageData* output, vtkImageData* volume,
  vtkDataSet* deformation, const Settings& settings, vtkIdType inverted)
{
  if (volume->GetNumberOfPoints() > LARGEST_VOLUME || output->GetNumberOfPoints() > LARGEST_OUTPUT)
  {
    return std::nullopt;
  }
  reference::SamplingMesh mesh;
  reference::Box box;
  volume->GetExtent(mesh.Voxels.data());
  output->GetExtent(box.data());
  if (!FindPositions(output, volume, deformation, settings.DisplacementScale, mesh))
  {
    return std::nullopt;
  }
  FindMasks(volume, mesh);
  reference::Result result;
  try
  {
    result = reference::Resample(mesh, box);
  }
  catch (const std::range_error&)
  {
    return std::nullopt;
  }
  if (result.NumberOfInvertedTetrahedra != inverted)
  {
    return std::to_string(inverted) + " inverted tetrahedra where the reference has " +
      std::to_string(result.NumberOfInvertedTetrahedra);
  }
  return CompareArrays(result, output, volume, settings);
}

} // namespace fuzz
