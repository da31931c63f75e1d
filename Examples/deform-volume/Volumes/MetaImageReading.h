// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMetaImageReading_h
#define DeformVolumeMetaImageReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads a MetaImage (.mha, .mhd) of all types and encodings that ITK reads, in the world
/// coordinates left, posterior, superior. Throws a Failure if the file cannot be read.
Volume ReadMetaImage(const std::string& path, const ReadingOptions& options, Messages& messages);

#endif
