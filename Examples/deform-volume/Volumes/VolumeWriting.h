// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeWriting_h
#define DeformVolumeVolumeWriting_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// How names end that WriteVolume accepts.
inline constexpr const char* WrittenFormats = HasITK
  ? ".vti, .nii, .nii.gz, .mhd, .mha, .nrrd or .nhdr"
  : ".vti, .nii or .nii.gz: this program was built without ITK";

/// Of these, those of one array.
inline constexpr const char* FormatsOfOneArray =
  HasITK ? ".nii, .nii.gz, .mhd, .mha, .nrrd or .nhdr" : ".nii or .nii.gz";

/// Whether a name ends so.
bool CanWriteVolume(const std::string& path);

/// Writes a volume. A .vti file keeps all arrays, the others the scalars alone. Origin, direction
/// and the place of an extent that does not start at 0 survive in all formats; axes of the world
/// are turned to the format's own where the volume's are known. Throws a Failure where that fails.
void WriteVolume(
  const Volume& volume, const std::string& path, Messages& messages, bool showProgress);

#endif
