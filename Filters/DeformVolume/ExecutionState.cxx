// SPDX-License-Identifier: BSD-3-Clause
#include "ExecutionState.h"

namespace deformvolume
{

void ExecutionState::Release()
{
  this->Device.ReleaseMemory();
  this->Outputs.Forget();
  this->Extra.Forget();
  this->Mapping.ReleaseVoxels();
  this->Volume.Forget();
  this->ArraysInUse.clear();
}

void ExecutionState::ForgetValues()
{
  this->Device.ForgetValues();
  this->Extra.Forget();
  this->Volume.Forget();
}

bool ExecutionState::BoundsKey::operator==(const BoundsKey& other) const
{
  return this->Inputs == other.Inputs && this->Volume == other.Volume &&
    this->ToOutput == other.ToOutput && this->DisplacementScale == other.DisplacementScale &&
    this->Choice == other.Choice && this->OutsideMode == other.OutsideMode &&
    this->FadeDistance == other.FadeDistance;
}

bool ExecutionState::ExtentKey::operator==(const ExtentKey& other) const
{
  return this->Settings == other.Settings && this->Padding == other.Padding &&
    this->Granularity == other.Granularity;
}

bool ExecutionState::RegionsKey::operator==(const RegionsKey& other) const
{
  return this->ShapeVersion == other.ShapeVersion && this->VectorsVersion == other.VectorsVersion &&
    this->Volume == other.Volume && this->ToOutput == other.ToOutput &&
    this->Outside == other.Outside;
}

bool ExecutionState::Share::operator==(const Share& other) const
{
  return this->Asked == other.Asked && this->Piece == other.Piece && this->Pieces == other.Pieces &&
    this->Volume == other.Volume;
}

} // namespace deformvolume
