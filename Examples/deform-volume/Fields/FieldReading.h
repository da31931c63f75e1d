// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldReading_h
#define DeformVolumeFieldReading_h

#include "Volume.h"

#include <string>

class Messages;

/// The options --field-is-inverse and --field-space.
struct FieldOptions
{
  bool IsInverse = false;
  /// "lps", "ras", or "": the world coordinates that the file states, or else those of the volume.
  std::string Space;
};

/// Reads a displacement field in the formats of volumes, and converts its positions and its vectors
/// to the world coordinates of a volume. Lengths are in mm, and vectors are as follows:
/// - NIfTI: shape (X, Y, Z, 1, 3), right-anterior-superior with intent 1006
///   (NIFTI_INTENT_DISPVECT),
///   left-posterior-superior with intent 1007 (NIFTI_INTENT_VECTOR, as written by ITK).
/// - MetaImage: left-posterior-superior.
/// - NRRD: in the space of the file, with its measurement frame.
/// - .vti: in the world coordinates of FieldOptions::Space, or else of the volume.
///
/// The vectors are the point array FieldArrayName; .vti files keep their arrays. Throws a Failure
/// that says what is wrong with a file and how to correct it.
vtkSmartPointer<vtkImageData> ReadField(const std::string& path, const Volume& volume,
  const FieldOptions& options, Messages& messages, bool showProgress);

/// Whether a file name has the extension of a format that ReadField reads.
bool IsFieldFile(const std::string& path);

/// Whether a file is a .vti file, whose arrays have names.
bool IsVTKFile(const std::string& path);

inline constexpr const char* FieldArrayName = "Displacement";

#endif
