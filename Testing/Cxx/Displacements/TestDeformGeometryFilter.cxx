// SPDX-License-Identifier: BSD-3-Clause
// vtkDeformGeometryFilter: points are moved by a deformation, and by its inverse.
#include "ArrayMaking.h"
#include "KeepTesting.h"

#include "vtkDeformGeometryFilter.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <vtkAppendFilter.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkInformation.h>
#include <vtkIntArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPlaneSource.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

constexpr int Discard = vtkDeformGeometryFilter::DISCARD;
constexpr int Extrapolate = vtkDeformGeometryFilter::EXTRAPOLATE;
constexpr int Keep = vtkDeformGeometryFilter::KEEP;

struct Subject : Observed<vtkDeformGeometryFilter>
{
  Subject() = default;
  Subject(vtkDataObject* points, vtkDataObject* deformation)
  {
    this->Filter->SetInputData(points);
    this->Filter->SetDeformationData(deformation);
  }

  vtkPointSet* Update()
  {
    this->Filter->Update();
    EXPECT_FALSE(this->Observer->GetError()) << this->Observer->GetErrorMessage();
    this->Warning = this->Observer->GetWarningMessage();
    this->ClearMessages();
    return this->Filter->GetOutput();
  }
  std::vector<glm::dvec3> GetPositions()
  {
    vtkPointSet* output = this->Update();
    std::vector<glm::dvec3> positions;
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      positions.push_back(GetPoint(output, id));
    }
    return positions;
  }
  bool IsValid(vtkIdType id)
  {
    vtkDataArray* mask = this->Filter->GetOutput()->GetPointData()->GetArray("vtkValidPointMask");
    return mask && mask->GetDataType() == VTK_CHAR && mask->GetComponent(id, 0) != 0.0;
  }

  std::string Warning;
};

vtkSmartPointer<vtkPolyData> MakePoints(
  const std::vector<glm::dvec3>& positions, int precision = VTK_DOUBLE)
{
  vtkNew<vtkPoints> points;
  points->SetDataType(precision);
  for (const glm::dvec3& position : positions)
  {
    points->InsertNextPoint(&position.x);
  }
  auto made = vtkSmartPointer<vtkPolyData>::New();
  made->SetPoints(points);
  return made;
}

std::vector<glm::dvec3> MakePositions(
  int count, const glm::dvec3& min, const glm::dvec3& max, unsigned int seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> between(0.0, 1.0);
  std::vector<glm::dvec3> positions;
  for (int i = 0; i < count; ++i)
  {
    glm::dvec3 part;
    for (int axis = 0; axis < 3; ++axis)
    {
      part[axis] = between(random);
    }
    positions.push_back(min + part * (max - min));
  }
  return positions;
}

vtkDoubleArray* AddArray(vtkPointSet* points, const char* name, const WorldMap& map)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < points->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 vector = map(GetPoint(points, id));
    array->InsertNextTuple(&vector.x);
  }
  points->GetPointData()->AddArray(array);
  return array;
}

glm::dvec3 GetTuple(vtkDataArray* array, vtkIdType id)
{
  glm::dvec3 vector;
  array->GetTuple(id, &vector.x);
  return vector;
}

// A bend of about 3 units over 10 units, without folds.
glm::dvec3 Bend(const glm::dvec3& p)
{
  return p +
    glm::dvec3(0.8 * std::sin(0.35 * p.y), 0.9 * std::cos(0.3 * p.z) - 0.9,
      0.7 * std::sin(0.25 * p.x + 0.1 * p.y));
}

// A lattice over a cube whose inner nodes are moved at random.
vtkSmartPointer<vtkUnstructuredGrid> MakeLattice(double side, int nodes, double jitter)
{
  auto mesh = MakeTetrahedra({ { 0.0, side, 0.0, side, 0.0, side } }, { { nodes, nodes, nodes } });
  std::mt19937 random(5);
  std::uniform_real_distribution<double> between(-jitter, jitter);
  MovePoints(mesh,
    [&](glm::dvec3 point)
    {
      const bool isInner = glm::all(glm::greaterThan(point, glm::dvec3(0.0))) &&
        glm::all(glm::lessThan(point, glm::dvec3(side)));
      for (int axis = 0; axis < 3 && isInner; ++axis)
      {
        point[axis] += between(random) * side / (nodes - 1);
      }
      return point;
    });
  return mesh;
}

vtkSmartPointer<vtkImageData> MakeField(double side, int points, const WorldMap& map)
{
  auto field =
    MakeImage({ { 0, points - 1, 0, points - 1, 0, points - 1 } }, glm::dvec3(side / (points - 1)));
  SetDisplacements(field, map);
  return field;
}

//------------------------------------------------------------------------------
// Checks that a filter reports one error at each update, has an empty output, and works afterwards.
class Misuse
{
public:
  Misuse()
  {
    this->Points = MakePoints(MakePositions(20, glm::dvec3(1.0), glm::dvec3(9.0), 1));
    this->Mesh = MakeLattice(10.0, 3, 0.0);
    SetDisplacements(this->Mesh, Shift(1.0, 2.0, 3.0));
    this->Restore();
    this->Tested.Update();
  }

  vtkDeformGeometryFilter* GetFilter() { return this->Tested.Filter; }
  vtkSmartPointer<vtkUnstructuredGrid> CopyMesh()
  {
    auto copy = vtkSmartPointer<vtkUnstructuredGrid>::New();
    copy->DeepCopy(this->Mesh);
    return copy;
  }

  void Expect(const std::string& text)
  {
    this->Tested.VerifyFailure(text);
    this->Restore();
    const glm::dvec3 moved = GetPoint(this->Tested.Update(), 3);
    EXPECT_LT(glm::length(moved - GetPoint(this->Points, 3) - glm::dvec3(1.0, 2.0, 3.0)), 1e-6);
  }

private:
  void Restore()
  {
    vtkDeformGeometryFilter* filter = this->GetFilter();
    filter->SetInputData(this->Points);
    filter->SetDeformationData(this->Mesh);
    filter->SetInputConnection(2, nullptr);
    filter->SetInputArrayToProcess(
      0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::VECTORS);
    filter->SetDisplacementScale(1.0);
    filter->SetPointsAreDeformed(false);
    filter->SetOutsideModeToDiscard();
    filter->SetFadeDistance(0.0);
  }

  vtkSmartPointer<vtkPolyData> Points;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Subject Tested;
};

