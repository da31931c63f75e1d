// SPDX-License-Identifier: BSD-3-Clause
#include "CoarseVolume.h"

#include "Error.h"
#include "FiveTetrahedra.h"
#include "MaskArray.h"
#include "ParallelFor.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstring>

namespace deformvolume
{

namespace
{

// Rounds towards minus infinity.
int DivideDown(int number, int divisor)
{
  return number / divisor - (number % divisor < 0 ? 1 : 0);
}

constexpr unsigned char AllActive = DEFORMVOLUME_ALL_TETRAHEDRA;

// Number of rows along x that a thread takes at a time.
constexpr std::size_t RowStep = 16;

// Calls body(coarsePoint, finePoint) for each row along x of the coarse extent. The arguments are
// the indices of the row's first point in an array of the coarse extent and in one of the fine
// extent.
template <typename Body>
void ForRows(const Extent& coarse, const Extent& fine, int factor, Body&& body)
{
  const std::int64_t rows = GetSize(coarse, 1) * GetSize(coarse, 2);
  ParallelForItems(static_cast<std::size_t>(rows), RowStep,
    [&](std::size_t row)
    {
      const auto number = static_cast<std::int64_t>(row);
      const std::int64_t y = factor * (coarse[2] + number % GetSize(coarse, 1)) - fine[2];
      const std::int64_t z = factor * (coarse[4] + number / GetSize(coarse, 1)) - fine[4];
      const std::int64_t x = std::int64_t{ factor } * coarse[0] - fine[0];
      body(number * GetSize(coarse, 0), (z * GetSize(fine, 1) + y) * GetSize(fine, 0) + x);
    });
}

template <std::size_t Bytes>
void CopyRow(char* to, const char* from, std::int64_t count, int factor)
{
  for (std::int64_t i = 0; i < count; ++i)
  {
    std::memcpy(to + i * Bytes, from + i * factor * Bytes, Bytes);
  }
}

void CopyRow(char* to, const char* from, std::size_t bytes, std::int64_t count, int factor)
{
  switch (bytes)
  {
    case 1:
      return CopyRow<1>(to, from, count, factor);
    case 2:
      return CopyRow<2>(to, from, count, factor);
    case 4:
      return CopyRow<4>(to, from, count, factor);
    case 8:
      return CopyRow<8>(to, from, count, factor);
    case 12: // vectors of floats
      return CopyRow<12>(to, from, count, factor);
    default:
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      {
        std::memcpy(to + i * bytes, from + i * static_cast<std::size_t>(factor) * bytes, bytes);
      }
  }
}

vtkSmartPointer<vtkUnsignedCharArray> MakeMask(const char* name, std::int64_t size)
{
  auto mask = vtkSmartPointer<vtkUnsignedCharArray>::New();
  mask->SetName(name);
  mask->SetNumberOfTuples(size);
  return mask;
}

// Whether all tetrahedra of a box of side * side * side cells are active. first: mask of the first
// of these cells. cells: the extent that the mask covers.
bool IsWhole(const unsigned char* first, const Extent& cells, int side)
{
  bool whole = true;
  for (int z = 0; z < side && whole; ++z)
  {
    for (int y = 0; y < side; ++y)
    {
      const unsigned char* row = first + (z * GetSize(cells, 1) + y) * GetSize(cells, 0);
      whole = whole &&
        std::all_of(row, row + side, [](unsigned char v) { return (v & AllActive) == AllActive; });
    }
  }
  return whole;
}

// The extent of the cells between the points of an extent.
Extent GetCells(Extent points)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    --points[2 * axis + 1];
  }
  return points;
}

// Makes an image of the coarse voxels that has only their masks.
vtkSmartPointer<vtkImageData> MakeMasks(vtkImageData* volume, int factor)
{
  // Coarse cells that a smooth cut crosses are switched off: CutTetrahedra has bits for tetrahedra
  // of the fine cells only.
  VolumeMasks masks = ReadMasks(volume, {});
  SwitchOffCut(masks, static_cast<std::size_t>(volume->GetNumberOfCells()));
  Extent fine;
  volume->GetExtent(fine.data());
  Extent coarse = CoarsenExtent(fine, factor);
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(coarse.data());
  if (masks.Blanked)
  {
    const auto ghosts = MakeMask(vtkDataSetAttributes::GhostArrayName(), GetNumberOfPoints(coarse));
    unsigned char* values = ghosts->GetPointer(0);
    ForRows(coarse, fine, factor,
      [&](std::int64_t first, std::int64_t voxel)
      {
        for (std::int64_t i = 0; i < GetSize(coarse, 0); ++i)
        {
          values[first + i] = masks.Blanked[voxel + i * factor] & masks.BlankedBits
            ? vtkDataSetAttributes::HIDDENPOINT
            : 0;
        }
      });
    image->GetPointData()->AddArray(ghosts);
  }
  if (masks.Distances.Values)
  {
    vtkNew<vtkFloatArray> distances;
    distances->SetName(BoundaryDistanceName);
    distances->SetArray(const_cast<float*>(masks.Distances.Values), volume->GetNumberOfPoints(), 1);
    image->GetPointData()->AddArray(SampleTuples(distances, fine, coarse, factor));
  }
  if (masks.Active)
  {
    const auto active = MakeMask(ActiveTetrahedraName, GetNumberOfCells(coarse));
    unsigned char* values = active->GetPointer(0);
    const Extent fineCells = GetCells(fine);
    const Extent coarseCells = GetCells(coarse);
    ForRows(coarseCells, fineCells, factor,
      [&](std::int64_t first, std::int64_t cell)
      {
        for (std::int64_t i = 0; i < GetSize(coarseCells, 0); ++i)
        {
          values[first + i] =
            IsWhole(masks.Active + cell + i * factor, fineCells, factor) ? AllActive : 0;
        }
      });
    image->GetCellData()->AddArray(active);
  }
  return image;
}

} // namespace

