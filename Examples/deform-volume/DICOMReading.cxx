// SPDX-License-Identifier: BSD-3-Clause
// ITK reads each slice. Its own way to put slices together checks no positions.
#include "DICOMReading.h"

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
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

namespace
{
const char* const Advice =
  ". dcm2niix, or 3D Slicer, converts such series into a NIfTI or NRRD file";

struct Slice
{
  std::string Name;
  std::string Path;
  std::string Series;
  std::string Description;
  itk::GDCMImageIO::Pointer Reader;
  double Row[3];    // of unit length, towards the next column
  double Column[3]; // towards the next row
  double Position[3];
  double Along = 0.0; // the position on the normal
};

// The numbers of an element with a backslash between them; fewer than count where it is empty.
bool GetNumbers(
  const std::map<std::string, std::string>& texts, const char* tag, int count, double* numbers)
{
  const auto found = texts.find(tag);
  std::istringstream text(found == texts.end() ? "" : found->second);
  std::string part;
  int read = 0;
  for (; read < count && std::getline(text, part, '\\'); ++read)
  {
    std::istringstream number(part);
    if (!(number >> numbers[read]) || !std::isfinite(numbers[read]))
    {
      return false;
    }
  }
  return read == count;
}

class Series
{
public:
  Series(const std::string& folder, Messages& messages);

  // All checks of positions; afterwards slices are in the order of the volume.
  void Sort();
  vtkSmartPointer<vtkImageData> Read(bool showProgress);
  // Directions and the position of the first voxel.
  void GetPlace(vtkMatrix4x4* place) const;

private:
  [[noreturn]] void Fail(const std::string& reason) const;
  void AddFile(const std::string& name);
  void CheckSeries() const;
  void CheckShapes() const;
  void CheckSteps() const;
  void CheckTilt() const;

  const Slice& First() const { return this->Slices.front(); }
  const Slice& Last() const { return this->Slices.back(); }
  // From one slice to the next.
  double GetStep() const;

  std::string Folder;
  std::vector<Slice> Slices;
  std::vector<std::string> Unread;
  double Normal[3];
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
    if (!vtksys::SystemTools::FileIsDirectory(folder + "/" + name))
    {
      this->AddFile(name);
    }
  }
  if (this->Slices.empty())
  {
    throw Failure("cannot read " + folder + ": the folder holds no DICOM slices" +
      (this->Unread.empty() ? "" : " that can be read. The first file: " + this->Unread.front()));
  }
  if (!this->Unread.empty())
  {
    messages.DisplayWarningText((std::to_string(this->Unread.size()) + " DICOM files of " + folder +
      " hold no image that can be read, and are left out. The first: " + this->Unread.front())
                                  .c_str());
  }
  this->CheckSeries();
}

void Series::Fail(const std::string& reason) const
{
  throw Failure("cannot read the DICOM series in " + this->Folder + ": " + reason + Advice);
}

void Series::AddFile(const std::string& name)
{
  Slice slice;
  slice.Name = name;
  slice.Path = this->Folder + "/" + name;
  slice.Reader = itk::GDCMImageIO::New();
  if (!slice.Reader->CanReadFile(slice.Path.c_str()))
  {
    return;
  }
  try
  {
    ReadHeader(slice.Reader, slice.Path);
  }
  catch (const Failure& failure)
  {
    this->Unread.emplace_back(failure.what());
    return;
  }
  const std::map<std::string, std::string> texts = GetTexts(slice.Reader);
  const auto get = [&](const char* tag)
  {
    const auto found = texts.find(tag);
    return found == texts.end() ? std::string() : found->second;
  };
  slice.Series = get("0020|000e");
  slice.Description = get("0008|103e");
  if (slice.Reader->GetNumberOfDimensions() > 2 && slice.Reader->GetDimensions(2) > 1)
  {
    this->Fail(name + " holds " + std::to_string(slice.Reader->GetDimensions(2)) +
      " frames, where each slice is expected in a file of its own");
  }
  double orientation[6];
  if (!GetNumbers(texts, "0020|0032", 3, slice.Position) ||
    !GetNumbers(texts, "0020|0037", 6, orientation))
  {
    this->Fail(name +
      " does not say where it lies: it has no position (0020,0032) or no "
      "orientation (0020,0037)");
  }
  std::copy(orientation, orientation + 3, slice.Row);
  std::copy(orientation + 3, orientation + 6, slice.Column);
  if (!(vtkMath::Normalize(slice.Row) > 0.0) || !(vtkMath::Normalize(slice.Column) > 0.0))
  {
    this->Fail(name + " has the orientation (0020,0037) 0");
  }
  this->Slices.push_back(slice);
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
      if (slice.Reader->GetDimensions(axis) != this->First().Reader->GetDimensions(axis) ||
        slice.Reader->GetNumberOfComponents() != this->First().Reader->GetNumberOfComponents())
      {
        this->Fail("the slices " + both + " differ in size");
      }
      if (std::abs(slice.Reader->GetSpacing(axis) - this->First().Reader->GetSpacing(axis)) >
        tolerance)
      {
        this->Fail("the slices " + both + " differ in the spacing of pixels");
      }
    }
    if (differs(slice.Row, this->First().Row) || differs(slice.Column, this->First().Column))
    {
      this->Fail("the slices " + both + " differ in their orientation (0020,0037)");
    }
  }
}

double Series::GetStep() const
{
  const auto steps = static_cast<double>(this->Slices.size() - 1);
  return steps > 0.0 ? (this->Last().Along - this->First().Along) / steps : 1.0;
}

