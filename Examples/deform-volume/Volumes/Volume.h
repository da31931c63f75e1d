// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolume_h
#define DeformVolumeVolume_h

#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkMatrix4x4.h>
#include <vtkNIFTIImageHeader.h>
#include <vtkSmartPointer.h>

#include <map>
#include <string>

/// What the axes of the world point to, as far as the file says it.
enum class WorldAxes
{
  Unknown,
  /// x to the right, y to the front, z to the head: NIfTI.
  RightAnteriorSuperior,
  /// x to the left, y to the back, z to the head: DICOM, MetaImage, and most NRRD files.
  LeftPosteriorSuperior
};

/// A NIfTI file's two transformations to the world, with the codes that name that world (1 the
/// scanner, 2 another image, 3 Talairach, 4 MNI; 0: there is none).
struct NIfTIForms
{
  int SFormCode = 0;
  int QFormCode = 0;
  /// From (index * spacing), in mm, to the world. Null where QFormCode is 0.
  vtkSmartPointer<vtkMatrix4x4> QForm;
  /// In mm. That of the s-form is the image's.
  double QSpacing[3] = { 1.0, 1.0, 1.0 };
};

/// What NIfTI files say of vectors that point as those of ITK do (NIFTI_INTENT_VECTOR).
inline constexpr int NIfTIIntentVector = 1007;

/// An image and what vtkImageData has no room for.
struct Volume
{
  vtkSmartPointer<vtkImageData> Image;
  WorldAxes Axes = WorldAxes::Unknown;
  /// Of a NIfTI file that says where it lies. The s-form is the place of the image.
  NIfTIForms Forms;
  /// What the values of a NIfTI file mean that is to be written (NIFTI_INTENT); 0: nothing is said.
  int IntentCode = 0;
  /// Null for other formats.
  vtkSmartPointer<vtkNIFTIImageHeader> NIfTIHeader;
  /// The keys of an NRRD file's header.
  std::map<std::string, std::string> Fields;
  /// Of an NRRD file: from the components of vectors to the world. Null where there is none.
  vtkSmartPointer<vtkMatrix3x3> MeasurementFrame;
};

#endif
