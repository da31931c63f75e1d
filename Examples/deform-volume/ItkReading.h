// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeItkReading_h
#define DeformVolumeItkReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads a MetaImage (.mha, .mhd): all types and encodings that ITK reads, in a world left,
/// posterior, superior. Fields has what the header says besides. Throws a Failure.
Volume ReadMetaImage(const std::string& path, const ReadingOptions& options, Messages& messages);

/// Reads an NRRD file (.nrrd, .nhdr): all types and encodings that ITK reads; the components of a
/// vector on any axis. The world is that of the header's space where it is right or left, anterior
/// or posterior, superior; all but right-anterior-superior become left-posterior-superior, vectors
/// with their MeasurementFrame. Throws a Failure.
Volume ReadNRRD(const std::string& path, const ReadingOptions& options, Messages& messages);

#endif
