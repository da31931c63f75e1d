// SPDX-License-Identifier: BSD-3-Clause
// SamplingFactor. The output is equal, bit by bit, to that of a filter whose input is a subsampled
// volume. Also: which data is kept when the factor changes, and which extents are requested from a
// source that makes parts.
#include "ArrayMaking.h"
#include "DivisionCases.h"

#include <vtkCellData.h>
#include <vtkExtractVOI.h>
#include <vtkSOADataArrayTemplate.h>

#include <algorithm>

using namespace divisionCases;

namespace
{

int RoundUp(int number, int factor)
{
  while (number % factor != 0)
  {
    ++number;
  }
  return number;
}

/// The id of the point of an image at a position. In VTK 9.4 vtkImageData hides the overload of
/// vtkDataSet that takes three coordinates.
vtkIdType FindPoint(vtkImageData* image, double x, double y, double z)
{
  double point[3] = { x, y, z };
  return image->FindPoint(point);
}

/// A volume of every second or fourth voxel. vtkExtractVOI copies the values; masks are computed
/// here.
vtkSmartPointer<vtkImageData> Subsample(vtkImageData* volume, int factor)
{
  const Extent whole = GetExtent(volume);
  Extent voi;    // in indices of the volume
  Extent coarse; // in indices of the coarse volume
  for (int axis = 0; axis < 3; ++axis)
  {
    voi[2 * axis] = RoundUp(whole[2 * axis], factor);
    voi[2 * axis + 1] = -RoundUp(-whole[2 * axis + 1], factor);
    coarse[2 * axis] = voi[2 * axis] / factor;
    coarse[2 * axis + 1] = voi[2 * axis + 1] / factor;
  }
  vtkNew<vtkImageData> values;
  values->ShallowCopy(volume);
  values->GetCellData()->Initialize();
  vtkDataArray* ghosts = volume->GetPointGhostArray();
  values->GetPointData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  vtkNew<vtkExtractVOI> extract;
  extract->SetInputData(values);
  extract->SetVOI(voi.data());
  extract->SetSampleRate(factor, factor, factor);
  extract->Update();
  auto made = vtkSmartPointer<vtkImageData>::New();
  made->ShallowCopy(extract->GetOutput());
  const glm::dvec3 first = GetPoint(made, 0);
  // How cells are split into tetrahedra depends on the parity of their indices.
  made->SetExtent(coarse.data());
  made->SetOrigin(volume->GetOrigin());
  EXPECT_EQ(GetPoint(made, 0), first);
  EXPECT_EQ(made->GetNumberOfPoints(), extract->GetOutput()->GetNumberOfPoints());

  if (ghosts)
  {
    vtkNew<vtkUnsignedCharArray> mask;
    mask->SetName(vtkDataSetAttributes::GhostArrayName());
    for (vtkIdType id = 0; id < made->GetNumberOfPoints(); ++id)
    {
      double point[3];
      made->GetPoint(id, point);
      mask->InsertNextValue(
        static_cast<unsigned char>(ghosts->GetComponent(volume->FindPoint(point), 0)));
    }
    made->GetPointData()->AddArray(mask);
  }
  vtkDataArray* active = volume->GetCellData()->GetArray("ActiveTetrahedra");
  vtkDataArray* cellGhosts = volume->GetCellGhostArray();
  vtkDataArray* crossed = volume->GetCellData()->GetArray("CutTetrahedra");
  made->GetPointData()->RemoveArray("CutDistance"); // is not valid for larger cells
  if (active || cellGhosts || crossed)
  {
    vtkNew<vtkUnsignedCharArray> mask;
    mask->SetName("ActiveTetrahedra");
    for (int z = voi[4]; z < voi[5]; z += factor)
    {
      for (int y = voi[2]; y < voi[3]; y += factor)
      {
        for (int x = voi[0]; x < voi[1]; x += factor)
        {
          bool all = true;
          for (int i = 0; i < factor * factor * factor; ++i)
          {
            int cell[3] = { x + i % factor, y + i / factor % factor, z + i / factor / factor };
            const vtkIdType id = volume->ComputeCellId(cell);
            all = all && (!active || active->GetComponent(id, 0) == 31.0) &&
              (!crossed || crossed->GetComponent(id, 0) == 0.0) &&
              (!cellGhosts || cellGhosts->GetComponent(id, 0) == 0.0);
          }
          mask->InsertNextValue(all ? 31 : 0);
        }
      }
    }
    made->GetCellData()->AddArray(mask);
  }
  return made;
}

/// The output of a filter whose input is subsampled by Subsample().
vtkSmartPointer<vtkImageData> DeformSubsampled(const Case& from, int factor)
{
  Deformed deformed(Subsample(from.Volume, factor), from.Deformation);
  from.Set(deformed.Filter);
  double spacing[3];
  deformed.Filter->GetCustomSpacing(spacing);
  deformed.Filter->SetCustomSpacing(spacing[0] * factor, spacing[1] * factor, spacing[2] * factor);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(deformed.Update());
  return image;
}

TEST(DeformSamplingFactor, Misuse)
{
  auto volume = divisionCases::MakeVolume({ { 1, 9, 0, 9, -3, 9 } });
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(0.5, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  EXPECT_EQ(deformed.Filter->GetSamplingFactor(), 1);
  for (const int factor : { 0, -1, 3, 5, 8, 1 << 30 })
  {
    deformed.Filter->SetSamplingFactor(factor);
    EXPECT_EQ(deformed.Filter->GetSamplingFactor(), factor);
    deformed.VerifyFailure("Set 1, 2 or 4.");
    deformed.Filter->SetSamplingFactor(1);
    EXPECT_GT(deformed.Update()->GetNumberOfPoints(), 0);
  }
  // 4 and 8 on x; 4 only.
  deformed.Filter->SetSamplingFactor(4);
  EXPECT_GT(deformed.Update()->GetNumberOfPoints(), 0);
  deformed.Filter->SetInputData(divisionCases::MakeVolume({ { 1, 7, 0, 9, -3, 9 } }));
  deformed.VerifyFailure("With SamplingFactor 4 fewer than two");
  deformed.Filter->SetSamplingFactor(2);
  EXPECT_GT(deformed.Update()->GetNumberOfPoints(), 0);
}

// Hides some cells and voxels, few enough that most of the coarse cells are active.
void MaskSome(vtkImageData* volume)
{
  vtkNew<vtkUnsignedCharArray> active;
  active->SetName("ActiveTetrahedra");
  vtkNew<vtkUnsignedCharArray> cellGhosts;
  cellGhosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (vtkIdType id = 0; id < volume->GetNumberOfCells(); ++id)
  {
    active->InsertNextValue(Scatter(id) % 300 == 0 ? Scatter(id) >> 9 & 31 : 31);
    cellGhosts->InsertNextValue(Scatter(id + 7) % 900 == 0 ? vtkDataSetAttributes::HIDDENCELL : 0);
  }
  volume->GetCellData()->AddArray(active);
  volume->GetCellData()->AddArray(cellGhosts);
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    ghosts->InsertNextValue(Scatter(id + 99) % 200 == 0 ? vtkDataSetAttributes::HIDDENPOINT : 0);
  }
  volume->GetPointData()->AddArray(ghosts);
}

TEST(DeformSamplingFactor, AgainstSubsampled)
{
  std::vector<Case> cases = MakeCases();
  {
    Case few = cases[2];
    few.Name = "A few masks";
    few.Volume = divisionCases::MakeVolume(GetExtent(few.Volume));
    MaskSome(few.Volume);
    cases.push_back(few);

    // Arrays in other memory layouts and with several components; a negative spacing and another
    // direction.
    Case odd = cases[2];
    odd.Name = "Odd";
    odd.Volume = divisionCases::MakeVolume(GetExtent(odd.Volume));
    AddOtherTypes(odd.Volume);
    vtkNew<vtkSOADataArrayTemplate<short>> vectors;
    vectors->SetName("vectors");
    vectors->SetNumberOfComponents(3);
    vectors->SetNumberOfTuples(odd.Volume->GetNumberOfPoints());
    const auto pairs = MakeArray<vtkFloatArray>("pairs", odd.Volume->GetNumberOfPoints(), 2);
    const auto colors =
      MakeArray<vtkUnsignedCharArray>("colors", odd.Volume->GetNumberOfPoints(), 3);
    for (vtkIdType id = 0; id < odd.Volume->GetNumberOfPoints(); ++id)
    {
      for (int component = 0; component < 3; ++component)
      {
        vectors->SetComponent(id, component, Scatter(id + component) % 1000);
        colors->SetComponent(id, component, Scatter(id + 10 * component) % 256);
        pairs->SetComponent(id, component % 2, 0.1 * (Scatter(3 * id + component) % 1000));
      }
    }
    odd.Volume->GetPointData()->SetVectors(vectors);
    odd.Volume->GetPointData()->AddArray(pairs);
    odd.Volume->GetPointData()->AddArray(colors);
    odd.Volume->SetSpacing(1.0, -1.25, 0.75);
    SetObliqueDirection(odd.Volume);
    const auto mesh = MakeMesh(odd.Volume, 5, 1.0);
    SetDisplacements(mesh, Shift(0.3, 1.6, -0.7));
    odd.Deformation = mesh;
    odd.Set = [](vtkDeformVolumeFilter*) {};
    cases.push_back(odd);
  }
  for (const Case& from : cases)
  {
    Deformed deformed(from.Volume, from.Deformation);
    from.Set(deformed.Filter);
    for (const int factor : { 2, 4 })
    {
      SCOPED_TRACE(from.Name + ", SamplingFactor " + std::to_string(factor));
      deformed.Filter->SetSamplingFactor(factor);
      vtkImageData* output = deformed.Update();
      const auto expected = DeformSubsampled(from, factor);
      EXPECT_TRUE(AreEqual(output, expected));
      for (int axis = 0; axis < 3; ++axis)
      {
        EXPECT_EQ(output->GetSpacing()[axis], expected->GetSpacing()[axis]);
        EXPECT_EQ(output->GetOrigin()[axis], expected->GetOrigin()[axis]);
      }
      // If masks hide tetrahedra in a quarter of the cells, hardly any coarse cell is active.
      const bool hasMasks = from.Name.find("asks") != std::string::npos;
      EXPECT_TRUE(deformed.Filter->GetNumberOfCoveredVoxels() > 0 || hasMasks);
      vtkDataArray* scalars = output->GetPointData()->GetScalars();
      EXPECT_TRUE(scalars && scalars->GetName() == std::string("float"));
    }
  }
}

// A field with a vector for each voxel gives the same result as a field with vectors for the coarse
// voxels only.
TEST(DeformSamplingFactor, DenseField)
{
  const Extent extent{ { -9, 130, 3, 140, -15, 131 } }; // so large that it is read in place
  const auto volume = divisionCases::MakeVolume(extent);
  for (const Extent& ends : { extent, Extent{ { -11, 133, 2, 140, -15, 140 } } })
  {
    const auto field = MakeImage(ends, glm::dvec3(1.0), glm::dvec3(3.0, -2.0, 1.0));
    SetDisplacements(field, Bend(volume));
    Deformed deformed(volume, field);
    deformed.Filter->SetSamplingFactor(2);
    vtkDataArray* vectors = field->GetPointData()->GetVectors();
    for (int step = 0; step < 2; ++step)
    {
      Deformed few(volume, Subsample(field, 2));
      few.Filter->SetSamplingFactor(2);
      EXPECT_TRUE(AreEqual(deformed.Update(), few.Update()));
      EXPECT_GT(deformed.Filter->GetNumberOfCoveredVoxels(), 1000);
      const vtkIdType point = FindPoint(field, 43.0, 42.0, 29.0);
      vectors->SetTuple3(point, 1.0, 0.5, 0.0);
      vectors->Modified();
    }
  }
}

/// A filter whose SamplingFactor changes, and checks of the data that it keeps.
class Switched
{
public:
  Switched()
    : Volume(divisionCases::MakeVolume({ { -9, 150, 3, 90, -15, 60 } }))
    , Mesh(MakeMesh(Volume, 12, 3.0))
    , Tested(Volume, Mesh)
  {
    SetDisplacements(this->Mesh, Shift(0.5, 0.0, 0.25));
    this->Tested.Filter->SetResamplerToExact();
    this->Tested.Filter->SetOutputBoundsModeToVolumeBounds();
  }

