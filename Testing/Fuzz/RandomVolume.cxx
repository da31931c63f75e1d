// SPDX-License-Identifier: BSD-3-Clause
#include "RandomVolume.h"

#include "WrittenTuples.h"

#include <vtkAOSDataArrayTemplate.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <limits>
#include <type_traits>

namespace fuzz
{

namespace
{

struct ArrayKind
{
  const char* Name;
  int Type;
  int Components;
};
using ArraySet = std::vector<ArrayKind>;

// Settings makes arrays with the name "label" categorical. Other tests compile the kernels of the
// first three sets, too.
const std::vector<ArraySet>& GetArraySets()
{
  static const std::vector<ArraySet> sets{ { { "value", VTK_SHORT, 1 } },
    { { "value", VTK_FLOAT, 1 } },
    { { "value", VTK_SHORT, 1 }, { "more", VTK_FLOAT, 1 }, { "label", VTK_UNSIGNED_SHORT, 2 } },
    { { "value", VTK_DOUBLE, 1 }, { "color", VTK_UNSIGNED_CHAR, 3 } } };
  return sets;
}

// Values are smooth, or use the whole range of the type, or are constant with a few special values.
template <typename T>
void FillValues(T* values, vtkIdType count, Random& random)
{
  const int kind = random.Int(0, 9);
  for (vtkIdType i = 0; i < count; ++i)
  {
    if (kind < 6)
    {
      values[i] = static_cast<T>(
        60.0 + 50.0 * std::sin(0.37 * static_cast<double>(i)) + random.Real(-8.0, 8.0));
    }
    else if (kind < 9)
    {
      values[i] = std::is_integral<T>::value ? static_cast<T>(random.Bits())
                                             : static_cast<T>(random.Real(-1e4, 1e4));
    }
    else
    {
      values[i] = T(7);
    }
  }
  if constexpr (!std::is_integral<T>::value)
  {
    using Limits = std::numeric_limits<T>;
    for (int i = random.Chance(0.1) ? random.Int(1, 5) : 0; i > 0; --i)
    {
      values[random.Bits() % static_cast<std::uint64_t>(count)] = random.Pick(
        { Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), T(-0.0), Limits::max() });
    }
  }
}

template <typename T>
vtkSmartPointer<vtkDataArray> MakeValues(int components, vtkIdType tuples, Random& random)
{
  vtkNew<vtkAOSDataArrayTemplate<T>> made;
  vtkSmartPointer<vtkDataArray> array =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(made->GetDataType()));
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  if (tuples > 0)
  {
    FillValues(static_cast<T*>(array->GetVoidPointer(0)), tuples * components, random);
  }
  if (random.Chance(0.05))
  {
    const auto other = vtkSmartPointer<vtkSOADataArrayTemplate<T>>::New();
    other->DeepCopy(array);
    return other;
  }
  return array;
}

vtkSmartPointer<vtkDataArray> MakeArray(const ArrayKind& kind, vtkIdType tuples, Random& random)
{
  vtkSmartPointer<vtkDataArray> array;
  switch (kind.Type)
  {
    vtkTemplateMacro(array = MakeValues<VTK_TT>(kind.Components, tuples, random));
    default:
      break;
  }
  array->SetName(kind.Name);
  return array;
}

vtkUnsignedCharArray* GetMask(
  vtkDataSetAttributes* attributes, const char* name, vtkIdType size, unsigned char usual)
{
  auto* mask = vtkUnsignedCharArray::SafeDownCast(attributes->GetAbstractArray(name));
  if (mask && mask->GetNumberOfTuples() == size)
  {
    return mask;
  }
  vtkNew<vtkUnsignedCharArray> made;
  made->SetName(name);
  made->SetNumberOfTuples(size);
  made->Fill(usual);
  attributes->AddArray(made);
  return made;
}

