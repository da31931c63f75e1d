// SPDX-License-Identifier: BSD-3-Clause
#include "BodySurface.h"

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
#include "vtkSMPTools.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWindowedSincPolyDataFilter.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <string>

namespace deformvolume
{
namespace
{

using Index = std::array<vtkIdType, 3>;

// A volume at the resolution that is worked with, with a border of voxels outside the body.
struct Coarse
{
  Index Size = {};       // voxels on each axis, border included
  Index Border = {};     // voxels of border on each side
  glm::dvec3 Spacing;    // world units
  glm::dvec3 FirstIndex; // where the first voxel lies in the structured index of the volume
  glm::dvec3 IndexStep;  // voxels of the volume to one of these
  std::vector<float> Values;

  vtkIdType Count() const { return this->Size[0] * this->Size[1] * this->Size[2]; }
};

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
    const Index& factor, const BodyParameters& parameters, Coarse& coarse) const
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
    vtkSMPTools::For(0, blocks[2], 1, slabs);
  }
};

// Otsu, "A threshold selection method from gray-level histograms", 1979: the threshold at which the
// variance between the two classes is greatest; the middle where several thresholds are.
double OtsuThreshold(const std::vector<float>& values, double low, double high)
{
  constexpr int bins = 512;
  std::vector<double> histogram(bins, 0.0);
  for (float value : values)
  {
    if (std::isfinite(value))
    {
      const int bin = static_cast<int>((value - low) / (high - low) * bins);
      histogram[std::min(std::max(bin, 0), bins - 1)] += 1.0;
    }
  }
  const double total = std::accumulate(histogram.begin(), histogram.end(), 0.0);
  double moment = 0.0;
  for (int i = 0; i < bins; ++i)
  {
    moment += i * histogram[i];
  }
  double below = 0.0;
  double momentBelow = 0.0;
  double best = -1.0;
  double first = 0.0;
  double last = 0.0;
  for (int i = 0; i + 1 < bins; ++i)
  {
    below += histogram[i];
    momentBelow += i * histogram[i];
    const double above = total - below;
    if (below == 0.0 || above == 0.0)
    {
      continue;
    }
    const double difference = momentBelow / below - (moment - momentBelow) / above;
    const double between = below * above * difference * difference;
    if (between > best * (1.0 + 1e-12))
    {
      best = between;
      first = i;
    }
    if (between >= best * (1.0 - 1e-12))
    {
      last = i;
    }
  }
  return low + ((first + last) / 2.0 + 1.0) / bins * (high - low);
}

// Marks what is connected through faces with `start` and has the same mark; returns how many.
vtkIdType Flood(std::vector<unsigned char>& marks, const Index& size, vtkIdType start,
  unsigned char mark, std::vector<vtkIdType>& queue)
{
  const unsigned char old = marks[start];
  const vtkIdType strides[3] = { 1, size[0], size[0] * size[1] };
  queue.assign(1, start);
  marks[start] = mark;
  for (std::size_t next = 0; next < queue.size(); ++next)
  {
    const vtkIdType voxel = queue[next];
    for (int axis = 0; axis < 3; ++axis)
    {
      const vtkIdType position = voxel / strides[axis] % size[axis];
      const vtkIdType neighbors[2] = { position > 0 ? voxel - strides[axis] : -1,
        position + 1 < size[axis] ? voxel + strides[axis] : -1 };
      for (vtkIdType neighbor : neighbors)
      {
        if (neighbor >= 0 && marks[neighbor] == old)
        {
          marks[neighbor] = mark;
          queue.push_back(neighbor);
        }
      }
    }
  }
  return static_cast<vtkIdType>(queue.size());
}

// 1 for voxels of the body, its cavities filled, and 0 for the others; empty if there is no body.
std::vector<unsigned char> FindBody(const Coarse& coarse, double isovalue, bool largestOnly)
{
  constexpr unsigned char out = 0, in = 1, visited = 2, chosen = 3, outside = 4;
  std::vector<unsigned char> marks(coarse.Count(), out);
  std::vector<vtkIdType> queue;
  vtkIdType largest = 0;
  vtkIdType seed = -1;
  for (vtkIdType i = 0; i < coarse.Count(); ++i)
  {
    marks[i] = coarse.Values[i] >= isovalue ? in : out;
  }
  for (vtkIdType i = 0; i < coarse.Count(); ++i)
  {
    if (marks[i] == in)
    {
      const vtkIdType count = Flood(marks, coarse.Size, i, visited, queue);
      if (count > largest)
      {
        largest = count;
        seed = i;
      }
    }
  }
  if (seed < 0)
  {
    return {};
  }
  if (largestOnly)
  {
    Flood(marks, coarse.Size, seed, chosen, queue);
    std::replace(marks.begin(), marks.end(), visited, out);
  }
  Flood(marks, coarse.Size, 0, outside, queue);
  for (unsigned char& mark : marks)
  {
    mark = mark != outside;
  }
  return marks;
}

