// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaterialPresets_h
#define DeformVolumeMaterialPresets_h

#include "ElasticBody.h"

namespace deformvolume
{

/// The material of a tissue at small strains.
struct MaterialPreset
{
  /// vtkElasticDeformation::MaterialPresetType
  int Number;
  const char* Name;
  ElasticMaterial Material;
  /// Authors and year of the Young modulus.
  const char* Source;
};

/// The preset with a number; null for CUSTOM, and if there is no such preset.
const MaterialPreset* FindMaterialPreset(int number);

} // namespace deformvolume

#endif
