// SPDX-License-Identifier: BSD-3-Clause
#ifndef Peers_h
#define Peers_h

#include "Pose.h"

#include <memory>

class vtkImageData;

/// An alternative to the filter. A peer fills the same output extent as the filter, in the
/// coordinates of the volume.
class Peer
{
public:
  virtual ~Peer() = default;

  /// Moves to a step of a pose, which is not measured, and fills an extent. Returns the wall-clock
  /// seconds that the update took; the published method returns those of its commands on the
  /// device.
  virtual double Update(Pose pose, int step, const int extent[6]) = 0;

  virtual vtkImageData* GetOutput() = 0;
};

/// vtkImageReslice with linear interpolation and an affine transform: the pose General, whatever
/// pose is requested. Its time is that of rotating a volume with VTK.
std::unique_ptr<Peer> MakeAffineReslice(vtkImageData* volume);

enum class GridDirection
{
  /// The vectors of the grid are used as those of the inverse deformation, as if it were known.
  Backward,
  /// The transform inverts the deformation at each voxel by Newton's method.
  Solved
};

/// vtkImageReslice with a vtkGridTransform, linear, whose grid has the nodes of a lattice.
std::unique_ptr<Peer> MakeGridReslice(
  vtkImageData* volume, int nodesPerAxis, GridDirection direction);

/// Two vtkProbeFilter: the deformed tetrahedra, which carry their rest coordinates, are probed at
/// the voxels of the output; then the volume is probed at those coordinates.
std::unique_ptr<Peer> MakeProbeChain(vtkImageData* volume, int nodesPerAxis);

/// The published method (PublishedKernels.cl), for volumes of MakeVolume() of 16 bits.
std::unique_ptr<Peer> MakePublished(vtkImageData* volume, int nodesPerAxis);

#endif
