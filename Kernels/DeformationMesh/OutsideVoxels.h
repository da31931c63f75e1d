// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutsideVoxels_h
#define DeformVolumeOutsideVoxels_h

namespace deformvolume
{

/// What is left of the displacement of the boundary outside a mesh or a field. distance: 1 is where
/// nothing is left.
inline double GetFadedWeight(double distance)
{
  return distance < 1.0 ? 1.0 - distance * distance * (3.0 - 2.0 * distance) : 0.0;
}

/// Its derivative by the distance, for distances up to 1.
inline double GetFadedSlope(double distance)
{
  return 6.0 * distance * (distance - 1.0);
}

/// What becomes of the voxels outside a deformation mesh or field.
struct OutsideVoxels
{
  /// What becomes of them.
  enum class Modes
  {
    Discard, // they have no place after the deformation
    // They follow the tetrahedron of the nearest voxel inside, or the nearest point of the field.
    Extrapolate,
    Keep // they stay where they are, but for those near the mesh or the field
  };

  /// fadeDistance counts with Keep only.
  OutsideVoxels(Modes mode, double fadeDistance = 0.0)
    : Mode(mode)
    , FadeDistance(mode == Modes::Keep ? fadeDistance : 0.0)
  {
  }
  /// True: Extrapolate, false: Discard.
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

  /// What becomes of them.
  Modes Mode;
  /// Of Keep: how far from the mesh or the field the displacement of its boundary fades to zero, in
  /// world units; 0: no voxel outside moves.
  double FadeDistance;
};

} // namespace deformvolume

#endif
