// SPDX-License-Identifier: BSD-3-Clause
#include "BodySurface.h"

#include "CoarseVolume.h"
#include "ParallelFor.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWindowedSincPolyDataFilter.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

namespace deformvolume
{
namespace
{

// Values that a margin may add to the volume that the surface is taken from.
constexpr double MaximumMarginValues = 2e9;

template <typename T>
bool IsLabel(T value, const std::vector<vtkTypeInt64>& labels)
{
  if (!(std::isfinite(static_cast<double>(value))))
  {
    return false;
  }
  if (labels.empty())
  {
    return value != T(0);
  }
  return std::any_of(labels.begin(), labels.end(),
    [value](vtkTypeInt64 label)
    {
      return std::is_integral<T>::value ? static_cast<vtkTypeInt64>(value) == label
                                        : static_cast<double>(value) == static_cast<double>(label);
    });
}

// Mean of each block of voxels: of the values, or of "is one of the labels". NaN where a block has
// no voxel that counts.
struct BlockMeans
{
  template <typename Array>
  void operator()(Array* array, const unsigned char* ghosts, const int dimensions[3],
    const Index& factor, const BodyParameters& parameters, CoarseVolume& coarse) const
  {
    const auto values = vtk::DataArrayTupleRange(array);
    using Value = vtk::GetAPIType<Array>;
    Index blocks;
    for (int axis = 0; axis < 3; ++axis)
    {
      blocks[axis] = coarse.Size[axis] - 2 * coarse.Border[axis];
    }
    auto slabs = [&](vtkIdType begin, vtkIdType end)
    {
      std::vector<double> sums;
      std::vector<vtkIdType> counts;
      for (vtkIdType slab = begin; slab < end; ++slab)
      {
        sums.assign(blocks[0] * blocks[1], 0.0);
        counts.assign(blocks[0] * blocks[1], 0);
        const vtkIdType last = std::min<vtkIdType>((slab + 1) * factor[2], dimensions[2]);
        for (vtkIdType z = slab * factor[2]; z < last; ++z)
        {
          for (vtkIdType y = 0; y < dimensions[1]; ++y)
          {
            const vtkIdType row = (z * dimensions[1] + y) * dimensions[0];
            vtkIdType block = (y / factor[1]) * blocks[0];
            for (vtkIdType x = 0, left = factor[0]; x < dimensions[0]; ++x, --left)
            {
              if (left == 0)
              {
                ++block;
                left = factor[0];
              }
              if (ghosts && (ghosts[row + x] & vtkDataSetAttributes::HIDDENPOINT))
              {
                continue;
              }
              const Value value = values[row + x][0];
              const double counted = parameters.ByLabels
                ? (IsLabel(value, parameters.Labels) ? 1.0 : 0.0)
                : static_cast<double>(value);
              if (std::isfinite(counted))
              {
                sums[block] += counted;
                ++counts[block];
              }
            }
          }
        }
        for (vtkIdType y = 0; y < blocks[1]; ++y)
        {
          float* row =
            &coarse.Values[((slab + coarse.Border[2]) * coarse.Size[1] + y + coarse.Border[1]) *
                coarse.Size[0] +
              coarse.Border[0]];
          for (vtkIdType x = 0; x < blocks[0]; ++x)
          {
            const vtkIdType count = counts[y * blocks[0] + x];
            row[x] = count ? static_cast<float>(sums[y * blocks[0] + x] / count)
                           : std::numeric_limits<float>::quiet_NaN();
          }
        }
      }
    };
    ParallelFor(0, blocks[2], 1, slabs);
  }
};

std::string Describe(const BodyParameters& parameters, double low, double high)
{
  std::ostringstream text;
  if (parameters.ByLabels)
  {
    text << "No body: the volume has no voxel with ";
    text << (parameters.Labels.empty() ? "a label other than 0."
                                       : "one of the labels. Check AddLabel().");
  }
  else
  {
    text << "No body: the volume has no value of at least " << parameters.Isovalue
         << ", the isovalue; its values, averaged to the resolution worked with, go from " << low
         << " to " << high << ". Set another Isovalue or a smaller TargetEdgeLength.";
  }
  return text.str();
}

} // namespace

vtkSmartPointer<vtkPolyData> ExtractBodySurface(vtkImageData* volume, vtkDataArray* array,
  BodyParameters& parameters, const std::function<void()>& check)
{
  int dimensions[3];
  int extent[6];
  volume->GetDimensions(dimensions);
  volume->GetExtent(extent);
  const double* spacing = volume->GetSpacing();

  CoarseVolume coarse;
  Index factor;
  double inside = 1.0;
  double count = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double size = std::abs(spacing[axis]);
    factor[axis] = static_cast<vtkIdType>(
      std::min(std::max(1.0, std::floor(parameters.Resolution / size)), dimensions[axis] / 2.0));
    coarse.Spacing[axis] = factor[axis] * size;
    coarse.IndexStep[axis] = static_cast<double>(factor[axis]);
    const double border = parameters.Margin / coarse.Spacing[axis];
    const double blocks = dimensions[axis] / static_cast<double>(factor[axis]);
    inside *= blocks;
    count *= blocks + 2.0 * border;
    if (!(border <= MaximumMarginValues && count - inside <= MaximumMarginValues))
    {
      std::ostringstream text;
      text << "The body's surface cannot be moved out by a margin of " << parameters.Margin
           << " world units: that is too far for a volume of this size. Set a smaller Margin or "
              "TargetEdgeLength.";
      throw Error(text.str());
    }
    coarse.Border[axis] = static_cast<vtkIdType>(border) + 3;
    coarse.Size[axis] =
      (dimensions[axis] + factor[axis] - 1) / factor[axis] + 2 * coarse.Border[axis];
    coarse.FirstIndex[axis] =
      extent[2 * axis] + (factor[axis] - 1) / 2.0 - coarse.Border[axis] * coarse.IndexStep[axis];
  }
  coarse.Values.assign(coarse.Count(), std::numeric_limits<float>::quiet_NaN());
  vtkUnsignedCharArray* ghostArray = volume->GetPointGhostArray();
  const unsigned char* ghosts = ghostArray ? ghostArray->GetPointer(0) : nullptr;
  if (!vtkArrayDispatch::Dispatch::Execute(
        array, BlockMeans{}, ghosts, dimensions, factor, parameters, coarse))
  {
    BlockMeans{}(array, ghosts, dimensions, factor, parameters, coarse);
  }
  check();

  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (float value : coarse.Values)
  {
    if (std::isfinite(value))
    {
      low = std::min<double>(low, value);
      high = std::max<double>(high, value);
    }
  }
  if (low > high)
  {
    throw Error("No body: the volume has no finite value that is not hidden.");
  }
  if (parameters.ByLabels)
  {
    parameters.Isovalue = 0.5;
    low = 0.0;
  }
  else if (parameters.AutomaticIsovalue)
  {
    if (low == high)
    {
      throw Error("The isovalue cannot be found: all values of the volume are equal. Switch "
                  "AutomaticIsovalue off and set Isovalue.");
    }
    parameters.Isovalue = OtsuThreshold(coarse.Values, low, high);
  }
  const std::vector<unsigned char> body =
    FindBody(coarse, parameters.Isovalue, parameters.LargestRegionOnly);
  if (body.empty())
  {
    throw Error(Describe(parameters, low, high));
  }
  check();
  // Where all of the volume is body, there is no value outside it to go by.
  const double background = low < parameters.Isovalue ? low : 2.0 * parameters.Isovalue - high;
  MakeLevelSet(coarse, body, parameters.Isovalue, background, parameters.Margin);
  check();

