// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeReading_h
#define DeformVolumeVolumeReading_h

#include "Volume.h"

#include <string>

class Messages;

/// Reads a volume: .nii, .nii.gz, .mhd, .mha, .nrrd, .nhdr, .vti, or a folder with the slices of
/// one DICOM series. VTK's readers give all but .vti files no direction, and NIfTI files and DICOM
/// series no origin; both are taken from the file here, unless fileCoordinates is set. Of a NIfTI
/// file's two transformations the s-form is preferred if its axes are perpendicular, then the
/// q-form. Throws a Failure where the volume cannot be read.
Volume ReadVolume(
  const std::string& path, bool fileCoordinates, Messages& messages, bool showProgress);

#endif
