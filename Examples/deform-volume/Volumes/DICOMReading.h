// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDICOMReading_h
#define DeformVolumeDICOMReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads the slices of one DICOM series in a folder, each a file of its own, in a world left,
/// posterior, superior: rescaled (HU of CT), in the order of their positions along the normal of
/// the slices, with the spacing of these positions. Throws a Failure that names the files where the
/// folder holds several series, slices of several sizes or orientations or without a place, or
/// where slices are missing, doubled, unevenly spaced or shifted by gantry tilt.
Volume ReadDICOM(
  const std::string& folder, const ReadingOptions& options, Messages& messages, bool showProgress);

#endif