// Where bodies overlap at rest, points and voxels follow the same body, also if the axes of the
// volume are rotated.
TEST(DeformGeometryFilter, OverlappingBodies)
{
  const auto large = MakeTetrahedra({ { 2.3, 22.6, 2.3, 20.7, 2.3, 20.4 } }, { { 5, 5, 5 } });
  const auto small = MakeTetrahedra({ { 10.3, 27.6, 4.3, 18.7, 4.3, 18.4 } }, { { 6, 4, 4 } });
  const auto volume = MakeImage({ { 0, 29, 0, 23, 0, 23 } });
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return p.x; });
  vtkNew<vtkImageData> turned;
  turned->DeepCopy(volume);
  const double direction[9] = { 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0 };
  turned->SetDirectionMatrix(direction);
  turned->SetOrigin(0.0, 29.0, 0.0);
  for (const bool swap : { false, true })
  {
    vtkNew<vtkAppendFilter> append;
    append->AddInputData(swap ? small : large);
    append->AddInputData(swap ? large : small);
    append->Update();
    vtkUnstructuredGrid* mesh = append->GetOutput();
    SetDisplacements(mesh, Shift(0.0, 0.0, 0.0));
    const vtkIdType begin = swap ? 0 : large->GetNumberOfPoints();
    const glm::dvec3 shift(0.0, 0.0, 40.0);
    for (vtkIdType node = 0; node < small->GetNumberOfPoints(); ++node)
    {
      mesh->GetPointData()->GetVectors()->SetTuple(begin + node, &shift.x);
    }
    for (vtkImageData* image : { volume.Get(), turned.Get() })
    {
      Deformed moved(image, mesh);
      vtkImageData* output = moved.Expect("overlap at rest");
      const auto isCovered = [&](const glm::dvec3& p)
      { return moved.IsCovered(output->FindPoint(p.x, p.y, p.z)); };
      // Voxels of the overlap outside the cells that the boundary crosses, and their neighbors.
      const auto inside = MakePositions(200, glm::dvec3(13.0, 7.0, 7.0), glm::dvec3(20.0), 5);
      std::vector<glm::dvec3> voxels;
      for (const glm::dvec3& point : inside)
      {
        voxels.push_back(glm::min(glm::round(point), glm::dvec3(20.0, 16.0, 16.0)));
      }
      Subject subject(MakePoints(voxels), mesh);
      const std::vector<glm::dvec3> found = subject.GetPositions();
      subject.Filter->InverseOn();
      subject.Filter->SetInputData(MakePoints(found));
      const std::vector<glm::dvec3> back = subject.GetPositions();
      for (std::size_t i = 0; i < voxels.size(); ++i)
      {
        EXPECT_LE(glm::distance(found[i], voxels[i] + shift), 1e-9);
        EXPECT_LE(glm::distance(back[i], voxels[i]), 1e-9);
        EXPECT_FALSE(isCovered(voxels[i]));
        EXPECT_TRUE(isCovered(found[i]));
      }
    }
  }
}

TEST(DeformGeometryFilter, Misuse)
{
  Misuse misuse;
  vtkDeformGeometryFilter* filter = misuse.GetFilter();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();

  for (const double wrong : { nan, infinity })
  {
    std::vector<glm::dvec3> positions(7, glm::dvec3(2.0));
    positions[5].y = wrong;
    filter->SetInputData(MakePoints(positions));
    misuse.Expect("Point 5 of the point set on input port 0 is not finite");
  }

  auto shortNormals = MakePoints(std::vector<glm::dvec3>(7, glm::dvec3(2.0)));
  shortNormals->GetPointData()->SetNormals(
    AddArray(MakePoints({ glm::dvec3(1.0) }), "n", Shift(0.0, 0.0, 1.0)));
  filter->SetInputData(shortNormals);
  misuse.Expect("The point array \"n\" on input port 0 has 1 tuples, but there are 7 points");

  vtkNew<vtkPlaneSource> plane;
  plane->Update();
  vtkNew<vtkUnstructuredGrid> triangles;
  triangles->SetPoints(plane->GetOutput()->GetPoints());
  triangles->SetCells(VTK_QUAD, plane->GetOutput()->GetPolys());
  SetDisplacements(triangles, Shift(1.0, 0.0, 0.0));
  filter->SetDeformationData(triangles);
  misuse.Expect("no tetrahedra");

  vtkNew<vtkUnstructuredGrid> empty;
  filter->SetDeformationData(empty);
  misuse.Expect("no points");

  auto mesh = misuse.CopyMesh();
  mesh->GetPointData()->GetVectors()->SetComponent(4, 1, nan);
  filter->SetDeformationData(mesh);
  misuse.Expect("Displacement 4 of the deformation mesh is not finite");

  mesh = misuse.CopyMesh();
  mesh->GetPoints()->GetData()->SetComponent(6, 2, infinity);
  filter->SetDeformationData(mesh);
  misuse.Expect("Point 6 of the deformation mesh is not finite");

  filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "none");
  misuse.Expect("no point array \"none\". Its point arrays: \"displacement\". Choose");
  filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "none");
  misuse.Expect("not chosen among the arrays of points");
  filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "none");

  filter->SetRestData(misuse.CopyMesh());
  filter->SetDeformationData(nullptr);
  misuse.Expect("no deformation on input port 1");

  filter->SetRestData(MakeLattice(10.0, 4, 0.0));
  misuse.Expect("27 points and the mesh at rest has 64");

  filter->SetDisplacementScale(nan);
  misuse.Expect("DisplacementScale is not finite");

  filter->SetDisplacementScale(1e300);
  filter->SetInputData(MakePoints({ glm::dvec3(5.0) }, VTK_FLOAT));
  misuse.Expect("overflow the type float");

  for (const double wrong : { -1.0, nan, infinity })
  {
    filter->SetOutsideModeToKeep();
    filter->SetFadeDistance(wrong);
    misuse.Expect("fade distance is ");
  }

  auto field = MakeField(10.0, 4, Shift(1.0, 2.0, 3.0));
  filter->SetDeformationData(field);
  filter->SetPointsAreDeformed(true);
  misuse.Expect("PointsAreDeformed is on");

  vtkNew<vtkImageData> emptyField;
  filter->SetDeformationData(emptyField);
  misuse.Expect("field is empty");

  field->GetPointData()->GetVectors()->SetComponent(9, 0, nan);
  filter->SetDeformationData(field);
  misuse.Expect(
    "Vector 9 of the displacement field is not finite. Remove NaN and infinity from it, "
    "or mark its point as hidden in vtkGhostType.");
}

TEST(DeformGeometryFilter, Missing)
{
  // Without a deformation points do not change by a bit.
  auto points = MakePoints(MakePositions(50, glm::dvec3(-5.0), glm::dvec3(5.0), 2), VTK_FLOAT);
  points->GetPointData()->SetNormals(
    AddArray(points, "n", [](const glm::dvec3& p) { return 3.0 * p; }));
  Subject still;
  still.Filter->SetInputData(points);
  vtkPointSet* output = still.Update();
  EXPECT_TRUE(still.Warning.empty());
  EXPECT_TRUE(HaveEqualBits(output->GetPoints()->GetData(), points->GetPoints()->GetData()));
  EXPECT_TRUE(
    HaveEqualBits(output->GetPointData()->GetNormals(), points->GetPointData()->GetNormals()));
  EXPECT_TRUE(still.IsValid(49));

  // No points.
  vtkNew<vtkPolyData> none;
  auto mesh = MakeLattice(10.0, 3, 0.0);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  Subject empty(none, mesh);
  EXPECT_EQ(empty.Update()->GetNumberOfPoints(), 0);
  EXPECT_TRUE(HasPart(empty.Warning, "no points"));

  // Displacements of nodes that no cell uses may be NaN.
  vtkNew<vtkUnstructuredGrid> larger;
  larger->DeepCopy(mesh);
  const vtkIdType unused = larger->GetPoints()->InsertNextPoint(0.0, 0.0, 0.0);
  larger->GetPointData()->GetVectors()->InsertNextTuple3(
    std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  EXPECT_EQ(larger->GetNumberOfPoints(), unused + 1);
  Subject moved(MakePoints({ glm::dvec3(5.0) }), larger);
  EXPECT_EQ(moved.GetPositions()[0].x, 6.0);
}

TEST(DeformGeometryFilter, Abort)
{
  auto points = MakePoints(MakePositions(300000, glm::dvec3(1.0), glm::dvec3(9.0), 3));
  auto mesh = MakeLattice(10.0, 3, 0.0);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  Subject aborted(points, mesh);
  aborted.Abort();
  EXPECT_EQ(aborted.Update()->GetNumberOfPoints(), 300000);
  EXPECT_TRUE(aborted.IsValid(299999));
}

//------------------------------------------------------------------------------
// Moves a point by the tetrahedron of lowest id that contains it. Returns nothing outside the mesh.
std::optional<glm::dvec3> MoveByMesh(
  vtkUnstructuredGrid* mesh, const WorldMap& displace, const glm::dvec3& point)
{
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    mesh->GetCellPoints(cell, ids);
    std::array<glm::dvec3, 4> nodes;
    for (int k = 0; k < 4; ++k)
    {
      nodes[k] = GetPoint(mesh, ids->GetId(k));
    }
    const glm::dmat3 sides(nodes[0] - nodes[3], nodes[1] - nodes[3], nodes[2] - nodes[3]);
    const glm::dvec3 w = glm::inverse(sides) * (point - nodes[3]);
    const double last = 1.0 - w.x - w.y - w.z;
    if (std::min({ w.x, w.y, w.z, last }) >= -1e-12)
    {
      return point + w.x * displace(nodes[0]) + w.y * displace(nodes[1]) +
        w.z * displace(nodes[2]) + last * displace(nodes[3]);
    }
  }
  return {};
}