void Series::CheckSteps() const
{
  // The usual step: what most slices have, whatever is missing or doubled.
  std::vector<double> steps;
  for (std::size_t i = 1; i < this->Slices.size(); ++i)
  {
    steps.push_back(this->Slices[i].Along - this->Slices[i - 1].Along);
  }
  std::vector<double> sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted.empty() ? 1.0 : sorted[sorted.size() / 2];
  constexpr double least = 1e-3;
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    const std::string both = this->Slices[i].Name + " and " + this->Slices[i + 1].Name;
    std::ostringstream text;
    if (steps[i] < least)
    {
      text << "the slices " << both
           << " lie at the same place: the series holds slices twice, or several images in time or "
              "of several echoes";
      this->Fail(text.str());
    }
    constexpr double missing = 1.5;
    if (steps[i] > missing * usual)
    {
      text << "between the slices " << both << " about " << std::lround(steps[i] / usual) - 1
           << " are missing: they are " << steps[i] << " mm apart, and others " << usual;
      this->Fail(text.str());
    }
  }
  // Positions are often rounded, to a hundredth of a millimetre or a tenth.
  constexpr double tolerance = 0.1;
  const double step = this->GetStep();
  for (std::size_t i = 0; i < this->Slices.size(); ++i)
  {
    const double place = this->First().Along + static_cast<double>(i) * step;
    if (std::abs(this->Slices[i].Along - place) > tolerance * step)
    {
      std::ostringstream text;
      text << "its slices are unevenly spaced, by " << sorted.front() << " to " << sorted.back()
           << " mm; " << this->Slices[i].Name << " lies " << std::abs(this->Slices[i].Along - place)
           << " mm from where even slices would lie";
      this->Fail(text.str());
    }
  }
}

void Series::CheckTilt() const
{
  // As SetAxes takes it.
  constexpr double tolerance = 1e-3;
  for (const Slice& slice : this->Slices)
  {
    double shift[3];
    vtkMath::Subtract(slice.Position, this->First().Position, shift);
    const double along = vtkMath::Dot(shift, this->Normal);
    const double aside =
      std::hypot(vtkMath::Dot(shift, slice.Row), vtkMath::Dot(shift, slice.Column));
    if (aside > tolerance * std::max(along, this->GetStep()))
    {
      std::ostringstream text;
      text << "the slice " << slice.Name << " is shifted by " << aside
           << " mm along its plane against " << this->First().Name << ", by "
           << vtkMath::DegreesFromRadians(std::atan2(aside, along))
           << " degrees (gantry tilt): its axes are not perpendicular";
      this->Fail(text.str());
    }
  }
}

void Series::Sort()
{
  this->CheckShapes();
  vtkMath::Cross(this->First().Row, this->First().Column, this->Normal);
  constexpr double tolerance = 1e-3;
  if (std::abs(vtkMath::Normalize(this->Normal) - 1.0) > tolerance)
  {
    this->Fail("rows and columns of " + this->First().Name + " are not perpendicular");
  }
  for (Slice& slice : this->Slices)
  {
    slice.Along = vtkMath::Dot(slice.Position, this->Normal);
  }
  std::sort(this->Slices.begin(), this->Slices.end(),
    [](const Slice& a, const Slice& b) { return a.Along < b.Along; });
  this->CheckSteps();
  this->CheckTilt();
}

vtkSmartPointer<vtkImageData> Series::Read(bool showProgress)
{
  const auto width = static_cast<int>(this->First().Reader->GetDimensions(0));
  const auto height = static_cast<int>(this->First().Reader->GetDimensions(1));
  const auto depth = static_cast<int>(this->Slices.size());
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(width, height, depth);
  image->SetSpacing(
    this->First().Reader->GetSpacing(0), this->First().Reader->GetSpacing(1), this->GetStep());
  vtkSmartPointer<vtkDataArray> all;
  const vtkIdType count = static_cast<vtkIdType>(width) * height;
  const vtkNew<vtkTrivialProducer> progress;
  const ProgressBar bar(progress, "reading", showProgress);
  for (int i = 0; i < depth; ++i)
  {
    Slice& slice = this->Slices[i];
    const vtkSmartPointer<vtkDataArray> values = ReadValues(slice.Reader);
    slice.Reader = nullptr; // and what it keeps of the file
    if (!all || all->GetDataType() != values->GetDataType())
    {
      // Each slice may be rescaled on its own, as in PET, and then have a type of its own.
      const auto wider = vtkSmartPointer<vtkDataArray>::Take(
        all ? vtkDataArray::CreateDataArray(VTK_DOUBLE) : values->NewInstance());
      if (!all || all->GetDataType() != VTK_DOUBLE)
      {
        wider->SetNumberOfComponents(values->GetNumberOfComponents());
        wider->SetNumberOfTuples(count * depth);
        if (all)
        {
          wider->InsertTuples(0, count * i, 0, all);
        }
        all = wider;
      }
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
  for (int i = 0; i < 3; ++i)
  {
    place->SetElement(i, 0, this->First().Row[i]);
    place->SetElement(i, 1, this->First().Column[i]);
    place->SetElement(i, 2, this->Normal[i]);
    place->SetElement(i, 3, this->First().Position[i]);
  }
}
}

Volume ReadDICOM(
  const std::string& folder, const ReadingOptions& options, Messages& messages, bool showProgress)
{
  Series series(folder, messages);
  series.Sort();
  Volume volume;
  volume.Image = series.Read(showProgress);
  if (!options.FileCoordinates)
  {
    vtkNew<vtkMatrix4x4> place;
    series.GetPlace(place);
    SetAxes(volume.Image, place, folder, messages);
    volume.Axes = WorldAxes::LeftPosteriorSuperior;
  }
  return volume;
}
