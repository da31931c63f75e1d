// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNIfTIReading_h
#define DeformVolumeNIfTIReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads a NIfTI file (.nii, .nii.gz; version 1 or 2): values times slope plus intercept, lengths
/// in mm. The s-form, or else the q-form, gives direction and origin. Without both, the origin is 0
/// and the world axes are unknown. Integers stay integers if slope and intercept are integers.
/// Throws a Failure if the file cannot be read, if its axes are sheared, or if it has several
/// frames and ReadingOptions::Frame is not set.
Volume ReadNIfTI(
  const std::string& path, const ReadingOptions& options, Messages& messages, bool showProgress);

#endif