// Squared distances, in world units, of the voxels' centres to the nearest voxel of the body.
// Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions": along each axis the
// lower envelope of parabolas. (vtkImageEuclideanDistance of VTK 9.1 is wrong unless the spacing
// is 1.)
std::vector<double> SquaredDistances(const Coarse& coarse, const std::vector<unsigned char>& body)
{
  const glm::dvec3 size = coarse.Spacing *
    glm::dvec3(static_cast<double>(coarse.Size[0]), static_cast<double>(coarse.Size[1]),
      static_cast<double>(coarse.Size[2]));
  const double far = 4.0 * glm::dot(size, size);
  std::vector<double> squares(coarse.Count());
  std::transform(body.begin(), body.end(), squares.begin(),
    [far](unsigned char inside) { return inside ? 0.0 : far; });

  const vtkIdType strides[3] = { 1, coarse.Size[0], coarse.Size[0] * coarse.Size[1] };
  for (int axis = 0; axis < 3; ++axis)
  {
    const vtkIdType count = coarse.Size[axis];
    const double unit = coarse.Spacing[axis] * coarse.Spacing[axis];
    std::vector<double> line(count);
    std::vector<vtkIdType> apex(count);
    std::vector<double> from(count); // where the parabola of that apex becomes the lowest
    for (vtkIdType start = 0; start < coarse.Count(); ++start)
    {
      if (start / strides[axis] % count != 0)
      {
        continue;
      }
      for (vtkIdType i = 0; i < count; ++i)
      {
        line[i] = squares[start + i * strides[axis]];
      }
      vtkIdType top = 0;
      apex[0] = 0;
      from[0] = -std::numeric_limits<double>::infinity();
      for (vtkIdType i = 1; i < count; ++i)
      {
        double meeting;
        do
        {
          const vtkIdType j = apex[top];
          meeting = 0.5 * (i + j) + (line[i] - line[j]) / (2.0 * unit * (i - j));
        } while (meeting <= from[top] && top-- > 0);
        ++top;
        apex[top] = i;
        from[top] = meeting;
      }
      vtkIdType current = 0;
      for (vtkIdType i = 0; i < count; ++i)
      {
        while (current < top && from[current + 1] <= i)
        {
          ++current;
        }
        const double steps = static_cast<double>(i - apex[current]);
        squares[start + i * strides[axis]] = unit * steps * steps + line[apex[current]];
      }
    }
  }
  return squares;
}

// Replaces the values by a function that is positive in the body (enlarged by the margin) and
// negative outside.
void MakeLevelSet(Coarse& coarse, const std::vector<unsigned char>& body, double isovalue,
  double background, double margin)
{
  if (margin > 0.0)
  {
    const std::vector<double> squares = SquaredDistances(coarse, body);
    // The body ends about half a voxel beyond its outermost voxels.
    const double half = (coarse.Spacing.x + coarse.Spacing.y + coarse.Spacing.z) / 6.0;
    for (vtkIdType i = 0; i < coarse.Count(); ++i)
    {
      coarse.Values[i] = static_cast<float>((margin + half - std::sqrt(squares[i])) / half);
    }
  }
  else
  {
    const double scale = std::max(isovalue - background, std::numeric_limits<float>::min() * 1.0);
    for (vtkIdType i = 0; i < coarse.Count(); ++i)
    {
      const double value = std::isfinite(coarse.Values[i]) ? coarse.Values[i] : background;
      const double level = std::abs(value - isovalue) / scale;
      coarse.Values[i] = static_cast<float>(body[i] ? level : -level);
    }
  }
  // A value close to 0 would put several vertices of the surface almost into one place, and
  // TetGen has to keep the tiny triangles between them.
  for (float& value : coarse.Values)
  {
    value = std::copysign(std::max(std::abs(value), 0.1f), value);
  }
}

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

  Coarse coarse;
  Index factor;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double size = std::abs(spacing[axis]);
    factor[axis] = static_cast<vtkIdType>(
      std::min(std::max(1.0, std::floor(parameters.Resolution / size)), dimensions[axis] / 2.0));
    coarse.Spacing[axis] = factor[axis] * size;
    coarse.IndexStep[axis] = static_cast<double>(factor[axis]);
    coarse.Border[axis] = static_cast<vtkIdType>(parameters.Margin / coarse.Spacing[axis]) + 3;
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
  vtkPolyData* local;
  if (parameters.SmoothingIterations > 0)
  {
    smoother->Update();
    local = smoother->GetOutput();
  }
  else
  {
    contour->Update();
    local = contour->GetOutput();
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