  void Run()
  {
    vtkDeformVolumeFilter* filter = this->Tested.Filter;
    this->Update(1);
    EXPECT_EQ(GetReported(filter, "Static mappings made"), 1);
    EXPECT_EQ(GetReported(filter, "Volumes sent"), 1);
    const vtkTypeInt64 bytes = filter->GetDeviceMemory();
    this->Update(2);
    EXPECT_EQ(GetReported(filter, "Static mappings made"), 2);
    EXPECT_EQ(GetReported(filter, "Volumes sent"), 2);
    EXPECT_GT(filter->GetDeviceMemory(), bytes);
    for (const int factor : { 1, 2, 1, 2 })
    {
      // No static mapping is built, no volume is sent and no brick is resampled, although the
      // output changes.
      this->Update(factor);
      EXPECT_EQ(GetReportedSeconds(filter, "Seconds for the static mapping"), 0.0);
      this->ExpectParts(true);
    }
    // A node that moves at one factor has moved at the other, too.
    for (const int factor : { 2, 2, 1, 1, 2, 1 })
    {
      this->MoveNode();
      this->Update(factor);
      this->ExpectParts(false);
    }
    EXPECT_EQ(GetReported(filter, "Static mappings made"), 2);
    EXPECT_EQ(GetReported(filter, "Volumes sent"), 2);

    // Values and masks change in place.
    for (const int factor : { 2, 1, 2, 1 })
    {
      vtkDataArray* values = this->Volume->GetPointData()->GetScalars();
      values->SetComponent(FindPoint(this->Volume, 43.0, 42.0, 29.0), 0, 1000.0 * factor);
      values->Modified();
      this->Update(factor);
    }
    EXPECT_EQ(GetReported(filter, "Volumes sent"), 6);
    MaskSome(this->Volume);
    for (const int factor : { 1, 2 })
    {
      vtkDataArray* active = this->Volume->GetCellData()->GetArray("ActiveTetrahedra");
      active->SetComponent(active->GetNumberOfTuples() / 2, 0, 0.0);
      active->Modified();
      this->Update(factor);
    }
    EXPECT_EQ(GetReported(filter, "Static mappings made"), 2);
    EXPECT_EQ(GetReported(filter, "Volumes sent"), 7); // the last changed value, for factor 2

    // All memory is released, and everything is rebuilt.
    filter->ReleaseDeviceMemory();
    EXPECT_EQ(filter->GetDeviceMemory(), 0);
    filter->Modified();
    this->Update(1);
    this->Update(2);
    EXPECT_EQ(GetReported(filter, "Static mappings made"), 4);

    // An error in the displacements affects all factors.
    vtkDataArray* vectors = this->Mesh->GetPointData()->GetVectors();
    vectors->SetComponent(0, 0, std::nan(""));
    vectors->Modified();
    filter->Update();
    EXPECT_EQ(this->Tested.TakeErrors(), 1);
    vectors->SetComponent(0, 0, 0.0);
    vectors->Modified();
    this->Update(1);
    this->Update(2);

    // When the volume is replaced, the data of the previous one is released for both factors.
    const vtkTypeInt64 both = filter->GetDeviceMemory();
    const auto other = divisionCases::MakeVolume({ { -9, 150, 3, 90, -15, 60 } });
    this->Volume = other;
    filter->SetInputData(other);
    this->Update(2);
    EXPECT_LT(filter->GetDeviceMemory(), both / 2);
    this->Update(1);
  }

private:
  void MoveNode()
  {
    vtkDataArray* vectors = this->Mesh->GetPointData()->GetVectors();
    const vtkIdType node = (6 * 12 + 5 + this->Moves % 3) * 12 + 5;
    vectors->SetTuple3(node, 0.5, 0.5 + 0.125 * (++this->Moves % 5), 0.25);
    vectors->Modified();
  }

