// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeInputGeometry_h
#define DeformVolumeInputGeometry_h

#include "ImageGeometry.h"
#include "Ranks.h"

#include "vtkType.h"

#include <string>
#include <utility>

class vtkAlgorithm;
class vtkInformation;

namespace deformvolume
{

/// The geometry of the whole image on an input port of a filter.
class InputGeometry
{
public:
  /// Finds the geometry. A source that does not announce origin, spacing or direction may rely on
  /// the defaults, or may have omitted other values: the executive and ParaView do not pass on the
  /// direction. It may also announce the origin and spacing of its input, as vtkResampleToImage
  /// does. Only the data have the right values. Then this function updates a part of the image, at
  /// the time of FindTime(). Something must be connected to the port.
  /// Collective.
  const ImageGeometry& Find(
    vtkAlgorithm* filter, int port, vtkInformation* output, const Ranks& ranks);

  /// Returns the last result of Find().
  const ImageGeometry& Get() const { return this->Geometry; }

  /// Throws an Error on all ranks unless Find() has returned the same geometry on all. what: names
  /// the image at the beginning of the message. Collective.
  void CheckRanks(const Ranks& ranks, const std::string& what) const;

private:
  ImageGeometry Geometry;
  std::pair<const void*, vtkMTimeType> Stamp; // of the source at that time
};

} // namespace deformvolume

#endif
