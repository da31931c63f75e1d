// SPDX-License-Identifier: BSD-3-Clause
// Measures updates after a mask of the volume has appeared or changed. The mesh does not move.
#include "Evaluation.h"

#include <vtkCellData.h>
#include <vtkDataSetAttributes.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace
{

// Number of cells or points of the box on each axis.
constexpr int BoxSize = 20;
constexpr int BallRadius = 20;

// A volume with a mask, and a filter whose output stays on the device, so that only the mask is
// transferred.
struct MaskedVolume
{
  explicit MaskedVolume(bool ofCells)
    : Volume(MakeVolume(BenchmarkVolume))
    , Subject(Volume, CoarseNodes)
    , Attributes(ofCells ? static_cast<vtkDataSetAttributes*>(Volume->GetCellData())
                         : static_cast<vtkDataSetAttributes*>(Volume->GetPointData()))
    , Whole(ofCells ? 31 : 0)
    , Off(ofCells ? 0 : vtkDataSetAttributes::HIDDENPOINT)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      this->Size[axis] = BenchmarkVolume[axis] - (ofCells ? 1 : 0);
    }
    this->Mask->SetName(ofCells ? "ActiveTetrahedra" : vtkDataSetAttributes::GhostArrayName());
    this->Mask->SetNumberOfTuples(
      static_cast<vtkIdType>(this->Size[0]) * this->Size[1] * this->Size[2]);
    this->Mask->FillValue(this->Whole);
    this->Subject.GetFilter()->OutputOnDeviceOn();
    this->Subject.Move(Pose::NearIdentity);
    this->Show(true);
  }

  // Adds the mask to the volume, or removes it.
  void Show(bool masked)
  {
    if (masked)
    {
      this->Attributes->AddArray(this->Mask);
    }
    else
    {
      this->Attributes->RemoveArray(this->Mask->GetName());
    }
    this->Volume->Modified();
  }

  // Sets a mask in which all cells or points are on, except those in a box or a ball. radius: half
  // the width of the box, or the radius. The center is near the middle of the volume, and differs
  // from call to call.
  void SwitchOff(int radius, bool round)
  {
    ++this->Step;
    this->Mask->FillValue(this->Whole);
    unsigned char* values = this->Mask->GetPointer(0);
    const std::array<int, 3> middle{ { this->Size[0] / 2 + this->Step % 20, this->Size[1] / 2,
      this->Size[2] / 2 } };
    for (int z = -radius; z < radius; ++z)
    {
      for (int y = -radius; y < radius; ++y)
      {
        for (int x = -radius; x < radius; ++x)
        {
          if (!round || x * x + y * y + z * z < radius * radius)
          {
            const vtkIdType row =
              static_cast<vtkIdType>(middle[2] + z) * this->Size[1] + middle[1] + y;
            values[row * this->Size[0] + middle[0] + x] = this->Off;
          }
        }
      }
    }
    this->Mask->Modified();
  }

  // Sets a mask in which a random half is off.
  void ScatterNoise()
  {
    auto state = static_cast<std::uint32_t>(++this->Step);
    unsigned char* values = this->Mask->GetPointer(0);
    std::generate(values, values + this->Mask->GetNumberOfValues(),
      [&]
      {
        state = state * 1664525u + 1013904223u;
        return state >> 31 ? this->Whole : this->Off;
      });
    this->Mask->Modified();
  }

  vtkSmartPointer<vtkImageData> Volume;
  BenchmarkCase Subject;
  vtkDataSetAttributes* Attributes;
  unsigned char Whole;
  unsigned char Off;
  std::array<int, 3> Size;
  vtkNew<vtkUnsignedCharArray> Mask;
  int Step = 0;
};

// Returns a contestant that makes a change, which is not measured, and measures the next update.
Contestant<MaskedVolume> MakeChange(
  const std::string& name, const std::function<void(MaskedVolume&)>& change)
{
  return { name,
    [=](MaskedVolume& masked)
    {
      change(masked);
      return MeasureUpdate(masked.Subject);
    } };
}

} // namespace

void RegisterMasks(const EvaluationSize& size)
{
  // Each contestant starts with a ball that is off. This is not measured.
  const auto begin = [](MaskedVolume& masked)
  {
    masked.SwitchOff(BallRadius, true);
    masked.Subject.Update();
  };
  const std::vector<Contestant<MaskedVolume>> changes{
    MakeChange("first",
      [](MaskedVolume& masked)
      {
        masked.Show(false);
        masked.Subject.Update();
        masked.SwitchOff(BallRadius, true);
        masked.Show(true);
      }),
    MakeChange("ball",
      [=](MaskedVolume& masked)
      {
        begin(masked);
        masked.SwitchOff(BallRadius, true);
      }),
    MakeChange("box",
      [=](MaskedVolume& masked)
      {
        begin(masked);
        masked.SwitchOff(BoxSize / 2, false);
      }),
    MakeChange("noise", [](MaskedVolume& masked) { masked.ScatterNoise(); }),
    MakeChange("nothing",
      [=](MaskedVolume& masked)
      {
        begin(masked);
        masked.Mask->Modified();
      }),
  };
  for (const bool ofCells : { true, false })
  {
    RegisterRounds<MaskedVolume>(
      std::string("Masks/") + (ofCells ? "active" : "blanked"), size.GetRounds(),
      [ofCells]()
      {
        auto masked = std::make_shared<MaskedVolume>(ofCells);
        masked->Subject.Update();
        return masked;
      },
      changes);
  }
}