TEST(DeformGeometryFilter, Mesh)
{
  auto mesh = MakeLattice(10.0, 5, 0.3);
  SetDisplacements(mesh, Bend);
  // Displacements are rounded like those of the array.
  const auto displace = [](const glm::dvec3& node)
  { return glm::dvec3(glm::vec3(Bend(node) - node)); };
  std::vector<glm::dvec3> positions = MakePositions(2000, glm::dvec3(-1.0), glm::dvec3(11.0), 4);
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    positions.push_back(GetPoint(mesh, id)); // shared by many tetrahedra
  }
  Subject subject(MakePoints(positions), mesh);
  const std::vector<glm::dvec3> moved = subject.GetPositions();
  vtkIdType outside = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const std::optional<glm::dvec3> expected = MoveByMesh(mesh, displace, positions[i]);
    EXPECT_EQ(subject.IsValid(static_cast<vtkIdType>(i)), expected.has_value());
    outside += expected ? 0 : 1;
    worst = std::max(worst, glm::length(moved[i] - expected.value_or(positions[i])));
  }
  EXPECT_LT(worst, 1e-12);
  EXPECT_GT(outside, 500);
  EXPECT_EQ(subject.Filter->GetNumberOfOutsidePoints(), outside);
  EXPECT_TRUE(
    HasPart(subject.Warning, std::to_string(outside) + " of " + std::to_string(positions.size())));

  // The same deformation as a deformed mesh on port 1, and as doubled displacements with a scale of
  // 0.5.
  vtkNew<vtkUnstructuredGrid> deformed;
  deformed->DeepCopy(mesh);
  deformed->GetPoints()->SetDataTypeToDouble();
  deformed->GetPoints()->SetNumberOfPoints(mesh->GetNumberOfPoints());
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 position = GetPoint(mesh, id) + displace(GetPoint(mesh, id));
    deformed->GetPoints()->SetPoint(id, &position.x);
  }
  const auto expectSame = [&](double tolerance)
  {
    const std::vector<glm::dvec3> again = subject.GetPositions();
    double difference = 0.0;
    for (std::size_t i = 0; i < positions.size(); ++i)
    {
      difference = std::max(difference, glm::length(again[i] - moved[i]));
    }
    EXPECT_LT(difference, tolerance);
  };
  subject.Filter->SetDeformationData(deformed);
  subject.Filter->SetRestData(mesh);
  expectSame(1e-12);
  subject.Filter->SetInputConnection(2, nullptr);
  subject.Filter->SetPointsAreDeformed(true);
  expectSame(1e-12);
  subject.Filter->SetPointsAreDeformed(false);
  SetDisplacements(mesh, [&](const glm::dvec3& p) { return p + 2.0 * displace(p); });
  subject.Filter->SetDeformationData(mesh);
  subject.Filter->SetDisplacementScale(0.5);
  expectSame(1e-12);

  // A point on the boundary of the mesh counts as inside, although floats round its position.
  subject.Filter->SetInputData(MakePoints({ { 10.0 * (1.0 + 1e-7), 3.3, 4.4 } }, VTK_FLOAT));
  subject.Update();
  EXPECT_TRUE(subject.IsValid(0));
  EXPECT_EQ(subject.Filter->GetOutput()->GetPoints()->GetDataType(), VTK_FLOAT);
}

//------------------------------------------------------------------------------
// Whether a point is outside the field of 6 points on each axis from 0 to 10, within the tolerance.
bool IsBesideField(const glm::dvec3& point)
{
  const glm::dvec3 beyond = glm::abs(point - glm::clamp(point, 0.0, 10.0));
  bool isBeside = false;
  for (int axis = 0; axis < 3; ++axis)
  {
    isBeside = isBeside || (beyond[axis] > 0.0 && beyond[axis] < 0.0021);
  }
  return isBeside;
}

// Vectors and normals. The reference is finite differences of positions.
void TestArraysOf(vtkDataObject* deformation, int mode, bool inverse, bool fieldIsInverse)
{
  constexpr double step = 1e-5;
  const std::vector<glm::dvec3> positions =
    MakePositions(300, glm::dvec3(-2.0), glm::dvec3(12.0), 7);
  const auto getDirection = [](const glm::dvec3& p)
  { return glm::normalize(glm::dvec3(std::sin(3.0 * p.x), std::cos(5.0 * p.y), 0.3)); };
  const auto getOther = [](const glm::dvec3& p)
  { return glm::normalize(glm::dvec3(0.2, std::sin(4.0 * p.z), std::cos(2.0 * p.x))); };
  std::vector<glm::dvec3> all;
  for (const glm::dvec3& position : positions)
  {
    const glm::dvec3 direction = getDirection(position);
    const glm::dvec3 other = getOther(position);
    for (const glm::dvec3& offset : { glm::dvec3(0.0), direction, -direction, other, -other })
    {
      all.push_back(position + step * offset);
    }
  }
  auto points = MakePoints(all);
  points->GetPointData()->SetVectors(AddArray(points, "vectors", getDirection));
  points->GetPointData()->SetNormals(AddArray(points, "normals",
    [&](const glm::dvec3& p) { return glm::normalize(glm::cross(getDirection(p), getOther(p))); }));
  AddArray(points, "more", getOther);
  Subject subject(points, deformation);
  subject.Filter->SetOutsideMode(mode);
  subject.Filter->SetFadeDistance(4.0);
  subject.Filter->SetInverse(inverse);
  subject.Filter->SetFieldIsInverse(fieldIsInverse);
  subject.Filter->SetTransformAllInputVectors(true);
  const std::vector<glm::dvec3> moved = subject.GetPositions();
  vtkPointData* output = subject.Filter->GetOutput()->GetPointData();
  int compared = 0;
  int wrong = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const std::size_t at = 5 * i;
    const auto id = static_cast<vtkIdType>(at);
    bool isValid = true;
    for (int k = 0; k < 5; ++k)
    {
      isValid = isValid && subject.IsValid(id + k);
    }
    if (!isValid)
    {
      continue;
    }
    if (vtkImageData::SafeDownCast(deformation) &&
      (IsBesideField(positions[i]) || IsBesideField(moved[at])))
    {
      continue; // see TestArraysOnTheBorder()
    }
    // Skip points at which the map is not differentiable.
    const glm::dvec3 before = (moved[at] - moved[at + 2]) / step;
    const glm::dvec3 after = (moved[at + 1] - moved[at]) / step;
    const glm::dvec3 beside = (moved[at] - moved[at + 4]) / step;
    const glm::dvec3 otherSide = (moved[at + 3] - moved[at]) / step;
    if (glm::length(after - before) > 1e-4 || glm::length(otherSide - beside) > 1e-4)
    {
      continue;
    }
    ++compared;
    const glm::dvec3 along = 0.5 * (before + after);
    const glm::dvec3 across = 0.5 * (beside + otherSide);
    const glm::dvec3 normal = glm::normalize(glm::cross(along, across));
    wrong += glm::length(GetTuple(output->GetVectors(), id) - along) < 1e-6 ? 0 : 1;
    wrong += glm::length(GetTuple(output->GetArray("more"), id) - across) < 1e-6 ? 0 : 1;
    wrong += glm::length(GetTuple(output->GetNormals(), id) - normal) < 1e-6 ? 0 : 1;
  }
  SCOPED_TRACE(testing::Message() << "mode " << mode << ", inverse " << inverse
                                  << ", field is inverse " << fieldIsInverse);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(compared, 100);
}

