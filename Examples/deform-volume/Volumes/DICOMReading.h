// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDICOMReading_h
#define DeformVolumeDICOMReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads one DICOM series from a folder with one file for each slice, in the world coordinates
/// left, posterior, superior. Values are rescaled (CT: HU). Slices are sorted by their positions
/// along their normal, from which the spacing is computed. Throws a Failure that names the files if
/// the folder holds several series, if slices have different sizes or orientations or no position,
/// or if slices are missing, duplicated, unevenly spaced or shifted by gantry tilt.
Volume ReadDICOM(
  const std::string& folder, const ReadingOptions& options, Messages& messages, bool showProgress);

#endif
