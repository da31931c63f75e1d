// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeWriting_h
#define DeformVolumeVolumeWriting_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// The file extensions that WriteVolume accepts.
inline constexpr const char* WrittenFormats = HasITK
  ? ".vti, .nii, .nii.gz, .mhd, .mha, .nrrd or .nhdr"
  : ".vti, .nii or .nii.gz: this program was built without ITK";

/// The file extensions of formats that hold one array.
inline constexpr const char* FormatsOfOneArray =
  HasITK ? ".nii, .nii.gz, .mhd, .mha, .nrrd or .nhdr" : ".nii or .nii.gz";

/// Whether a file name has an extension that WriteVolume accepts.
bool CanWriteVolume(const std::string& path);

/// Writes a volume. A .vti file holds all arrays, other formats only the scalars. All formats keep
/// direction, origin and the position of the first voxel, even if the extent does not start at 0.
/// If the world axes of the volume are known, they are converted to those of the format. Throws a
/// Failure if the file cannot be written.
void WriteVolume(
  const Volume& volume, const std::string& path, Messages& messages, bool showProgress);

#endif
