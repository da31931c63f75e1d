// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutsideVoxels_h
#define DeformVolumeOutsideVoxels_h

namespace deformvolume
{

/// Returns the factor by which the displacement of the boundary fades outside a mesh or a field:
/// from 1 at distance 0 to 0 at distance 1.
inline double GetFadedWeight(double distance)
{
  return distance < 1.0 ? 1.0 - distance * distance * (3.0 - 2.0 * distance) : 0.0;
}

/// Returns the derivative of GetFadedWeight() for distances from 0 to 1.
inline double GetFadedSlope(double distance)
{
  return 6.0 * distance * (distance - 1.0);
}

/// Treatment of the voxels outside a deformation mesh or a displacement field.
struct OutsideVoxels
{
  /// Treatment of the voxels outside.
  enum class Modes
  {
    Discard, // the voxels have no deformed position
    // The voxels follow the tetrahedron of the nearest voxel inside, or the nearest point of the
    // field.
    Extrapolate,
    Keep // the voxels do not move, except within FadeDistance
  };

  /// fadeDistance is used with Keep only.
  OutsideVoxels(Modes mode, double fadeDistance = 0.0)
    : Mode(mode)
    , FadeDistance(mode == Modes::Keep ? fadeDistance : 0.0)
  {
  }
  /// true: Extrapolate; false: Discard.
  OutsideVoxels(bool extrapolate = false)
    : OutsideVoxels(extrapolate ? Modes::Extrapolate : Modes::Discard)
  {
  }

  /// Whether the mode is Discard.
  bool AreDiscarded() const { return this->Mode == Modes::Discard; }
  /// Whether the mode is Extrapolate.
  bool AreExtrapolated() const { return this->Mode == Modes::Extrapolate; }
  /// Whether the mode is Keep.
  bool AreKept() const { return this->Mode == Modes::Keep; }
  /// Whether mode and distance are equal.
  bool operator==(const OutsideVoxels& other) const
  {
    return this->Mode == other.Mode && this->FadeDistance == other.FadeDistance;
  }

  /// Treatment of the voxels outside.
  Modes Mode;
  /// For Keep: distance from the mesh or the field, in world units, at which the displacement of
  /// the boundary has faded to zero. 0: no voxel outside moves.
  double FadeDistance;
};

} // namespace deformvolume

#endif