TEST(DeformGeometryFilter, Arrays)
{
  auto mesh = MakeLattice(10.0, 4, 0.2);
  SetDisplacements(mesh, Bend);
  auto field = MakeField(10.0, 6, Bend);
  for (const int mode : { Discard, Extrapolate, Keep })
  {
    for (const bool inverse : { false, true })
    {
      TestArraysOf(mesh, mode, inverse, false);
      TestArraysOf(field, mode, inverse, false);
      TestArraysOf(field, mode, inverse, true);
    }
  }

  // Other arrays are passed, and a warning names the normals of cells.
  auto points = MakePoints({ glm::dvec3(1.0), glm::dvec3(2.0) });
  vtkNew<vtkIntArray> ids;
  ids->SetName("ids");
  ids->InsertNextValue(17);
  ids->InsertNextValue(4);
  points->GetPointData()->AddArray(ids);
  vtkNew<vtkCellArray> lines;
  const vtkIdType line[2] = { 0, 1 };
  lines->InsertNextCell(2, line);
  points->SetLines(lines);
  vtkNew<vtkFloatArray> normals;
  normals->SetName("cell normals");
  normals->SetNumberOfComponents(3);
  normals->InsertNextTuple3(1.0, 0.0, 0.0);
  points->GetCellData()->SetNormals(normals);
  const vtkSmartPointer<vtkDoubleArray> vectors = AddArray(points, "v", Shift(1.0, 0.0, 0.0));
  Subject subject(points, mesh);
  vtkPointSet* output = subject.Update();
  EXPECT_EQ(output->GetPointData()->GetArray("ids"), ids);
  EXPECT_EQ(output->GetPointData()->GetArray("v"), vectors); // not active
  EXPECT_EQ(output->GetNumberOfCells(), 1);
  EXPECT_TRUE(HasPart(subject.Warning, "\"cell normals\""));

  // An array that is both the active vectors and the active scalars keeps its place and both roles.
  vtkPointData* pointData = points->GetPointData();
  pointData->SetActiveScalars("v");
  pointData->SetActiveVectors("v");
  AddArray(points, "after", Shift(0.0, 0.0, 1.0));
  points->Modified();
  output = subject.Update();
  EXPECT_EQ(output->GetPointData()->GetScalars(), output->GetPointData()->GetVectors());
  for (int i = 0; i < pointData->GetNumberOfArrays(); ++i)
  {
    EXPECT_STREQ(output->GetPointData()->GetArrayName(i), pointData->GetArrayName(i));
  }
}

// Vectors and normals of points on the border of a field, and of points that rounding has moved
// across it by less than the tolerance of its faces.
void TestArraysOnTheBorder(double factor)
{
  const auto stretch = [factor](const glm::dvec3& p) { return factor * p; };
  const auto keep = [](const glm::dvec3& p) { return p; };
  auto field = MakeImage({ { 0, 7, 0, 7, 0, 7 } }, glm::dvec3(0.1), glm::dvec3(0.1));
  SetDisplacements(field, stretch);
  std::vector<glm::dvec3> positions;
  for (vtkIdType id = 0; id < field->GetNumberOfPoints(); ++id)
  {
    positions.push_back(GetPoint(field, id));
  }
  for (const double away : { 0.1 - 1e-6, 0.1 - 1e-9, 0.8 + 1e-9, 0.8 + 1e-6 })
  {
    positions.insert(positions.end(), { glm::dvec3(away), { 0.33, away, 0.44 } });
  }
  const glm::dvec3 normal(0.6, 0.8, 0.0);
  const auto verify =
    [&](const WorldMap& place, bool inverse, bool fieldIsInverse, int mode, int precision)
  {
    std::vector<glm::dvec3> placed;
    for (const glm::dvec3& position : positions)
    {
      placed.push_back(place(position));
    }
    auto points = MakePoints(placed, precision);
    points->GetPointData()->SetVectors(
      AddArray(points, "v", [](const glm::dvec3&) { return glm::dvec3(1.0); }));
    points->GetPointData()->SetNormals(
      AddArray(points, "n", [&](const glm::dvec3&) { return normal; }));
    Subject subject(points, field);
    subject.Filter->SetOutsideMode(mode);
    subject.Filter->SetFadeDistance(1.0);
    subject.Filter->SetInverse(inverse);
    subject.Filter->SetFieldIsInverse(fieldIsInverse);
    vtkPointData* output = subject.Update()->GetPointData();
    EXPECT_EQ(subject.Filter->GetNumberOfOutsidePoints(), 0);
    const double ratio = inverse != fieldIsInverse ? 1.0 / factor : factor;
    double worst = 0.0;
    for (vtkIdType id = 0; id < points->GetNumberOfPoints(); ++id)
    {
      worst = std::max({ worst, glm::length(GetTuple(output->GetVectors(), id) - ratio),
        glm::length(GetTuple(output->GetNormals(), id) - normal) });
    }
    EXPECT_LT(worst, 1e-4) << "factor " << factor << ", inverse " << inverse << ", mode " << mode;
  };
  for (const int mode : { Discard, Extrapolate, Keep })
  {
    for (const int precision : { VTK_FLOAT, VTK_DOUBLE })
    {
      verify(keep, false, false, mode, precision);
      verify(stretch, true, false, mode, precision);
      verify(stretch, false, true, mode, precision);
    }
  }
}

TEST(DeformGeometryFilter, ArraysOnTheBorder)
{
  TestArraysOnTheBorder(1.5);
  TestArraysOnTheBorder(20.0);
}

// After an error in the second block, the points of the first block are not counted.
TEST(DeformGeometryFilter, OutsideOfAFailedUpdate)
{
  auto mesh = MakeLattice(10.0, 3, 0.0);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, MakePoints({ glm::dvec3(50.0), glm::dvec3(5.0) }));
  Observed<vtkDeformGeometryFilter> filter;
  filter.Filter->SetInputDataObject(blocks);
  filter.Filter->SetDeformationData(mesh);
  filter.Filter->Update();
  EXPECT_EQ(filter.Filter->GetNumberOfOutsidePoints(), 1);
  blocks->SetBlock(1, MakePoints({ glm::dvec3(std::numeric_limits<double>::quiet_NaN()) }));
  filter.Filter->Modified();
  filter.Filter->Update();
  EXPECT_TRUE(HasPart(filter.Observer->GetErrorMessage(), "is not finite"));
  EXPECT_EQ(filter.Filter->GetNumberOfOutsidePoints(), 0);
}

