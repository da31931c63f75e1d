// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTextureValues_h
#define DeformVolumeTextureValues_h

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

namespace deformvolume
{

/// An array that stands in for another one whose values are on a device, in the input of a mapper.
/// It has the type, the size and the ranges of that, and does not hold it: the other one can go
/// when its filter makes the next output, and need not be read for that. It is one of VTK's own
/// arrays whose memory is null: who reads it by anything but GetVoidPointer() crashes, as VTK's
/// mapper does not when a texture is made (9.1 to 9.6).
class TextureValues
{
public:
  virtual ~TextureValues() = default;

  /// The other array; null when it is gone.
  virtual vtkDataArray* GetValues() const = 0;
  /// Whether GetVoidPointer() gives null, so that a texture gets memory and no values. Otherwise,
  /// and at first, it gives the values, which are read then.
  virtual void SetWithoutValues(bool without) = 0;
  ///@{
  /// How often it has been asked for values that it did not give, and for those that it gave.
  virtual int GetNumberOfRefusals() const = 0;
  virtual int GetNumberOfReads() const = 0;
  ///@}
};

/// The object is a TextureValues, too.
vtkSmartPointer<vtkDataArray> MakeTextureValues(vtkDataArray* values);

/// Whether a texture of VTK's volume mapper has the values of a type as they are: of others the
/// mapper makes floats, on the host.
bool IsTextureType(int type);

} // namespace deformvolume

#endif
