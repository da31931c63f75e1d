// SPDX-License-Identifier: BSD-3-Clause
#include "WorldEdits.h"

#include <utility>

namespace deformvolume
{

WorldEdits::WorldEdits(const ImageGeometry& volume)
  : Volume(volume)
  , Vertices(volume.PointExtent)
  , Editor(volume.PointExtent, GetFarDistance(volume.PointExtent, volume.Spacing))
{
}

EditFinder WorldEdits::MakeFinder() const
{
  EditFinder finder;
  finder.Volume = this->Volume;
  finder.GetVertices = [this]() -> const VertexPositions& { return this->Vertices; };
  finder.FarDistance = this->Editor.GetBoundaryDistances().GetFar();
  return finder;
}

void WorldEdits::SetBase(const WorldMasks& base)
{
  this->Editor.SetBase(base.ActiveTetrahedra);
  this->Base = base;
  this->BaseDistancesAreOld = true;
  this->BaseCutIsOld = true;
}

void WorldEdits::Add(VolumeEdit&& edit)
{
  this->Editor.Add(
    std::move(edit.Tetrahedra), std::move(edit.Distances), std::move(edit.Crossings));
}

WorldMasks WorldEdits::GetMasks()
{
  WorldMasks masks = this->Base;
  if (this->GetNumberOfEdits() == 0)
  {
    return masks;
  }
  if (this->Editor.HasSmoothCuts())
  {
    if (this->BaseCutIsOld)
    {
      this->Editor.SetBaseCut(this->Base.CutTetrahedra, this->Base.CutDistances);
      this->BaseCutIsOld = false;
    }
    masks.CutTetrahedra = this->Editor.GetSmoothCrossings().GetCrossed().data();
    masks.CutDistances = this->Editor.GetSmoothCrossings().GetDistances().data();
  }
  if (this->Editor.HasDistanceEdits())
  {
    if (this->BaseDistancesAreOld)
    {
      this->Editor.SetBaseDistances(this->Base.BoundaryDistances);
      this->BaseDistancesAreOld = false;
    }
    masks.BoundaryDistances = this->Editor.GetBoundaryDistances().Get().data();
  }
  masks.ActiveTetrahedra = this->Editor.GetMask().data();
  return masks;
}

} // namespace deformvolume
