// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldReading_h
#define DeformVolumeFieldReading_h

#include "Volume.h"

#include <string>

class Messages;

/// What the user says of a field.
struct FieldOptions
{
  bool IsInverse = false;
  /// "lps", "ras", or "": as the file says, or as the volume.
  std::string Space;
};

/// Reads a displacement field in the formats of volumes and turns it into the world of a volume,
/// its positions and its vectors. NIfTI: shape (X, Y, Z, 1, 3), vectors right-anterior-superior
/// with intent 1006 (NIFTI_INTENT_DISPVECT), left-posterior-superior with intent 1007
/// (NIFTI_INTENT_VECTOR), as ITK writes both. MetaImage: left-posterior-superior. NRRD: the space
/// of the file, and its measurement frame. Lengths are in mm. .vti: as it is, but for its space.
/// The vectors are the point array FieldArrayName, except in .vti files, which keep their arrays.
/// Throws a Failure that says what is wrong with a file and how to change it.
vtkSmartPointer<vtkImageData> ReadField(const std::string& path, const Volume& volume,
  const FieldOptions& options, Messages& messages, bool showProgress);

/// Whether a file's name is that of a format that fields are read from.
bool IsFieldFile(const std::string& path);

/// Whether a file is one of VTK, which names its arrays.
bool IsVTKFile(const std::string& path);

inline constexpr const char* FieldArrayName = "Displacement";

#endif