// Outside a translated box the exact result is known in closed form.
TEST(DeformGeometryFilter, Outside)
{
  const glm::dvec3 shift(0.5, -0.25, 0.75);
  const double side = 8.0;
  auto mesh = MakeLattice(side, 4, 0.2);
  SetDisplacements(mesh, Shift(shift.x, shift.y, shift.z));
  auto field = MakeField(side, 5, Shift(shift.x, shift.y, shift.z));
  const std::vector<glm::dvec3> positions =
    MakePositions(3000, glm::dvec3(-8.0), glm::dvec3(16.0), 9);
  for (vtkDataObject* deformation : std::initializer_list<vtkDataObject*>{ mesh, field })
  {
    for (const double distance : { 0.0, 3.0, 5.0 })
    {
      Subject subject(MakePoints(positions), deformation);
      subject.Filter->SetOutsideModeToKeep();
      subject.Filter->SetFadeDistance(distance);
      const std::vector<glm::dvec3> moved = subject.GetPositions();
      EXPECT_TRUE(subject.Warning.empty());
      double worst = 0.0;
      int still = 0;
      for (std::size_t i = 0; i < positions.size(); ++i)
      {
        const double away =
          glm::length(positions[i] - glm::clamp(positions[i], glm::dvec3(0.0), glm::dvec3(side)));
        const double weight = away == 0.0 ? 1.0 : distance > 0.0 ? Fade(away / distance) : 0.0;
        worst = std::max(worst, glm::length(moved[i] - positions[i] - weight * shift));
        still += weight == 0.0 && moved[i] == positions[i] ? 1 : 0;
        EXPECT_TRUE(weight > 0.0 || moved[i] == positions[i]);
      }
      EXPECT_LT(worst, 1e-12);
      EXPECT_GT(still, 500);
    }
    // The displacement is 0.94, and the limit is 0.87, two thirds of FadeDistance.
    Subject folded(MakePoints({ glm::dvec3(-0.5) }), deformation);
    folded.Filter->SetOutsideModeToKeep();
    folded.Filter->SetFadeDistance(1.3);
    folded.Update();
    EXPECT_TRUE(HasPart(folded.Warning, "moves by up to 0.935"));
    folded.Filter->SetInputData(MakePoints({ glm::dvec3(1.0) }));
    folded.Update();
    EXPECT_TRUE(folded.Warning.empty()); // no point is outside

    // A point so far away that the square of its distance is infinite.
    for (const int mode : { Extrapolate, Keep })
    {
      Subject far(MakePoints({ glm::dvec3(1e200), glm::dvec3(4.0) }), deformation);
      far.Filter->SetOutsideMode(mode);
      EXPECT_LT(glm::length(far.GetPositions()[1] - 4.0 - shift), 1e-12);
      EXPECT_EQ(far.GetPositions()[0].x, 1e200);
      far.Filter->SetInverse(true);
      EXPECT_EQ(far.GetPositions()[0].x, 1e200);
    }

    Subject subject(MakePoints(positions), deformation);
    subject.Filter->SetOutsideModeToExtrapolate();
    const std::vector<glm::dvec3> moved = subject.GetPositions();
    double worst = 0.0;
    for (std::size_t i = 0; i < positions.size(); ++i)
    {
      worst = std::max(worst, glm::length(moved[i] - positions[i] - shift));
    }
    EXPECT_LT(worst, 1e-12);
  }

  // An affine map is extrapolated outside a mesh.
  const glm::dmat3 matrix(1.1, 0.2, 0.0, -0.1, 0.9, 0.1, 0.05, 0.0, 1.2);
  SetDisplacements(mesh, [&](const glm::dvec3& p) { return matrix * p; });
  Subject affine(MakePoints(positions), mesh);
  affine.Filter->SetOutsideModeToExtrapolate();
  const std::vector<glm::dvec3> moved = affine.GetPositions();
  double worst = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    worst = std::max(worst, glm::length(moved[i] - matrix * positions[i]));
  }
  EXPECT_LT(worst, 2e-5); // displacements are floats, and are extrapolated over up to 5 tetrahedra
}

//------------------------------------------------------------------------------
// Moves a point by trilinear interpolation of a field, as a reference.
glm::dvec3 MoveByField(vtkImageData* field, const glm::dvec3& point)
{
  int dimensions[3];
  field->GetDimensions(dimensions);
  double spacing[3];
  field->GetSpacing(spacing);
  double origin[3];
  field->GetOrigin(origin);
  int low[3];
  double t[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const double index =
      std::min(std::max((point[axis] - origin[axis]) / spacing[axis], 0.0), dimensions[axis] - 1.0);
    low[axis] = std::min(static_cast<int>(index), dimensions[axis] - 2);
    t[axis] = index - low[axis];
  }
  glm::dvec3 moved = point;
  for (int corner = 0; corner < 8; ++corner)
  {
    double weight = 1.0;
    int at[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const int upper = corner >> axis & 1;
      weight *= upper ? t[axis] : 1.0 - t[axis];
      at[axis] = low[axis] + upper;
    }
    moved += weight *
      GetTuple(field->GetPointData()->GetVectors(),
        (static_cast<vtkIdType>(at[2]) * dimensions[1] + at[1]) * dimensions[0] + at[0]);
  }
  return moved;
}

TEST(DeformGeometryFilter, Field)
{
  const std::vector<glm::dvec3> positions =
    MakePositions(3000, glm::dvec3(-0.5), glm::dvec3(10.5), 11);
  auto field = MakeField(10.0, 8, Bend);
  Subject subject(MakePoints(positions), field);
  for (const int mode : { Discard, Extrapolate })
  {
    subject.Filter->SetOutsideMode(mode);
    const std::vector<glm::dvec3> moved = subject.GetPositions();
    double worst = 0.0;
    for (std::size_t i = 0; i < positions.size(); ++i)
    {
      const bool isInside = glm::clamp(positions[i], 0.0, 10.0) == positions[i];
      if (!isInside && glm::distance(glm::clamp(positions[i], 0.0, 10.0), positions[i]) < 0.01)
      {
        continue; // within the tolerance of the field's faces, see below
      }
      const bool isMoved = isInside || mode == Extrapolate;
      EXPECT_EQ(subject.IsValid(static_cast<vtkIdType>(i)), isMoved);
      worst = std::max(
        worst, glm::length(moved[i] - (isMoved ? MoveByField(field, positions[i]) : positions[i])));
    }
    EXPECT_LT(worst, 1e-12);
  }

  // The faces of a field have a tolerance of 1/1000 of a cell, as in vtkDeformVolumeFilter.
  subject.Filter->SetOutsideModeToDiscard();
  const double cell = 10.0 / 7.0;
  subject.Filter->SetInputData(
    MakePoints({ { -0.0009 * cell, 5.0, 5.0 }, { -0.0011 * cell, 5.0, 5.0 } }));
  subject.Update();
  EXPECT_TRUE(subject.IsValid(0));
  EXPECT_FALSE(subject.IsValid(1));

  // Vectors of hidden points are undefined.
  const auto ghosts = MakeArray<vtkUnsignedCharArray>(
    vtkDataSetAttributes::GhostArrayName(), field->GetNumberOfPoints());
  ghosts->SetValue(3 + 8 * (4 + 8 * 5), vtkDataSetAttributes::HIDDENPOINT);
  field->GetPointData()->AddArray(ghosts);
  field->GetPointData()->GetVectors()->SetComponent(
    3 + 8 * (4 + 8 * 5), 0, std::numeric_limits<double>::quiet_NaN());
  subject.Filter->SetInputData(MakePoints({ cell * glm::dvec3(3.5, 4.0, 5.0),
    cell * glm::dvec3(4.0, 4.0, 5.0), cell * glm::dvec3(3.5, 5.0, 5.0),
    cell * glm::dvec3(4.1, 4.2, 5.1), cell * glm::dvec3(4.0 - 1e-6, 4.0, 5.0) }));
  subject.Update();
  EXPECT_FALSE(subject.IsValid(0));
  EXPECT_TRUE(subject.IsValid(1));
  EXPECT_TRUE(subject.IsValid(2));
  EXPECT_TRUE(subject.IsValid(3));
  EXPECT_TRUE(subject.IsValid(4));

  // An oblique field of doubles, with an extent that does not begin at 0.
  auto oblique = MakeImage({ { 2, 6, -3, 4, 5, 9 } }, { 1.5, 0.7, 2.0 }, { 3.0, 4.0, -5.0 });
  SetObliqueDirection(oblique);
  const glm::dmat3 matrix(1.1, 0.2, 0.0, -0.1, 0.9, 0.1, 0.05, 0.0, 1.2);
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < oblique->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = GetPoint(oblique, id);
    const glm::dvec3 u = matrix * p - p;
    vectors->InsertNextTuple(&u.x);
  }
  oblique->GetPointData()->SetVectors(vectors);
  double center[3];
  oblique->GetCenter(center);
  const glm::dvec3 middle(center[0], center[1], center[2]);
  std::vector<glm::dvec3> inner = MakePositions(200, middle - 1.0, middle + 1.0, 13);
  Subject affine(MakePoints(inner), oblique);
  std::vector<glm::dvec3> moved = affine.GetPositions();
  double worst = 0.0;
  for (std::size_t i = 0; i < inner.size(); ++i)
  {
    worst = std::max(worst, glm::length(moved[i] - matrix * inner[i]));
  }
  EXPECT_LT(worst, 1e-12);
  affine.Filter->SetInputData(MakePoints(moved));
  affine.Filter->SetInverse(true);
  moved = affine.GetPositions();
  worst = 0.0;
  for (std::size_t i = 0; i < inner.size(); ++i)
  {
    worst = std::max(worst, glm::length(moved[i] - inner[i]));
  }
  EXPECT_LT(worst, 1e-9);
}

