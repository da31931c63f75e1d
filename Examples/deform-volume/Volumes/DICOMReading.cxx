// SPDX-License-Identifier: BSD-3-Clause
// ITK decodes the pixels of each slice. This file composes the volume, because ITK's
// ImageSeriesReader does not check the positions of slices.
#include "DICOMReading.h"

#include "DICOMFile.h"
#include "Failure.h"
#include "ImageAxes.h"
#include "ItkImage.h"
#include "Messages.h"
#include "ProgressBar.h"

#include <itkGDCMImageIO.h>

#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkTrivialProducer.h>
#include <vtksys/Directory.hxx>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <vector>

namespace
{
const char* const Advice =
  ". dcm2niix or 3D Slicer can convert such a series into a NIfTI or NRRD file";

struct Slice
{
  std::string Name;
  std::string Series;
  std::string Description;
  std::string Photometric;
  int Size[2];       // columns, rows
  double Spacing[2]; // of columns, of rows
  double Row[3];     // of unit length, towards the next column
  double Column[3];  // towards the next row
  double Position[3];
  double Along = 0.0; // the position on the normal
};

std::string GetSizeText(const Slice& slice)
{
  return std::to_string(slice.Size[0]) + " x " + std::to_string(slice.Size[1]);
}

class Series
{
public:
  Series(const std::string& folder, Messages& messages);

  // Sorts the slices by their positions along the normal, and checks them.
  void Sort(Messages& messages);
  vtkSmartPointer<vtkImageData> Read(bool showProgress) const;
  // Sets the columns of a matrix: the directions of the axes, and the position of the first voxel.
  void GetPlace(vtkMatrix4x4* place) const;

private:
  [[noreturn]] void Fail(const std::string& reason) const;
  void AddFile(const std::string& name);
  void WarnOfLeftOut(Messages& messages) const;
  void CheckSeries() const;
  void CheckShapes() const;
  void CheckSteps() const;
  void CheckPlaces(Messages& messages) const;
  vtkSmartPointer<vtkDataArray> ReadSlice(const Slice& slice) const;

  const Slice& First() const { return this->Slices.front(); }
  const Slice& Last() const { return this->Slices.back(); }
  // The mean vector from one slice to the next.
  void GetStep(double step[3]) const;