void SetSpacing(vtkImageData* volume, Random& random, Geometry geometry)
{
  double spacing[3];
  const double one = random.Pick({ 0.5, 1.0, 1.0, 2.0 });
  const bool different = random.Chance(0.5);
  for (double& step : spacing)
  {
    step = different
      ? (geometry == Geometry::Exact ? random.Pick({ 0.25, 1.0, 2.0 }) : random.Real(0.2, 3.0))
      : one;
    step *= random.Chance(0.07) ? -1.0 : 1.0;
  }
  volume->SetSpacing(spacing);
}

void SetDirection(vtkImageData* volume, Random& random)
{
  vtkNew<vtkMatrix3x3> direction;
  glm::dmat3 matrix(1.0);
  switch (random.Int(0, 5))
  {
    case 0:
    case 1:
      matrix = glm::dmat3(glm::rotate(glm::dmat4(1.0), random.Real(-3.0, 3.0),
        glm::dvec3(random.Real(0.1, 1.0), random.Real(-1.0, 1.0), random.Real(-1.0, 1.0))));
      break;
    case 2: // another order of the axes, perhaps mirrored
      matrix = glm::dmat3(0.0);
      matrix[0][1] = matrix[1][2] = 1.0;
      matrix[2][0] = random.Pick({ 1.0, -1.0 });
      break;
    default:
      break;
  }
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      direction->SetElement(row, column, matrix[column][row]);
    }
  }
  volume->SetDirectionMatrix(direction);
}

void SetOrigin(vtkImageData* volume, Random& random, Geometry geometry)
{
  double origin[3] = { 0.0, 0.0, 0.0 };
  if (random.Chance(0.5))
  {
    for (double& coordinate : origin)
    {
      coordinate = geometry == Geometry::Exact ? random.Int(-64, 64) : random.Real(-50.0, 50.0);
    }
  }
  volume->SetOrigin(origin);
}

// Makes a volume that is an error.
void Spoil(vtkImageData* volume, Random& random, std::ostream& log)
{
  const int kind = random.Int(0, 4);
  log << " with error " << kind;
  switch (kind)
  {
    case 0:
      volume->SetSpacing(1.0, 0.0, 1.0);
      break;
    case 1:
      volume->SetOrigin(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0);
      break;
    case 2:
      volume->GetPointData()->Initialize();
      break;
    case 3:
    {
      vtkNew<vtkFloatArray> mask;
      mask->SetName("ActiveTetrahedra");
      mask->SetNumberOfTuples(volume->GetNumberOfCells());
      mask->Fill(31.0);
      volume->GetCellData()->AddArray(mask);
      break;
    }
    default: // fewer tuples than voxels, in the same array
      if (vtkDataArray* array = volume->GetPointData()->GetArray(0))
      {
        array->SetNumberOfTuples(volume->GetNumberOfPoints() / 2);
        array->Modified();
      }
  }
}

// Distances are multiples of 1/16, so that sums of their products with weights are exact.
void EditDistances(vtkImageData* volume, int density, Random& random)
{
  const vtkIdType points = volume->GetNumberOfPoints();
  vtkDataArray* distances = volume->GetPointData()->GetArray("BoundaryDistance");
  if (!distances || distances->GetNumberOfTuples() != points)
  {
    vtkNew<vtkFloatArray> made;
    made->SetName("BoundaryDistance");
    made->SetNumberOfTuples(points);
    made->Fill(1.0);
    volume->GetPointData()->AddArray(made);
    distances = made;
  }
  for (vtkIdType i = 0; i < points; ++i)
  {
    if (random.Int(0, density) == 0)
    {
      distances->SetComponent(i, 0, random.Int(-32, 32) / 16.0);
    }
  }
  distances->Modified();
}

