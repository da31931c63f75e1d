// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNRRDReading_h
#define DeformVolumeNRRDReading_h

#include "Volume.h"
#include "VolumeReading.h"

#include <string>

class Messages;

/// Reads an NRRD file (.nrrd, .nhdr): all types and encodings that ITK's library NrrdIO reads; the
/// components of a vector, or frames (the kinds list and time), on any axis. The world is that of
/// the header's space where it is right or left, anterior or posterior, superior; all but
/// right-anterior-superior become left-posterior-superior, vectors with their MeasurementFrame.
/// Volume::Fields has the keys of the header. Throws a Failure.
Volume ReadNRRD(const std::string& path, const ReadingOptions& options, Messages& messages);

#endif
