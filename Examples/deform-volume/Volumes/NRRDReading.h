// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNRRDReading_h
#define DeformVolumeNRRDReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads an NRRD file (.nrrd, .nhdr) of all types and encodings that ITK's library NrrdIO reads.
/// Any axis can hold the components of vectors, or frames (the kinds list and time). The space
/// right-anterior-superior is kept. Left-posterior-superior and left-anterior-superior become
/// left-posterior-superior, including Volume::MeasurementFrame. The world axes of other spaces are
/// unknown. Sets Volume::Fields to the keys of the header. Throws a Failure if the file cannot be
/// read.
Volume ReadNRRD(const std::string& path, const ReadingOptions& options, Messages& messages);

#endif
