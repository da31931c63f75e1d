// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTextureValues_h
#define DeformVolumeTextureValues_h

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

namespace deformvolume
{

/// An array that a texture is made from, in place of another one whose values are on a device. It
/// has the type, the size and the ranges of that, and does not hold it: the other one can go when
/// its filter makes the next output, and need not be read for that.
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

/// The types that a texture of VTK's volume mapper has as they are. Null for others. The object is
/// a TextureValues, too.
vtkSmartPointer<vtkDataArray> MakeTextureValues(vtkDataArray* values);

} // namespace deformvolume

#endif