// Makes a smooth cut, of random cells or along a plane. Distances are multiples of 1/16 as well.
// Rarely one of the two arrays is missing.
void EditCut(vtkImageData* volume, int density, Random& random)
{
  const vtkIdType points = volume->GetNumberOfPoints();
  const bool isPlane = random.Chance(0.5);
  const int normal[3] = { random.Int(-16, 16), random.Int(-16, 16), random.Int(-16, 16) };
  int extent[6];
  volume->GetExtent(extent);
  const int width = extent[1] - extent[0] + 1;
  const int height = extent[3] - extent[2] + 1;
  int offset = 0; // offset of the plane, in the middle of the volume or beside it
  for (int axis = 0; axis < 3; ++axis)
  {
    offset += normal[axis] * ((extent[2 * axis + 1] - extent[2 * axis]) / 2);
  }
  vtkNew<vtkFloatArray> distances;
  distances->SetName("CutDistance");
  distances->SetNumberOfTuples(points);
  for (vtkIdType i = 0; i < points; ++i)
  {
    const int at[3] = { static_cast<int>(i) % width, static_cast<int>(i) / width % height,
      static_cast<int>(i) / (width * height) };
    const int distance = isPlane
      ? normal[0] * at[0] + normal[1] * at[1] + normal[2] * at[2] - offset
      : random.Int(-32, 32);
    distances->SetComponent(i, 0, distance / 16.0);
  }
  volume->GetPointData()->AddArray(distances);
  vtkUnsignedCharArray* crossed =
    GetMask(volume->GetCellData(), "CutTetrahedra", volume->GetNumberOfCells(), 0);
  for (vtkIdType i = 0; i < volume->GetNumberOfCells(); ++i)
  {
    if (isPlane || random.Int(0, density) == 0)
    {
      crossed->SetValue(i, static_cast<unsigned char>(isPlane ? 31 : random.Int(0, 31)));
    }
  }
  crossed->Modified();
  if (random.Chance(0.03))
  {
    volume->GetPointData()->RemoveArray("CutDistance");
  }
}

} // namespace

void FillArrays(vtkImageData* volume, Random& random, std::ostream& log)
{
  const auto set =
    static_cast<std::size_t>(random.Int(0, static_cast<int>(GetArraySets().size()) - 1));
  log << " arrays " << set;
  vtkPointData* pointData = volume->GetPointData();
  for (int i = pointData->GetNumberOfArrays() - 1; i >= 0; --i)
  {
    const char* name = pointData->GetAbstractArray(i)->GetName();
    if (!name ||
      (std::string(name) != vtkDataSetAttributes::GhostArrayName() &&
        std::string(name) != "BoundaryDistance" && std::string(name) != "CutDistance"))
    {
      pointData->RemoveArray(i);
    }
  }
  for (const ArrayKind& kind : GetArraySets()[set])
  {
    pointData->AddArray(MakeArray(kind, volume->GetNumberOfPoints(), random));
  }
  if (random.Chance(0.9))
  {
    pointData->SetActiveScalars("value");
  }
  if (random.Chance(0.03))
  {
    vtkNew<vtkStringArray> text;
    text->SetName("text");
    text->SetNumberOfValues(volume->GetNumberOfPoints());
    pointData->AddArray(text);
  }
}

void EditMasks(vtkImageData* volume, Random& random, std::ostream& log)
{
  const vtkIdType points = volume->GetNumberOfPoints();
  const vtkIdType cells = volume->GetNumberOfCells();
  if (points == 0 || cells == 0)
  {
    return;
  }
  const bool isLarge = points > 20000;
  const int kind = random.Int(0, isLarge ? 4 : 5);
  log << " masks " << kind;
  vtkUnsignedCharArray* mask = nullptr;
  const int density = isLarge ? random.Pick({ 3000, 100000 }) : random.Pick({ 2, 10, 100 });
  const bool isLogged = random.Chance(0.3);
  const auto set = [&](vtkIdType i, int value)
  {
    if (isLogged)
    {
      StartLog(mask);
    }
    mask->SetValue(i, static_cast<unsigned char>(value));
    MarkWritten(mask, i, i);
  };
  switch (kind)
  {
    case 0:
      mask = GetMask(volume->GetPointData(), vtkDataSetAttributes::GhostArrayName(), points, 0);
      for (vtkIdType i = 0; i < points; ++i)
      {
        if (random.Int(0, density) == 0)
        {
          set(i,
            random.Pick({ 0, int(vtkDataSetAttributes::HIDDENPOINT),
              int(vtkDataSetAttributes::DUPLICATEPOINT) }));
        }
      }
      break;
    case 1:
      mask = GetMask(volume->GetCellData(), vtkDataSetAttributes::GhostArrayName(), cells, 0);
      for (vtkIdType i = 0; i < cells; ++i)
      {
        if (random.Int(0, density) == 0)
        {
          set(i,
            random.Pick({ 0, int(vtkDataSetAttributes::HIDDENCELL),
              int(vtkDataSetAttributes::DUPLICATECELL) }));
        }
      }
      break;
    case 2:
      mask = GetMask(volume->GetCellData(), "ActiveTetrahedra", cells, 31);
      for (vtkIdType i = 0; i < cells; ++i)
      {
        if (random.Int(0, density) == 0)
        {
          set(i, random.Int(0, 255));
        }
      }
      break;
    case 3:
      EditDistances(volume, density, random);
      break;
    case 5:
      EditCut(volume, density, random);
      break;
    default:
      volume->GetPointData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
      volume->GetPointData()->RemoveArray("BoundaryDistance");
      volume->GetPointData()->RemoveArray("CutDistance");
      volume->GetCellData()->Initialize();
      volume->Modified();
  }
}