//------------------------------------------------------------------------------
// The deformation of the inverse is the identity, for deformations without folds.
TEST(DeformGeometryFilter, Inverse)
{
  auto mesh = MakeLattice(10.0, 5, 0.2);
  SetDisplacements(mesh, Bend);
  auto field = MakeField(10.0, 12, Bend);
  struct Case
  {
    vtkDataObject* Deformation;
    bool FieldIsInverse;
  };
  for (const Case& one : { Case{ mesh, false }, Case{ field, false }, Case{ field, true } })
  {
    for (const int mode : { Discard, Extrapolate, Keep })
    {
      const double margin = mode == Discard ? 0.0 : 5.0;
      const std::vector<glm::dvec3> positions =
        MakePositions(5000, glm::dvec3(-margin), glm::dvec3(10.0 + margin), 17);
      Subject back(MakePoints(positions), one.Deformation);
      back.Filter->SetFieldIsInverse(one.FieldIsInverse);
      back.Filter->SetOutsideMode(mode);
      back.Filter->SetFadeDistance(6.0);
      back.Filter->SetInverse(true);
      Subject forth(MakePoints(back.GetPositions()), one.Deformation);
      forth.Filter->SetFieldIsInverse(one.FieldIsInverse);
      forth.Filter->SetOutsideMode(mode);
      forth.Filter->SetFadeDistance(6.0);
      const std::vector<glm::dvec3> again = forth.GetPositions();
      double worst = 0.0;
      int compared = 0;
      int lost = 0;
      for (std::size_t i = 0; i < positions.size(); ++i)
      {
        const auto id = static_cast<vtkIdType>(i);
        if (back.IsValid(id))
        {
          ++compared;
          lost += forth.IsValid(id) ? 0 : 1;
          worst = std::max(worst, forth.IsValid(id) ? glm::length(again[i] - positions[i]) : 0.0);
        }
      }
      std::cout << "inverse and forward, " << (one.Deformation == mesh ? "mesh" : "field")
                << (one.FieldIsInverse ? " that is inverse" : "") << ", mode " << mode << ": "
                << compared << " points, largest error " << worst << ", " << lost << " lost\n";
      EXPECT_LT(worst, 1e-6);
      EXPECT_EQ(lost, 0);
      EXPECT_GT(compared, mode == Discard ? 3500 : 4900);
    }
  }
}

// The inverse of a map that folds along x. It is piecewise linear, so all solutions are known. The
// first cells are inverted if the amplitude is less than -1.
void CheckFolds(double amplitude)
{
  const auto foldAlongX = [amplitude](double x) { return x + amplitude * std::sin(x); };
  constexpr int points = 41;
  constexpr double step = 0.25;
  const auto fold = [&](const glm::dvec3& p) { return glm::dvec3(foldAlongX(p.x), p.y, p.z); };
  auto field = MakeImage({ { 0, points - 1, 0, 2, 0, 2 } }, { step, 2.0, 2.0 });
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < field->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 p = GetPoint(field, id);
    const glm::dvec3 u = fold(p) - p;
    vectors->InsertNextTuple(&u.x);
  }
  field->GetPointData()->SetVectors(vectors);
  const std::vector<glm::dvec3> positions =
    MakePositions(2000, { -1.0, 0.5, 0.5 }, { 10.0, 3.5, 3.5 }, 19);
  Subject subject(MakePoints(positions), field);
  subject.Filter->SetInverse(true);
  std::vector<glm::dvec3> found = subject.GetPositions();
  int folded = 0;
  int contested = 0; // the cell of lowest id is inverted, another cell is not
  int outside = 0;
  double worst = 0.0;
  const auto check = [&](std::size_t i, bool lowestFirst)
  {
    std::vector<double> upright;
    std::vector<double> inverted;
    for (int cell = 0; cell + 1 < points; ++cell)
    {
      const double a = foldAlongX(cell * step);
      const double b = foldAlongX((cell + 1) * step);
      const double t = (positions[i].x - a) / (b - a);
      if (t >= 0.0 && t <= 1.0)
      {
        (b > a ? upright : inverted).push_back((cell + t) * step);
      }
    }
    const bool isValid = subject.IsValid(static_cast<vtkIdType>(i));
    EXPECT_EQ(isValid, !upright.empty() || !inverted.empty());
    outside += isValid ? 0 : 1;
    folded += upright.size() > 1 ? 1 : 0;
    contested +=
      !upright.empty() && !inverted.empty() && inverted.front() < upright.front() ? 1 : 0;
    if (isValid && lowestFirst)
    {
      const double expected = upright.empty() ? inverted.front() : upright.front();
      worst = std::max(worst, std::abs(found[i].x - expected));
    }
    else if (isValid && !upright.empty())
    {
      double nearest = 1e9;
      for (const double one : upright)
      {
        nearest = std::min(nearest, std::abs(found[i].x - one));
      }
      worst = std::max(worst, nearest);
    }
    worst = std::max(worst,
      isValid
        ? std::max(std::abs(found[i].y - positions[i].y), std::abs(found[i].z - positions[i].z))
        : 0.0);
  };
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    check(i, true);
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_TRUE(amplitude > 0.0 ? folded > 300 : contested > 100);
  EXPECT_TRUE(amplitude < 0.0 || outside > 20);

  // A mesh with the same fold.
  const auto mesh =
    MakeTetrahedra({ { 0.0, (points - 1) * step, 0.0, 4.0, 0.0, 4.0 } }, { { points, 3, 3 } });
  mesh->GetPointData()->SetVectors(vectors);
  subject.Filter->SetDeformationData(mesh);
  found = subject.GetPositions();
  worst = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    check(i, false);
  }
  EXPECT_LT(worst, 1e-9);
}

