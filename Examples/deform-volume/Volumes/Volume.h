// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolume_h
#define DeformVolumeVolume_h

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkMatrix4x4.h>
#include <vtkNIFTIImageHeader.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>

#include <map>
#include <string>

/// Directions of the world axes, if the file states them.
enum class WorldAxes
{
  Unknown,
  /// x to the right, y to the front, z to the head: NIfTI.
  RightAnteriorSuperior,
  /// x to the left, y to the back, z to the head: DICOM, MetaImage, and most NRRD files.
  LeftPosteriorSuperior
};

/// The two transforms of a NIfTI file to the world, and the codes of their world coordinates (1:
/// scanner, 2: another image, 3: Talairach, 4: MNI; 0: there is no such transform).
struct NIfTIForms
{
  int SFormCode = 0;
  int QFormCode = 0;
  /// From (index * QSpacing), in mm, to the world. Null if QFormCode is 0. The transform of the
  /// s-form is that of the image.
  vtkSmartPointer<vtkMatrix4x4> QForm;
  /// Spacing of the q-form, in mm. The spacing of the s-form is that of the image.
  double QSpacing[3] = { 1.0, 1.0, 1.0 };
};

/// The intent code of NIfTI files whose vectors point left, posterior, superior, as ITK writes them
/// (NIFTI_INTENT_VECTOR).
inline constexpr int NIfTIIntentVector = 1007;

/// An image, and properties of its file that vtkImageData cannot hold.
struct Volume
{
  vtkSmartPointer<vtkImageData> Image;
  WorldAxes Axes = WorldAxes::Unknown;
  /// Number of time steps in the file.
  int NumberOfFrames = 1;
  /// The unit of length in the file, if coordinates were converted from it to mm; "" if they were
  /// not. Vectors are not converted. Not set for NIfTI files.
  std::string Unit;
  /// The forms of a NIfTI file.
  NIfTIForms Forms;
  /// The intent code (NIFTI_INTENT) for writing a NIfTI file; 0: none.
  int IntentCode = 0;
  /// Null for other formats.
  vtkSmartPointer<vtkNIFTIImageHeader> NIfTIHeader;
  /// The keys of an NRRD file's header.
  std::map<std::string, std::string> Fields;
  /// The matrix of an NRRD file from components of vectors to the world. Null for other formats.
  vtkSmartPointer<vtkMatrix3x3> MeasurementFrame;
  /// The labels of --label-volume; null: there are none.
  vtkSmartPointer<vtkDataArray> Labels;

  /// Returns the values that label:N refers to: Labels, or else the scalars.
  vtkDataArray* GetLabels() const
  {
    return this->Labels ? this->Labels.Get() : this->Image->GetPointData()->GetScalars();
  }
};

#endif
