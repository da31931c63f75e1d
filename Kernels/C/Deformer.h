// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformer_h
#define DeformVolumeDeformer_h

#include "Structs.h"
#include "WorldDeformer.h"
#include "WorldEdits.h"
#include "deformvolume.h"

#include <memory>
#include <string>

struct dv_deformer
{
  deformvolume::WorldDeformer Deformer;
  deformvolume::ImageGeometry Volume;
  deformvolume::WorldMasks Masks;                  // set by the program, without edits
  std::unique_ptr<deformvolume::WorldEdits> Edits; // null before the first edit
  std::string Device;
  std::string Warnings;
};

namespace deformvolume
{

inline WorldDeformer& GetDeformer(dv_deformer* deformer)
{
  CheckPointer(deformer, "The deformer");
  return deformer->Deformer;
}

/// Throws an Error if the deformer has no volume. what: what needs it.
inline void CheckHasVolume(const dv_deformer& deformer, const char* what)
{
  if (GetNumberOfPoints(deformer.Volume.PointExtent) == 0)
  {
    throw Error(std::string("There is no volume. Set one before ") + what + ".");
  }
}

/// Returns the masks of the deformer, with its edits.
inline WorldMasks GetMasks(const dv_deformer& deformer)
{
  return deformer.Edits ? deformer.Edits->GetMasks() : deformer.Masks;
}

} // namespace deformvolume

#endif