  std::string Folder;
  std::vector<Slice> Slices;
  std::vector<std::string> WithoutImage;
  std::vector<std::string> Doses;
  std::vector<std::string> Others; // files in other formats
};

Series::Series(const std::string& folder, Messages& messages)
  : Folder(folder)
{
  vtksys::Directory directory;
  directory.Load(folder);
  std::vector<std::string> names;
  for (unsigned long i = 0; i < directory.GetNumberOfFiles(); ++i)
  {
    names.emplace_back(directory.GetFile(i));
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names)
  {
    // Operating systems write hidden files, some named like slices. DICOMDIR is a list of files.
    if (name[0] != '.' && name != "DICOMDIR" &&
      !vtksys::SystemTools::FileIsDirectory(folder + "/" + name))
    {
      this->AddFile(name);
    }
  }
  if (this->Slices.empty() && !this->Doses.empty())
  {
    throw Failure("cannot read " + folder + ": " + this->Doses.front() +
      " is an RT Dose, which this program does not read. Read it with SimpleITK, multiply its "
      "values by DoseGridScaling (3004,000E), and write a NIfTI or NRRD file. dcm2niix ignores "
      "that factor");
  }
  if (this->Slices.empty())
  {
    throw Failure("cannot read " + folder +
      ": the folder holds no DICOM slices. Folders in it are not searched");
  }
  this->WarnOfLeftOut(messages);
  this->CheckSeries();
}

void Series::Fail(const std::string& reason) const
{
  throw Failure("cannot read the DICOM series in " + this->Folder + ": " + reason + Advice);
}

void Series::AddFile(const std::string& name)
{
  const DICOMFile file(this->Folder + "/" + name);
  if (!file.IsDICOM())
  {
    this->Others.push_back(name);
    return;
  }
  if (!file.IsComplete())
  {
    throw Failure("cannot read " + this->Folder + "/" + name +
      ": it is not complete, and ends within an element");
  }
  if (file.IsDeflated())
  {
    this->Fail(name + " is compressed as a whole (deflated), which this program cannot read");
  }
  if (!file.HasPixels())
  {
    this->WithoutImage.push_back(name);
    return;
  }
  Slice slice;
  slice.Name = name;
  slice.Series = file.GetText(0x0020000E);
  slice.Description = file.GetText(0x0008103E);
  slice.Photometric = file.GetText(0x00280004);
  slice.Size[0] = file.GetShort(0x00280011);
  slice.Size[1] = file.GetShort(0x00280010);
  double frames = 1.0;
  if (file.GetText(0x00080016) == "1.2.840.10008.5.1.4.1.1.481.2")
  {
    this->Doses.push_back(name);
    return;
  }
  if (file.GetNumbers(0x00280008, 1, &frames) && frames != 1.0)
  {
    this->Fail(name + " holds several frames, but each slice must be in a file of its own");
  }
  if (file.HasModalityTable())
  {
    this->Fail(name + " has a table of values (modality LUT, 0028,3000), which is not supported");
  }
  if (slice.Photometric == "MONOCHROME1" && file.GetShort(0x00280101) == 12 &&
    file.GetShort(0x00280103) == 1)
  {
    // GDCM would terminate the program.
    this->Fail(
      name + " has inverted values (MONOCHROME1) of 12 bits with a sign, which cannot be read");
  }
  double orientation[6];
  if (!file.GetNumbers(0x00200032, 3, slice.Position) ||
    !file.GetNumbers(0x00200037, 6, orientation))
  {
    this->Fail(name +
      " does not say where it lies: it has no position (0020,0032) or no orientation (0020,0037)");
  }
  std::copy(orientation, orientation + 3, slice.Row);
  std::copy(orientation + 3, orientation + 6, slice.Column);
  double normal[3];
  vtkMath::Cross(slice.Row, slice.Column, normal);
  if (!(vtkMath::Normalize(slice.Row) > 0.0) || !(vtkMath::Normalize(slice.Column) > 0.0) ||
    !(vtkMath::Norm(normal) > 0.0))
  {
    this->Fail("the orientation (0020,0037) of " + name + " has no two directions");
  }
  double spacing[2];
  if (!file.GetNumbers(0x00280030, 2, spacing) || !(spacing[0] > 0.0) || !(spacing[1] > 0.0))
  {
    this->Fail(name + " has no valid pixel spacing (0028,0030)");
  }
  // The first number is the distance between rows.
  slice.Spacing[0] = spacing[1];
  slice.Spacing[1] = spacing[0];
  this->Slices.push_back(slice);
}

void Series::WarnOfLeftOut(Messages& messages) const
{
  const auto getSuffix = [](const std::string& name)
  { return vtksys::SystemTools::GetFilenameLastExtension(name); };
  std::vector<std::string> names = this->WithoutImage;
  for (const std::string& name : this->Others)
  {
    if (getSuffix(name) == getSuffix(this->First().Name))
    {
      names.push_back(name);
    }
  }
  const auto warn = [&](const char* what, const std::vector<std::string>& which)
  {
    if (!which.empty())
    {
      messages.Warn("Files of " + this->Folder + " that hold " + what +
        " are left out: " + std::to_string(which.size()) + ", such as " + which.front() + ".");
    }
  };
  warn("no DICOM image", names);
  warn("an RT Dose", this->Doses);
}

void Series::CheckSeries() const
{
  std::map<std::string, std::vector<const Slice*>> series;
  for (const Slice& slice : this->Slices)
  {
    series[slice.Series].push_back(&slice);
  }
  if (series.size() == 1)
  {
    return;
  }
  std::string list;
  for (const auto& [number, slices] : series)
  {
    list += (list.empty() ? "" : "; ") + std::to_string(slices.size()) + " slices \"" +
      slices.front()->Description + "\" such as " + slices.front()->Name;
  }
  this->Fail("the folder holds " + std::to_string(series.size()) + " series: " + list +
    ". Move one of them into a folder of its own");
}

void Series::CheckShapes() const
{
  constexpr double tolerance = 1e-4;
  const auto differs = [](const double* a, const double* b)
  { return std::sqrt(vtkMath::Distance2BetweenPoints(a, b)) > tolerance; };
  for (const Slice& slice : this->Slices)
  {
    const std::string both = this->First().Name + " and " + slice.Name;
    for (int axis = 0; axis < 2; ++axis)
    {
      if (slice.Size[axis] != this->First().Size[axis])
      {
        this->Fail("the slices " + both + " differ in size: " + GetSizeText(this->First()) +
          " and " + GetSizeText(slice) + " pixels");
      }
      constexpr double rounding = 1e-6;
      if (std::abs(slice.Spacing[axis] - this->First().Spacing[axis]) >
        rounding * slice.Spacing[axis])
      {
        this->Fail(MakeText(std::setprecision(9), "the slices ", both,
          " differ in the spacing of pixels: ", this->First().Spacing[axis], " and ",
          slice.Spacing[axis], " mm"));
      }
    }
    if (differs(slice.Row, this->First().Row) || differs(slice.Column, this->First().Column))
    {
      this->Fail("the slices " + both + " differ in their orientation (0020,0037)");
    }
  }
}

void Series::GetStep(double step[3]) const
{
  vtkMath::Subtract(this->Last().Position, this->First().Position, step);
  vtkMath::MultiplyScalar(step, 1.0 / static_cast<double>(this->Slices.size() - 1));
}

void Series::CheckSteps() const
{
  std::vector<double> steps;
  for (std::size_t i = 1; i < this->Slices.size(); ++i)
  {
    steps.push_back(this->Slices[i].Along - this->Slices[i - 1].Along);
  }
  // The median is right even if some slices are missing or duplicated.
  std::vector<double> sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  const double least = 1e-3 * this->First().Spacing[0];
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    const std::string both = this->Slices[i].Name + " and " + this->Slices[i + 1].Name;
    if (steps[i] < least)
    {
      this->Fail("the slices " + both +
        " lie at the same place: the series holds slices twice, or several images in time or of "
        "several echoes");
    }
    constexpr double missing = 1.5;
    if (steps[i] > missing * usual)
    {
      this->Fail(MakeText("between the slices ", both, " about ", std::lround(steps[i] / usual) - 1,
        " are missing: they are ", steps[i], " mm apart, and other slices ", usual, " mm"));
    }
  }
}

