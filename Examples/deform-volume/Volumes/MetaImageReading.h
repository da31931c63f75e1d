// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMetaImageReading_h
#define DeformVolumeMetaImageReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads a MetaImage (.mha, .mhd): all types and encodings that ITK reads, in a world left,
/// posterior, superior. Throws a Failure.
Volume ReadMetaImage(const std::string& path, const ReadingOptions& options, Messages& messages);

#endif