Extent CoarsenExtent(const Extent& voxels, int factor)
{
  Extent coarse;
  for (int axis = 0; axis < 3; ++axis)
  {
    coarse[2 * axis] = -DivideDown(-voxels[2 * axis], factor);
    coarse[2 * axis + 1] = DivideDown(voxels[2 * axis + 1], factor);
  }
  return coarse;
}

ImageGeometry CoarsenExtent(const ImageGeometry& volume, int factor)
{
  ImageGeometry coarse = volume;
  coarse.PointExtent = CoarsenExtent(volume.PointExtent, factor);
  coarse.Spacing *= factor;
  return coarse;
}

Extent RefineExtent(const Extent& coarse, int factor)
{
  Extent fine;
  std::transform(
    coarse.begin(), coarse.end(), fine.begin(), [=](int index) { return index * factor; });
  return fine;
}

vtkSmartPointer<vtkDataArray> SampleTuples(
  vtkDataArray* array, const Extent& fine, const Extent& coarse, int factor)
{
  auto made = MakeArrayLike(array, GetNumberOfPoints(coarse));
  auto* to = static_cast<char*>(GetWritableValues(made));
  VolumeArray copy; // used if the array is not an array of structs
  if (!GetWritableValues(array))
  {
    CopyToAOS(array, copy);
  }
  const auto* from = static_cast<const char*>(copy.Data ? copy.Data : GetWritableValues(array));
  const auto bytes = static_cast<std::size_t>(made->GetDataTypeSize()) *
    static_cast<std::size_t>(made->GetNumberOfComponents());
  ForRows(coarse, fine, factor,
    [&](std::int64_t first, std::int64_t point)
    {
      CopyRow(to + static_cast<std::size_t>(first) * bytes,
        from + static_cast<std::size_t>(point) * bytes, bytes, GetSize(coarse, 0), factor);
    });
  return made;
}

void CheckCoarse(const ImageGeometry& coarse, int factor)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (GetSize(coarse.PointExtent, axis) < 2)
    {
      throw Error("With SamplingFactor " + std::to_string(factor) +
        " fewer than two voxels of the volume on input port 0 are left on axis " + "xyz"[axis] +
        ". Set a smaller SamplingFactor.");
    }
  }
}

void CoarseVolume::Forget()
{
  this->Image = nullptr;
  this->Arrays.clear();
}

vtkImageData* CoarseVolume::Update(
  vtkImageData* volume, int factor, std::vector<SourceArray>& arrays)
{
  if (factor == 1)
  {
    return volume;
  }
  Extent fine;
  volume->GetExtent(fine.data());
  const Stamp arraysStamp = GetStamp(arrays);
  const Stamp masksStamp = GetMasksStamp(volume);
  vtkSmartPointer<vtkImageData> image = this->Image;
  this->Image = nullptr; // stays null if one of the calls below throws
  const bool isNew = !image || this->Voxels != fine;
  if (isNew || this->ArraysStamp != arraysStamp)
  {
    this->CopyArrays(arrays, fine, factor);
    this->ArraysStamp = arraysStamp;
  }
  if (isNew || this->MasksStamp != masksStamp)
  {
    image = MakeMasks(volume, factor);
    this->MasksStamp = masksStamp;
  }
  this->Voxels = fine;
  this->Image = image;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    arrays[i].Array = this->Arrays[i];
  }
  return this->Image;
}

void CoarseVolume::CopyArrays(
  const std::vector<SourceArray>& arrays, const Extent& fine, int factor)
{
  const Extent coarse = CoarsenExtent(fine, factor);
  this->Arrays.clear(); // frees the old copies before new ones are made
  for (const SourceArray& source : arrays)
  {
    this->Arrays.push_back(SampleTuples(source.Array, fine, coarse, factor));
  }
}

} // namespace deformvolume