void Series::CheckPlaces(Messages& messages) const
{
  double step[3];
  this->GetStep(step);
  double farthest = 0.0;
  std::string name;
  for (std::size_t i = 0; i < this->Slices.size(); ++i)
  {
    double even[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      even[axis] = this->First().Position[axis] + static_cast<double>(i) * step[axis];
    }
    const double distance =
      std::sqrt(vtkMath::Distance2BetweenPoints(even, this->Slices[i].Position));
    if (distance > farthest)
    {
      farthest = distance;
      name = this->Slices[i].Name;
    }
  }
  // Positions are often rounded to 0.01 mm or 0.1 mm.
  constexpr double rounding = 0.01;
  constexpr double most = 0.1;
  const std::string text = MakeText(name, " lies ", farthest,
    " mm from where it would lie in evenly spaced slices, which are ", vtkMath::Norm(step),
    " mm apart");
  if (farthest > most * vtkMath::Norm(step))
  {
    this->Fail("its slices are unevenly spaced: " + text);
  }
  if (farthest > rounding * vtkMath::Norm(step))
  {
    messages.Warn("The slices in " + this->Folder +
      " are not quite evenly spaced, but are read as if they were: " + text + ".");
  }
}

void Series::Sort(Messages& messages)
{
  this->CheckShapes();
  if (this->Slices.size() < 2)
  {
    this->Fail("it has one slice, " + this->First().Name + ", and a volume needs two");
  }
  double normal[3];
  vtkMath::Cross(this->First().Row, this->First().Column, normal);
  for (Slice& slice : this->Slices)
  {
    slice.Along = vtkMath::Dot(slice.Position, normal);
  }
  std::sort(this->Slices.begin(), this->Slices.end(),
    [](const Slice& a, const Slice& b) { return a.Along < b.Along; });
  this->CheckSteps();
  this->CheckPlaces(messages);
  if (this->First().Photometric == "MONOCHROME1")
  {
    messages.Warn("The values of the slices in " + this->Folder +
      " are inverted, because large values are dark in these files (MONOCHROME1).");
  }
}