  vtkNew<vtkFloatArray> values;
  values->SetArray(coarse.Values.data(), coarse.Count(), 1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(static_cast<int>(coarse.Size[0]), static_cast<int>(coarse.Size[1]),
    static_cast<int>(coarse.Size[2]));
  image->SetSpacing(coarse.Spacing.x, coarse.Spacing.y, coarse.Spacing.z);
  image->GetPointData()->SetScalars(values);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0.0);
  contour->ComputeNormalsOff();
  contour->ComputeScalarsOff();
  vtkNew<vtkWindowedSincPolyDataFilter> smoother;
  smoother->SetInputConnection(contour->GetOutputPort());
  smoother->SetNumberOfIterations(parameters.SmoothingIterations);
  smoother->SetPassBand(0.05);
  smoother->BoundarySmoothingOff();
  smoother->FeatureEdgeSmoothingOff();
  smoother->NonManifoldSmoothingOn();
  smoother->NormalizeCoordinatesOn();
  contour->Update();
  vtkPolyData* local = contour->GetOutput();
  if (local->GetNumberOfPolys() == 0)
  {
    throw Error("Nothing is left of the body's surface. Set a smaller TargetEdgeLength.");
  }
  if (parameters.SmoothingIterations > 0)
  {
    smoother->Update();
    local = smoother->GetOutput();
  }
  check();

  // Through the structured index rather than by the filters above, of which not all know direction
  // matrices.
  vtkMatrix3x3* direction = volume->GetDirectionMatrix();
  glm::dmat3 indexToWorld;
  for (int column = 0; column < 3; ++column)
  {
    for (int row = 0; row < 3; ++row)
    {
      indexToWorld[column][row] = direction->GetElement(row, column) * spacing[column];
    }
  }
  const double* origin = volume->GetOrigin();
  const glm::dvec3 worldOrigin(origin[0], origin[1], origin[2]);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(local->GetNumberOfPoints());
  for (vtkIdType i = 0; i < local->GetNumberOfPoints(); ++i)
  {
    double point[3];
    local->GetPoint(i, point);
    const glm::dvec3 index = coarse.FirstIndex +
      glm::dvec3(point[0], point[1], point[2]) / coarse.Spacing * coarse.IndexStep;
    const glm::dvec3 world = worldOrigin + indexToWorld * index;
    points->SetPoint(i, world.x, world.y, world.z);
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(local->GetPolys());
  return surface;
}

} // namespace deformvolume