vtkSmartPointer<vtkImageData> MakeVolume(
  Random& random, Geometry geometry, bool isLarge, std::ostream& log)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  int extent[6];
  const bool large = random.Chance(0.05);
  // Some volumes are so large that a field over their voxels is read in place.
  const bool larger = random.Chance(0.4);
  const int far = random.Chance(0.02) ? 100000 : 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    int size = random.Chance(0.1) ? 2 : random.Int(2, 11);
    if (large) // several bricks of 192 x 16 x 16 cells
    {
      size = axis == 0 ? random.Int(180, 200) : random.Int(2, 20);
    }
    if (isLarge)
    {
      size = larger ? random.Int(65, 70) : random.Int(40, 65);
    }
    else if (random.Chance(0.004))
    {
      size = random.Int(0, 1);
    }
    extent[2 * axis] = random.Chance(0.4) ? 0 : far + random.Int(-9, 9);
    extent[2 * axis + 1] = extent[2 * axis] + size - 1;
  }
  volume->SetExtent(extent);
  SetSpacing(volume, random, geometry);
  SetOrigin(volume, random, geometry);
  if (geometry == Geometry::Any)
  {
    SetDirection(volume, random);
  }
  log << "volume " << volume->GetDimensions()[0] << 'x' << volume->GetDimensions()[1] << 'x'
      << volume->GetDimensions()[2] << " from " << extent[0] << ' ' << extent[2] << ' '
      << extent[4];
  FillArrays(volume, random, log);
  for (int masks = !isLarge && random.Chance(0.4) ? random.Int(1, 2) : 0; masks > 0; --masks)
  {
    EditMasks(volume, random, log);
  }
  if (!isLarge && random.Chance(0.02))
  {
    Spoil(volume, random, log);
  }
  log << '\n';
  return volume;
}

void EditVolume(vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log)
{
  const int kind = random.Int(0, 9);
  log << "volume, edit " << kind;
  switch (kind)
  {
    case 0:
    case 1:
      if (vtkDataArray* array = volume->GetPointData()->GetArray("value"))
      {
        if (array->GetNumberOfTuples() > 0)
        {
          array->SetComponent(static_cast<vtkIdType>(random.Bits() %
                                static_cast<std::uint64_t>(array->GetNumberOfTuples())),
            0, random.Int(0, 100));
        }
        array->Modified();
      }
      break;
    case 2:
      FillArrays(volume, random, log);
      volume->Modified();
      break;
    case 3:
      SetOrigin(volume, random, geometry);
      break;
    case 4:
      SetSpacing(volume, random, geometry);
      break;
    case 5:
      if (random.Chance(volume->GetNumberOfPoints() > 20000 ? 0.0 : 0.3))
      {
        Spoil(volume, random, log);
      }
      volume->Modified();
      break;
    default:
      EditMasks(volume, random, log);
  }
  log << '\n';
}

} // namespace fuzz