vtkSmartPointer<vtkDataArray> Series::ReadSlice(const Slice& slice) const
{
  const auto reader = itk::GDCMImageIO::New();
  ReadHeader(reader, this->Folder + "/" + slice.Name, "its image cannot be decoded");
  std::string complaints; // not used: GDCM also warns of files that it reads correctly
  return ReadValues(reader, complaints);
}

vtkSmartPointer<vtkImageData> Series::Read(bool showProgress) const
{
  const auto depth = static_cast<int>(this->Slices.size());
  double step[3];
  this->GetStep(step);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(this->First().Size[0], this->First().Size[1], depth);
  image->SetSpacing(this->First().Spacing[0], this->First().Spacing[1], vtkMath::Norm(step));
  const vtkIdType count = image->GetNumberOfPoints() / depth;
  const vtkNew<vtkTrivialProducer> progress;
  const ProgressBar bar(progress, "reading", showProgress);
  vtkSmartPointer<vtkDataArray> all;
  for (int i = 0; i < depth; ++i)
  {
    const vtkSmartPointer<vtkDataArray> values = this->ReadSlice(this->Slices[i]);
    const int components = values->GetNumberOfComponents();
    if (values->GetNumberOfTuples() != count || (all && all->GetNumberOfComponents() != components))
    {
      this->Fail("the image of " + this->Slices[i].Name + " has " +
        std::to_string(values->GetNumberOfTuples()) + " pixels of " + std::to_string(components) +
        " components, but " + std::to_string(count) + " pixels of " +
        std::to_string(all ? all->GetNumberOfComponents() : components) +
        " components are expected");
    }
    if (!all || (all->GetDataType() != values->GetDataType() && all->GetDataType() != VTK_DOUBLE))
    {
      // Slices can have different rescale slopes, as in PET, and then different types.
      const auto wider = vtkSmartPointer<vtkDataArray>::Take(
        all ? vtkDataArray::CreateDataArray(VTK_DOUBLE) : values->NewInstance());
      wider->SetNumberOfComponents(components);
      wider->SetNumberOfTuples(count * depth);
      if (all)
      {
        wider->InsertTuples(0, count * i, 0, all);
      }
      all = wider;
    }
    all->InsertTuples(i * count, count, 0, values);
    progress->UpdateProgress((i + 1.0) / depth);
  }
  all->SetName("DICOMImage");
  image->GetPointData()->SetScalars(all);
  return image;
}

void Series::GetPlace(vtkMatrix4x4* place) const
{
  double step[3];
  this->GetStep(step);
  vtkMath::Normalize(step);
  for (int i = 0; i < 3; ++i)
  {
    place->SetElement(i, 0, this->First().Row[i]);
    place->SetElement(i, 1, this->First().Column[i]);
    place->SetElement(i, 2, step[i]);
    place->SetElement(i, 3, this->First().Position[i]);
  }
}
}

Volume ReadDICOM(
  const std::string& folder, const ReadingOptions& options, Messages& messages, bool showProgress)
{
  Series series(folder, messages);
  series.Sort(messages);
  vtkNew<vtkMatrix4x4> place;
  if (!options.FileCoordinates)
  {
    series.GetPlace(place);
  }
  Volume volume;
  volume.Image = series.Read(showProgress);
  SetAxes(volume.Image, place, folder, messages);
  volume.Axes = options.FileCoordinates ? WorldAxes::Unknown : WorldAxes::LeftPosteriorSuperior;
  return volume;
}
