// SPDX-License-Identifier: BSD-3-Clause
// Checks after an update of a pipeline.
#include "Pipeline.h"

#include "Comparison.h"

#include <vtkPointData.h>

#include <algorithm>

namespace fuzz
{

namespace
{

// Whether two errors are equal, apart from the numbers in errors about memory. These differ because
// the size of a static mapping is estimated before it is built, and because the available memory
// of the system varies.
bool AreAlike(const std::string& first, const std::string& second)
{
  const auto withoutBytes = [](std::string words)
  {
    if (words.find("Not enough memory") != std::string::npos)
    {
      const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
      words.erase(std::remove_if(words.begin(), words.end(), isDigit), words.end());
    }
    return words;
  };
  return withoutBytes(first) == withoutBytes(second);
}

} // namespace

// Updates a copy of the output within GetChangedExtent(), as viewers do, and compares.
std::string Pipeline::CheckChangedExtent(vtkImageData* output)
{
  const int* changed = this->Tested.GetFilter()->GetChangedExtent();
  const int* extent = output->GetExtent();
  if (std::equal(changed, changed + 6, extent))
  {
    this->Shown = vtkSmartPointer<vtkImageData>::New();
    this->Shown->DeepCopy(output);
    return "";
  }
  if (!this->Shown || !std::equal(extent, extent + 6, this->Shown->GetExtent()))
  {
    return "GetChangedExtent() is a part of the output, but the extent of the output has changed";
  }
  vtkPointData* arrays = this->Shown->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* from = output->GetPointData()->GetArray(i);
    for (int z = changed[4]; z <= changed[5] && from; ++z)
    {
      for (int y = changed[2]; y <= changed[3]; ++y)
      {
        int first[3] = { changed[0], y, z };
        const vtkIdType begin = output->ComputePointId(first);
        arrays->GetArray(i)->InsertTuples(begin, changed[1] - changed[0] + 1, begin, from);
      }
    }
  }
  const std::string wrong = CompareBits(output, this->Shown);
  return wrong.empty() ? "" : "outside GetChangedExtent(): " + wrong;
}

void Pipeline::CountLive(const Outcome& tested)
{
  const auto count = [](vtkDataObject* data)
  {
    return vtkUnstructuredGrid::SafeDownCast(data) ? data->GetNumberOfElements(vtkDataObject::POINT)
                                                   : 0;
  };
  ++this->Live.All;
  this->Live.Parts += tested.IsPart;
  this->Live.FoldedParts += tested.IsPart && tested.Inverted > 0;
  this->Live.SplitParts += tested.IsPart && count(this->Deformation) > count(this->Before.front());
}

std::string Pipeline::CheckError(const Outcome& tested, const Outcome& fresh)
{
  ++this->Errors;
  this->Shown = nullptr;
  if (fresh.Errors.size() != 1 || fresh.Errors[0].size() < 20)
  {
    return "expected one error of a fresh filter, with at least 20 characters, instead of " +
      std::to_string(fresh.Errors.size()) + ", the last \"" +
      (fresh.Errors.empty() ? "" : fresh.Errors.back()) +
      "\". The last error of the edited filter: " +
      (tested.Errors.empty() ? "none" : tested.Errors.back());
  }
  if (tested.Errors.size() != 1 || !AreAlike(tested.Errors[0], fresh.Errors[0]))
  {
    return "expected one error, that of a fresh filter, \"" + fresh.Errors[0] + "\", instead of " +
      std::to_string(tested.Errors.size()) + ", the last \"" +
      (tested.Errors.empty() ? "" : tested.Errors.back()) + "\"";
  }
  this->Log << "  error: " << fresh.Errors[0] << '\n';
  for (const Outcome* outcome : { &tested, &fresh })
  {
    if (outcome->Output->GetNumberOfPoints() != 0 ||
      outcome->Output->GetPointData()->GetNumberOfArrays() != 0)
    {
      return "expected an empty output after the error instead of " +
        std::to_string(outcome->Output->GetNumberOfPoints()) + " points and " +
        std::to_string(outcome->Output->GetPointData()->GetNumberOfArrays()) + " arrays";
    }
  }
  return "";
}

