// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeReading_h
#define DeformVolumeVolumeReading_h

#include "Volume.h"

#include <optional>
#include <string>

class Messages;
class vtkDataArray;
class vtkDataSetAttributes;

struct ReadingOptions
{
  /// Whether to use the coordinates of VTK's and ParaView's readers: the spacing of the file, no
  /// direction, and the origin 0 (NIfTI, DICOM) or that of the file (MetaImage, NRRD).
  bool FileCoordinates = false;
  /// Index of the volume to read from a file with several time steps, counted from 0.
  std::optional<int> Frame;
  /// Whether the user can set Frame by an option. Affects messages only.
  bool CanChooseFrame = true;
  /// Whether one voxel is enough on an axis, as for a reference image.
  bool CanBeFlat = false;
};

/// Whether the program was built with ITK, and reads and writes its formats.
#ifdef DEFORMVOLUME_HAVE_ITK
inline constexpr bool HasITK = true;
#else
inline constexpr bool HasITK = false;
#endif

/// The formats of ReadVolume, for messages.
inline constexpr const char* ReadFormats = HasITK
  ? "a .nii, .nii.gz, .mhd, .mha, .nrrd, .nhdr or .vti file, or a folder with the slices of one "
    "DICOM series"
  : "a .nii, .nii.gz or .vti file";

/// Reads a volume: .nii, .nii.gz, .vti and, with ITK, .mhd, .mha, .nrrd, .nhdr, or a folder with
/// the slices of one DICOM series. Sets Volume::Axes: NIfTI volumes are right, anterior, superior;
/// MetaImage and DICOM volumes are left, posterior, superior; the header of an NRRD file states its
/// axes. Throws a Failure if the volume cannot be read, or if vtkImageData cannot hold it.
Volume ReadVolume(
  const std::string& path, const ReadingOptions& options, Messages& messages, bool showProgress);

/// Returns the first numeric array that is no mask (vtkGhostType, vtkValidPointMask,
/// BoundaryDistance, CutDistance); null if there is none.
vtkDataArray* FindNumbers(vtkDataSetAttributes* arrays);

/// Makes the array of FindNumbers() the active scalars if there are none, or if they are a mask,
/// because all later steps need scalars. path: the file of the image. Throws a Failure if there is
/// no such array.
void ChooseScalars(vtkImageData* image, const std::string& path);

/// Returns the index of the frame to read. frames: number of frames in the file. Throws a Failure
/// if ReadingOptions::Frame is out of range, or if it is not set and there are several frames.
int ChooseFrame(const std::string& path, int frames, const ReadingOptions& options);

#endif