//------------------------------------------------------------------------------
// A mesh with a node at each voxel, and the same tetrahedra as the sampling mesh: the deformed
// volume and the filter use the same piecewise linear map.
TEST(DeformGeometryFilter, AgainstVolume)
{
  const int size = 16;
  auto volume = MakeImage({ { 0, size - 1, 0, size - 1, 0, size - 1 } });
  const char* const names[3] = { "x", "y", "z" };
  for (int axis = 0; axis < 3; ++axis)
  {
    AddScalars<double>(volume, names[axis], [axis](const glm::dvec3& p) { return p[axis]; });
  }
  auto mesh = MakeLattice(size - 1.0, size, 0.0);
  for (const double amplitude : { 1.0, 6.0 }) // the second one folds
  {
    SetDisplacements(mesh,
      [&](const glm::dvec3& p)
      {
        const double s = 0.25;
        return p +
          amplitude *
          glm::dvec3(std::sin(s * p.y + 0.2 * p.x), std::sin(s * p.z), std::cos(s * p.x));
      });
    Deformed deformed(volume, mesh);
    deformed.Filter->SetBackgroundValue(-1000.0);
    vtkImageData* output = deformed.Update();
    std::vector<glm::dvec3> centers;
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      centers.push_back(GetPoint(output, id));
    }
    Subject back(MakePoints(centers), mesh);
    back.Filter->SetInverse(true);
    const std::vector<glm::dvec3> rest = back.GetPositions();
    // Each rest position must be deformed to its voxel, up to the rounding of positions.
    std::vector<glm::dvec3> seen;
    std::vector<std::size_t> ids;
    int onOneSide = 0;
    int elsewhere = 0;
    for (std::size_t i = 0; i < centers.size(); ++i)
    {
      const auto id = static_cast<vtkIdType>(i);
      onOneSide += deformed.IsCovered(id) != back.IsValid(id) ? 1 : 0;
      if (!deformed.IsCovered(id) || !back.IsValid(id))
      {
        continue;
      }
      glm::dvec3 position;
      for (int axis = 0; axis < 3; ++axis)
      {
        position[axis] = output->GetPointData()->GetArray(names[axis])->GetComponent(id, 0);
      }
      seen.push_back(position);
      ids.push_back(i);
      elsewhere += glm::length(position - rest[i]) > 0.25 ? 1 : 0;
    }
    Subject forth(MakePoints(seen), mesh);
    const std::vector<glm::dvec3> moved = forth.GetPositions();
    double worst = 0.0;
    for (std::size_t i = 0; i < seen.size(); ++i)
    {
      const glm::dvec3 miss = glm::abs(moved[i] - centers[ids[i]]);
      worst = std::max({ worst, miss.x, miss.y, miss.z });
    }
    std::cout << "amplitude " << amplitude << ": " << seen.size() << " voxels, largest error "
              << worst << ", " << onOneSide << " covered by one filter only, " << elsewhere
              << " with another winner\n";
    EXPECT_LE(worst, 1.0 / 256.0);
    EXPECT_GT(seen.size(), 2000);
    EXPECT_LE(onOneSide, 8);  // on the surface, since positions are rounded to 1/256
    EXPECT_LE(elsewhere, 30); // between the parts of a fold, for the same reason
  }
}

// The largest distance of the points of a surface from another surface. Points outside the box from
// min to max are skipped.
double GetDistance(vtkPointSet* from, vtkPointSet* to, double min, double max, int& compared)
{
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(to);
  locator->BuildLocator();
  vtkNew<vtkGenericCell> cell;
  double worst = 0.0;
  for (vtkIdType id = 0; id < from->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(from, id);
    if (glm::clamp(point, min, max) != point)
    {
      continue;
    }
    double closest[3];
    vtkIdType cellId = -1;
    int subId = 0;
    double squared = 0.0;
    locator->FindClosestPoint(&point.x, closest, cell, cellId, subId, squared);
    worst = std::max(worst, std::sqrt(squared));
    ++compared;
  }
  return worst;
}

// A deformation that is far from the origin moves points as one at the origin does.
TEST(DeformGeometryFilter, FarFromTheOrigin)
{
  const glm::dvec3 far(5e5, 5.2e6, -2e3);
  const std::vector<glm::dvec3> positions =
    MakePositions(3000, glm::dvec3(-3.0), glm::dvec3(13.0), 5);
  const auto displacement = [](const glm::dvec3& p)
  { return p + glm::dvec3(0.6 * std::sin(0.4 * p.y), 0.3 * std::cos(0.5 * p.z), 0.05 * p.x); };
  const auto make = [&](bool isMesh, const glm::dvec3& offset)
  {
    const auto image =
      MakeImage({ { 0, 5, 0, 5, 0, 5 } }, glm::dvec3(1.9, 2.0, 2.1), glm::dvec3(0.0));
    vtkSmartPointer<vtkDataSet> made;
    if (!isMesh)
    {
      const double turned[9] = { 0.96, 0.28, 0.0, -0.28, 0.96, 0.0, 0.0, 0.0, 1.0 };
      image->SetDirectionMatrix(turned);
      SetDisplacements(image, displacement);
      image->SetOrigin(offset.x, offset.y, offset.z);
      return vtkSmartPointer<vtkDataSet>(image);
    }
    auto mesh = MakeMesh(image, 4);
    SetDisplacements(mesh, displacement);
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 point = GetPoint(mesh, id) + offset;
      points->InsertNextPoint(&point.x);
    }
    mesh->SetPoints(points);
    return vtkSmartPointer<vtkDataSet>(mesh);
  };
  const auto move = [&](const std::vector<glm::dvec3>& points, const glm::dvec3& offset)
  {
    std::vector<glm::dvec3> moved = points;
    for (glm::dvec3& point : moved)
    {
      point += offset;
    }
    return moved;
  };
  for (const bool isMesh : { true, false })
  {
    for (const int mode : { Discard, Extrapolate, Keep })
    {
      for (const bool isInverse : { false, true })
      {
        SCOPED_TRACE(testing::Message()
          << "mesh " << isMesh << ", mode " << mode << ", inverse " << isInverse);
        Subject near(MakePoints(positions), make(isMesh, glm::dvec3(0.0)));
        Subject away(MakePoints(move(positions, far)), make(isMesh, far));
        for (Subject* subject : { &near, &away })
        {
          subject->Filter->SetOutsideMode(mode);
          subject->Filter->SetFadeDistance(2.0);
          subject->Filter->SetInverse(isInverse);
        }
        const std::vector<glm::dvec3> wanted = near.GetPositions();
        const std::vector<glm::dvec3> found = move(away.GetPositions(), -far);
        EXPECT_GT(near.Filter->GetNumberOfOutsidePoints(), mode == Discard ? 1000 : -1);
        EXPECT_LT(near.Filter->GetNumberOfOutsidePoints(), 2900);
        int different = 0;
        for (std::size_t i = 0; i < positions.size(); ++i)
        {
          different +=
            near.IsValid(static_cast<vtkIdType>(i)) != away.IsValid(static_cast<vtkIdType>(i)) ||
            !(glm::length(found[i] - wanted[i]) < 1e-5);
        }
        // Outside, the closest face jumps, and a point may lie there.
        EXPECT_LE(different, mode == Discard ? 0 : 3);
      }
    }
  }
  // Points on the boundary of a mesh that were rounded to floats are inside.
  std::vector<glm::dvec3> border = MakePositions(500, glm::dvec3(0.0), glm::dvec3(9.5), 6);
  const auto mesh = make(true, far);
  for (glm::dvec3& point : border)
  {
    point.x = mesh->GetBounds()[0] - far.x;
  }
  Subject floats(MakePoints(move(border, far), VTK_FLOAT), mesh);
  floats.Update();
  EXPECT_EQ(floats.Filter->GetNumberOfOutsidePoints(), 0);
  Subject doubles(MakePoints(move(border, far - glm::dvec3(0.1, 0.0, 0.0))), mesh);
  doubles.Update();
  EXPECT_EQ(doubles.Filter->GetNumberOfOutsidePoints(), 500);
}