std::string Pipeline::CheckOutput(const Outcome& tested, const Outcome& fresh, bool divided)
{
  ++this->Outputs;
  const std::string outside = this->CheckChangedExtent(tested.Output);
  if (this->IsLive)
  {
    this->CountLive(tested);
  }
  if (tested.Resampler != fresh.Resampler)
  {
    return "resampler " + std::to_string(tested.Resampler) + " instead of " +
      std::to_string(fresh.Resampler);
  }
  if (!divided &&
    !std::equal(
      tested.Output->GetExtent(), tested.Output->GetExtent() + 6, fresh.Output->GetExtent()))
  {
    return "the extent differs from that of a fresh filter";
  }
  const bool whole = tested.Output->GetNumberOfPoints() == fresh.Output->GetNumberOfPoints();
  if (whole &&
    (tested.Covered != fresh.Covered || tested.Inverted != fresh.Inverted ||
      tested.Flat != fresh.Flat))
  {
    return "covered voxels, inverted and flat tetrahedra: " + std::to_string(tested.Covered) + ' ' +
      std::to_string(tested.Inverted) + ' ' + std::to_string(tested.Flat) + " instead of " +
      std::to_string(fresh.Covered) + ' ' + std::to_string(fresh.Inverted) + ' ' +
      std::to_string(fresh.Flat);
  }
  std::string wrong = CompareBits(tested.Output, fresh.Output);
  wrong = wrong.empty() ? outside : wrong;
  // In large volumes this check takes longer than all other ones.
  if (wrong.empty() && fresh.Output->GetNumberOfPoints() > 0 &&
    (!this->IsLive || this->Random.Chance(0.1)))
  {
    wrong = CheckValues(fresh.Output, this->Volume, this->Settings);
  }
  if (wrong.empty() && this->Geometry == fuzz::Geometry::Exact && !this->Settings.FieldIsInverse &&
    this->Settings.SamplingFactor == 1 && fresh.Resampler == vtkDeformVolumeFilter::EXACT &&
    fresh.Output->GetNumberOfPoints() > 0)
  {
    const std::optional<std::string> found = CompareWithReference(fresh.Output, this->Volume,
      vtkDataSet::SafeDownCast(this->Deformation), this->Settings, fresh.Inverted);
    this->References += found.has_value();
    wrong = found.value_or("");
  }
  return wrong;
}

std::string Pipeline::Check()
{
  const double* time = this->VariesInTime ? &this->Time : nullptr;
  Subject other;
  fuzz::Settings settings = this->Settings;
  settings.Incremental = settings.Incremental && this->Random.Chance(0.5);
  Apply(settings, other.GetFilter());
  // A mesh that contains no voxel of the volume is an error only if the whole volume is read. So
  // both filters have to read the same part.
  const bool streamed =
    this->VolumeInParts && this->Settings.OutputBoundsMode == vtkDeformVolumeFilter::CUSTOM_BOUNDS;
  this->Connect(other, this->Random.Chance(0.3) && !streamed);
  Outcome fresh = other.Update(nullptr, time);

  // Update the whole output or a part of it. Sometimes another image shares its arrays.
  vtkNew<vtkImageData> held;
  vtkNew<vtkImageData> before;
  if (this->Random.Chance(0.3))
  {
    held->ShallowCopy(this->Tested.GetFilter()->GetOutput());
    before->DeepCopy(held);
  }
  else if (vtkDataArray* values = this->IsLive && this->Random.Chance(0.1)
      ? this->Tested.GetFilter()->GetOutput()->GetPointData()->GetArray(0)
      : nullptr)
  {
    this->Log << "another program writes to the output\n";
    values->Fill(1.0);
    values->Modified();
    this->Tested.GetFilter()->Modified(); // so that the filter writes the output again
  }
  int part[6];
  fresh.Output->GetExtent(part);
  const bool divided =
    fresh.Output->GetNumberOfPoints() > 0 && this->Random.Chance(this->IsLive ? 0.04 : 0.15);
  for (int axis = 0; axis < 3 && divided; ++axis)
  {
    part[2 * axis] = this->Random.Int(part[2 * axis], part[2 * axis + 1]);
    part[2 * axis + 1] = this->Random.Int(part[2 * axis], part[2 * axis + 1]);
  }
  this->Log << "update" << (divided ? " of a part" : "") << '\n';
  const Outcome tested = this->Tested.Update(divided ? part : nullptr, time);
  if (held->GetNumberOfPoints() > 0 && !CompareBits(held, before).empty())
  {
    return "the update has changed an image that shares the arrays of the last output";
  }
  // A filter that has read a smooth cut in a part of the volume requests the whole volume after
  // that.
  if (tested.Errors.empty() && tested.Output->GetNumberOfPoints() > 0 && !fresh.Errors.empty() &&
    fresh.Errors[0].find("from the next update on, the whole volume") != std::string::npos)
  {
    other.GetFilter()->Modified();
    fresh = other.Update(nullptr, time);
  }
  return fresh.Errors.empty() && tested.Errors.empty() ? this->CheckOutput(tested, fresh, divided)
                                                       : this->CheckError(tested, fresh);
}

} // namespace fuzz
