// SPDX-License-Identifier: BSD-3-Clause
#ifndef Pose_h
#define Pose_h

#include <array>
#include <vector>

/// The deformations that are measured.
enum class Pose
{
  /// Not deformed, and moved by a whole voxel at every other step.
  Undeformed,
  /// A smooth displacement of up to 12 voxels.
  NearIdentity,
  /// Turned by 7 degrees round each axis, and scaled by 1.03.
  General,
  /// Pushed in by 25 voxels in the middle of one side, and moved by a whole voxel at every other
  /// step.
  LocalLoad,
  /// Turned by 45 degrees round each axis.
  Rotated,
  /// Stretched more and more along each axis: by 0.7 at its begin, by 1.6 at its end.
  VaryingScale,
  /// Scaled by 1.5.
  UniformScale,
  /// NearIdentity, with the last third on x laid back over the rest.
  Folded,
  /// NearIdentity, where only the nodes of a box move from step to step, see GetLocalEditBox().
  LocalEdit,
  /// The same on a side of the volume, which goes in and out.
  LocalEditAtSide
};

/// The name of a pose in the results.
const char* GetName(Pose pose);

/// The box of the poses LocalEdit and LocalEditAtSide: x min, x max, y min, y max, z min, z max in
/// voxels.
std::array<double, 6> GetLocalEditBox(Pose pose, const std::array<int, 3>& dimensions);

/// Where the points of a volume with spacing 1 and origin 0 go in a pose. Each step is a little
/// different from the last one, so that nothing can be reused.
class PoseMap
{
public:
  PoseMap(Pose pose, const std::array<int, 3>& dimensions, int step);

  std::array<double, 3> operator()(const std::array<double, 3>& rest) const;

  /// For the poses General, Rotated and UniformScale: the row-major 3 x 4 matrix.
  const std::array<double, 12>& GetMatrix() const { return this->Matrix; }

private:
  std::array<double, 3> MoveNearIdentity(const std::array<double, 3>& rest, double phase) const;
  void SetMatrix(double degreesRoundX, double degreesRoundYZ, double scale);

  Pose ThePose;
  std::array<int, 3> Dimensions;
  /// A change of phase, by step: in radians or degrees.
  double Phase;
  /// 0 or 1 voxel.
  double Shift;
  std::array<double, 12> Matrix{ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
};

#endif
