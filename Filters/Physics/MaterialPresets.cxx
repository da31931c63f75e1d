// SPDX-License-Identifier: BSD-3-Clause
#include "MaterialPresets.h"

#include "vtkElasticDeformation.h"

#include <algorithm>
#include <iterator>

namespace deformvolume
{

namespace
{

using Filter = vtkElasticDeformation;

// Documents/physics.md describes the measurements of each source, and a test compares the numbers.
// Young moduli are in Pa. Densities are in kg/m^3, from ICRU Report 46 (1992). The Poisson ratio of
// soft tissue was not measured but chosen, because soft tissue is nearly incompressible.
constexpr MaterialPreset Presets[] = {
  { Filter::BRAIN, "Brain", { 1600.0, 0.49, 1040.0 }, "Budday et al. 2015" },
  { Filter::LIVER, "Liver", { 5500.0, 0.49, 1060.0 }, "Roulot et al. 2008" },
  { Filter::FAT, "Fat", { 3250.0, 0.49, 950.0 }, "Samani et al. 2007" },
  { Filter::MUSCLE, "Muscle", { 11100.0, 0.49, 1050.0 }, "Arda et al. 2011" },
  { Filter::SKIN, "Skin", { 420e3, 0.49, 1090.0 }, "Agache et al. 1980" },
  { Filter::CARTILAGE, "Cartilage", { 450e3, 0.46, 1100.0 }, "Jin and Lewis 2004" },
  { Filter::BONE, "Bone", { 18.6e9, 0.3, 1920.0 }, "Rho et al. 1993" },
};

} // namespace

const MaterialPreset* FindMaterialPreset(int number)
{
  const auto* found = std::find_if(std::begin(Presets), std::end(Presets),
    [&](const MaterialPreset& preset) { return preset.Number == number; });
  return found == std::end(Presets) ? nullptr : found;
}

} // namespace deformvolume
