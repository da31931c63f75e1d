// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNIfTIReading_h
#define DeformVolumeNIfTIReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads a NIfTI file (.nii, .nii.gz; version 1 or 2): values times slope plus intercept, lengths
/// in mm, at the place of its s-form, else of its q-form, else at origin 0 with unknown axes of the
/// world. Whole numbers stay whole numbers if slope and intercept are. Throws a Failure where the
/// file cannot be read, the axes are sheared, or a file of several frames is read without
/// ReadingOptions::Frame.
Volume ReadNIfTI(
  const std::string& path, const ReadingOptions& options, Messages& messages, bool showProgress);

#endif
