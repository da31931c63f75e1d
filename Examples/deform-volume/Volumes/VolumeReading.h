// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeReading_h
#define DeformVolumeVolumeReading_h

#include "Volume.h"

#include <optional>
#include <string>

class Messages;

struct ReadingOptions
{
  /// NIfTI and DICOM: origin 0; MetaImage and NRRD: the file's origin; all: spacing of the file and
  /// no direction, as VTK's and ParaView's readers have it.
  bool FileCoordinates = false;
  /// Which volume of a file with several in time, counted from 0.
  std::optional<int> Frame;
  /// Whether the user has an option that says so.
  bool CanChooseFrame = true;
};

/// Whether the program reads and writes the formats that ITK knows.
#ifdef DEFORMVOLUME_HAVE_ITK
inline constexpr bool HasITK = true;
#else
inline constexpr bool HasITK = false;
#endif

/// What ReadVolume reads, in words.
inline constexpr const char* ReadFormats = HasITK
  ? "a .nii, .nii.gz, .mhd, .mha, .nrrd, .nhdr or .vti file, or a folder with the slices of one "
    "DICOM series"
  : "a .nii, .nii.gz or .vti file";

/// Reads a volume: .nii, .nii.gz, .vti and, where the program has ITK, .mhd, .mha, .nrrd, .nhdr, or
/// a folder with the slices of one DICOM series. NIfTI volumes lie in a world right, anterior,
/// superior; MetaImage and DICOM left, posterior, superior; NRRD where the header says, if that is
/// one of the two; see WorldAxes. Throws a Failure where the volume cannot be read or has no place
/// in vtkImageData.
Volume ReadVolume(
  const std::string& path, const ReadingOptions& options, Messages& messages, bool showProgress);

/// The frame to read of so many. Throws a Failure where there are several and none is asked for, or
/// one that is not there.
int ChooseFrame(const std::string& path, int frames, const ReadingOptions& options);

#endif
