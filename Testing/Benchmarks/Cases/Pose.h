// SPDX-License-Identifier: BSD-3-Clause
#ifndef Pose_h
#define Pose_h

#include <array>
#include <vector>

/// The deformations that are measured.
enum class Pose
{
  /// Not deformed, but shifted by a whole voxel at every other step.
  Undeformed,
  /// A smooth displacement of up to 12 voxels.
  NearIdentity,
  /// Rotated by 7 degrees about each axis, and scaled by 1.03.
  General,
  /// Pushed in by 25 voxels in the middle of one side, and moved by a whole voxel at every other
  /// step.
  LocalLoad,
  /// Rotated by 45 degrees about each axis.
  Rotated,
  /// Stretched along each axis, by 0.7 at its beginning to 1.6 at its end.
  VaryingScale,
  /// Scaled by 1.5.
  UniformScale,
  /// NearIdentity, with the last third on x folded over the rest.
  Folded,
  /// NearIdentity, where only the nodes of a box move from step to step, see GetLocalEditBox().
  LocalEdit,
  /// LocalEdit with a box on a side of the volume, which moves in and out.
  LocalEditAtSide
};

/// Returns the name of a pose in the results.
const char* GetName(Pose pose);

/// Returns the box of the poses LocalEdit and LocalEditAtSide: x min, x max, y min, y max, z min,
/// z max in voxels.
std::array<double, 6> GetLocalEditBox(Pose pose, const std::array<int, 3>& dimensions);

/// Maps the points of a volume with spacing 1 and origin 0 to their positions in a pose. Each step
/// differs a little from the previous one, so that no result can be reused.
class PoseMap
{
public:
  PoseMap(Pose pose, const std::array<int, 3>& dimensions, int step);

  std::array<double, 3> operator()(const std::array<double, 3>& rest) const;

  /// Returns the row-major 3 x 4 matrix of the poses General, Rotated and UniformScale.
  const std::array<double, 12>& GetMatrix() const { return this->Matrix; }

private:
  std::array<double, 3> MoveNearIdentity(const std::array<double, 3>& rest, double phase) const;
  void SetMatrix(double degreesRoundX, double degreesRoundYZ, double scale);

  Pose ThePose;
  std::array<int, 3> Dimensions;
  /// A change of phase in each step, in radians or degrees.
  double Phase;
  /// 0 or 1 voxel.
  double Shift;
  std::array<double, 12> Matrix{ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
};

#endif