TEST(DeformGeometryFilter, Isosurface)
{
  const int size = 48;
  auto volume = MakeImage({ { 0, size - 1, 0, size - 1, 0, size - 1 } });
  AddScalars<float>(volume, "value",
    [](const glm::dvec3& p)
    {
      const glm::dvec3 q = p - 23.5;
      return 14.0 + 2.0 * std::sin(0.5 * q.x) * std::cos(0.4 * q.y) - glm::length(q);
    });
  const auto bend = [](const glm::dvec3& p)
  {
    return p +
      glm::dvec3(
        3.0 * std::sin(0.08 * p.y), 3.0 * std::sin(0.07 * p.z), 4.0 * std::sin(0.06 * p.x));
  };
  auto mesh = MakeLattice(size - 1.0, 7, 0.1);
  SetDisplacements(mesh, bend);
  auto field = MakeField(size - 1.0, 12, bend);
  for (vtkDataObject* deformation : std::initializer_list<vtkDataObject*>{ mesh, field })
  {
    Deformed deformed(volume, deformation);
    vtkNew<vtkFlyingEdges3D> after;
    after->SetInputData(deformed.Update());
    after->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "value");
    after->SetValue(0, 0.5);
    after->Update();
    vtkNew<vtkFlyingEdges3D> before;
    before->SetInputData(volume);
    before->SetValue(0, 0.5);
    Subject subject;
    subject.Filter->SetInputConnection(before->GetOutputPort());
    subject.Filter->SetDeformationData(deformation);
    vtkPointSet* moved = subject.Update();
    EXPECT_TRUE(subject.Warning.empty());
    int compared = 0;
    const double there = GetDistance(moved, after->GetOutput(), 4.0, 46.0, compared);
    const double back = GetDistance(after->GetOutput(), moved, 4.0, 46.0, compared);
    std::cout << (deformation == mesh ? "mesh" : "field") << ": isosurfaces of " << compared
              << " points are at most " << there << " and " << back << " voxels apart\n";
    EXPECT_GT(compared, 5000);
    EXPECT_LT(there, 0.5);
    EXPECT_LT(back, 0.5);
  }
}

//------------------------------------------------------------------------------
TEST(DeformGeometryFilter, DataTypes)
{
  auto mesh = MakeLattice(10.0, 3, 0.0);
  SetDisplacements(mesh, Shift(1.0, 2.0, 3.0));

  // The output for a structured grid is a structured grid.
  vtkNew<vtkStructuredGrid> grid;
  grid->SetExtent(2, 4, 0, 2, 5, 6);
  vtkNew<vtkPoints> points;
  for (int i = 0; i < 18; ++i)
  {
    points->InsertNextPoint(1.0 + i % 3, 1.0 + i / 3 % 3, 1.0 + i / 9);
  }
  grid->SetPoints(points);
  Subject structured(grid, mesh);
  auto* moved = vtkStructuredGrid::SafeDownCast(structured.Update());
  EXPECT_NE(moved, nullptr);
  if (moved)
  {
    int extent[6];
    moved->GetExtent(extent);
    EXPECT_EQ(extent[5], 6);
    EXPECT_EQ(GetPoint(moved, 17).z, 5.0);
  }

  // A mesh that is moved by its own displacements.
  Subject self(mesh, mesh);
  EXPECT_NE(vtkUnstructuredGrid::SafeDownCast(self.Update()), nullptr);
  EXPECT_EQ(GetPoint(self.Filter->GetOutput(), 0).y, 2.0);
  EXPECT_EQ(self.Filter->GetOutput()->GetNumberOfCells(), mesh->GetNumberOfCells());

  // Composite datasets as the mesh, then as the points.
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, mesh);
  Subject composite(MakePoints({ glm::dvec3(4.0) }), blocks);
  EXPECT_EQ(composite.GetPositions()[0].z, 7.0);
  vtkNew<vtkMultiBlockDataSet> surfaces;
  surfaces->SetBlock(0, MakePoints({ glm::dvec3(4.0), glm::dvec3(-1.0) }));
  surfaces->SetBlock(2, MakePoints({ glm::dvec3(5.0), glm::dvec3(20.0) }));
  Subject each(surfaces, mesh);
  each.Filter->Update();
  auto* output = vtkMultiBlockDataSet::SafeDownCast(each.Filter->GetOutputDataObject(0));
  EXPECT_NE(output, nullptr);
  if (output)
  {
    EXPECT_EQ(GetPoint(vtkDataSet::SafeDownCast(output->GetBlock(0)), 0).x, 5.0);
    EXPECT_EQ(GetPoint(vtkDataSet::SafeDownCast(output->GetBlock(2)), 0).x, 6.0);
  }
  EXPECT_EQ(each.Filter->GetNumberOfOutsidePoints(), 2);
  EXPECT_TRUE(HasPart(std::string(each.Observer->GetWarningMessage()), "2 of 4 points"));
  each.Observer->Clear();
  surfaces->SetBlock(1, MakeVolume());
  EXPECT_FALSE(each.Filter->GetExecutive()->Update());
  EXPECT_TRUE(HasPart(std::string(each.Observer->GetErrorMessage()), "vtkImageData"));

  // Changed inputs are read again.
  Subject live(MakePoints({ glm::dvec3(4.0) }), mesh);
  mesh->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), 2.5);
  EXPECT_EQ(live.GetPositions()[0].x, 5.0);
  vtkInformation* time = live.Filter->GetOutput()->GetInformation();
  EXPECT_TRUE(time->Has(vtkDataObject::DATA_TIME_STEP()));
  EXPECT_EQ(time->Get(vtkDataObject::DATA_TIME_STEP()), 2.5);
  SetDisplacements(mesh, Shift(2.0, 0.0, 0.0));
  mesh->Modified();
  EXPECT_EQ(live.GetPositions()[0].x, 6.0);
  mesh->GetPointData()->GetVectors()->Fill(0.5);
  mesh->GetPointData()->GetVectors()->Modified();
  EXPECT_EQ(live.GetPositions()[0].x, 4.5);
  live.Filter->SetInverse(true);
  EXPECT_EQ(live.GetPositions()[0].x, 3.5);
  auto field = MakeField(10.0, 4, Shift(-1.0, 0.0, 0.0));
  live.Filter->SetDeformationData(field);
  EXPECT_LT(std::abs(live.GetPositions()[0].x - 5.0), 1e-6);
  live.Filter->SetFieldIsInverse(true);
  EXPECT_EQ(live.GetPositions()[0].x, 3.0);
  live.Filter->SetDeformationData(mesh);
  EXPECT_EQ(live.GetPositions()[0].x, 3.5);
}

} // namespace

TEST(DeformGeometryFilter, Folds)
{
  CheckFolds(2.5);
  CheckFolds(-2.5);
}