  void Update(int factor)
  {
    this->Tested.Filter->SetSamplingFactor(factor);
    vtkImageData* output = this->Tested.Update();
    EXPECT_GT(this->Tested.Filter->GetNumberOfCoveredVoxels(), 0);
    Extent changed;
    this->Tested.Filter->GetChangedExtent(changed.data());
    EXPECT_TRUE(changed == GetExtent(output) || factor == this->LastFactor);
    this->LastFactor = factor;
  }

  void ExpectParts(bool nothing)
  {
    const vtkIdType made = GetReported(this->Tested.Filter, "Bricks resampled");
    const vtkIdType all = GetReported(this->Tested.Filter, "Bricks of the volume");
    EXPECT_TRUE(nothing ? made == 0 : made < all);
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Tested;
  int Moves = 0;
  int LastFactor = 0;
};

// If the memory limit suffices for one factor only, the data of the other factor is released.
TEST(DeformSamplingFactor, Memory)
{
  const auto volume = divisionCases::MakeVolume({ { 0, 99, 0, 99, 0, 99 } });
  const auto mesh = MakeMesh(volume, 40); // so many nodes that the static mapping has links
  SetDisplacements(mesh, Shift(0.5, 0.0, 0.25));
  vtkTypeInt64 limit = 1000000; // becomes the need of one factor, up to 10 %
  {
    Deformed deformed(volume, mesh);
    deformed.Filter->SetResamplerToExact();
    do
    {
      limit += limit / 10;
      deformed.Filter->SetMemoryLimit(limit);
      deformed.Filter->Update();
    } while (deformed.TakeErrors() > 0 && limit < 1000000000);
  }
  Deformed deformed(volume, mesh);
  vtkDeformVolumeFilter* filter = deformed.Filter;
  filter->SetResamplerToExact();
  filter->SetMemoryLimit(limit);
  vtkIdType builds = 0;
  for (const int factor : { 2, 1, 2, 1 })
  {
    filter->SetSamplingFactor(factor);
    EXPECT_GT(deformed.Update()->GetNumberOfPoints(), 0);
    EXPECT_LE(filter->GetDeviceMemory(), limit);
    builds = GetReported(filter, "Static mappings made");
  }
  EXPECT_GT(builds, 2);
  // If the limit suffices for both factors, their data is kept.
  filter->SetMemoryLimit(2 * limit);
  const auto update = [&](int factor)
  {
    filter->SetSamplingFactor(factor);
    deformed.Update();
    return GetReported(filter, "Static mappings made");
  };
  update(2);
  builds = update(1);
  EXPECT_EQ(update(2), builds);
}

// From a source that makes parts, only the extents are requested that the coarse voxels need.
TEST(DeformSamplingFactor, Parts)
{
  for (const Case& from : MakeCases())
  {
    if (from.Name != "Runs" && from.Name != "Links" && from.Name != "Masks" &&
      from.Name != "Field" && from.Name != "Extrapolated mesh")
    {
      continue;
    }
    const int factor = 2;
    const auto whole = DeformSubsampled(from, factor);
    Deformed streamed;
    vtkNew<PartSource> source;
    source->SetVolume(from.Volume);
    streamed.Filter->SetInputConnection(source->GetOutputPort());
    streamed.Filter->SetDeformationData(from.Deformation);
    from.Set(streamed.Filter);
    streamed.Filter->SetSamplingFactor(factor);
    constexpr int parts = 4;
    for (int part = 0; part < parts; ++part)
    {
      streamed.Filter->UpdatePiece(part, parts, 0);
      EXPECT_EQ(streamed.TakeErrors(), 0);
      EXPECT_TRUE(IsPartOf(streamed.Filter->GetOutput(), whole));
    }
    if (from.Name == "Extrapolated mesh") // needs the whole volume
    {
      EXPECT_EQ(source->GetMost(), from.Volume->GetNumberOfPoints());
      continue;
    }
    EXPECT_LT(source->GetMost(), from.Volume->GetNumberOfPoints());
    for (const Extent& made : source->Made)
    {
      EXPECT_TRUE(std::all_of(made.begin(), made.end(), [](int end) { return end % 2 == 0; }));
    }
  }
  // A source that does not make parts is executed once, for the whole volume.
  const Case from = MakeCases()[2];
  Deformed whole;
  vtkNew<PartSource> source;
  source->SetVolume(from.Volume);
  source->CanMakeParts = false;
  whole.Filter->SetInputConnection(source->GetOutputPort());
  whole.Filter->SetDeformationData(from.Deformation);
  from.Set(whole.Filter);
  whole.Filter->SetSamplingFactor(2);
  whole.Filter->UpdatePiece(0, 2, 0);
  EXPECT_EQ(whole.TakeErrors(), 0);
  EXPECT_EQ(source->Made.size(), 1U);
}

} // namespace

TEST(DeformSamplingFactor, Switched)
{
  Switched().Run();
}
