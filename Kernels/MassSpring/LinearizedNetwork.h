// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLinearizedNetwork_h
#define DeformVolumeLinearizedNetwork_h

#include "MassSpringNetwork.h"
#include "MassSpringState.h"
#include "Watch.h"

#include <array>
#include <vector>

namespace deformvolume
{

/// The springs and volumes of a body near rest: forces are then linear in the displacements. It
/// works with the displacements of a state, which are 0 afterwards. The watch is asked each time
/// that the device has found forces.
class LinearizedNetwork
{
public:
  LinearizedNetwork(Watch& watch, MassSpringState& state, const MassSpringNetwork& network)
    : Asked(watch)
    , State(state)
    , Network(network)
  {
  }

  /// Which forces would hold displacements, three numbers a node in both.
  std::vector<double> Apply(const std::vector<double>& displacements) const;

  /// The largest angular frequency that the body vibrates with, in 1/s; 0 where no node moves.
  double FindLargestFrequency() const;

  /// The Young modulus of a bar of this mesh, of one material, divided by that of the material: 1
  /// where the mesh is as stiff as the material in all ways.
  double FindStiffness(const ElasticBody& body) const;

private:
  /// What a body does where it is strained everywhere alike, by the six components of strain.
  struct AffineResponse
  {
    std::array<std::vector<double>, 6> Displacements;
    std::array<std::vector<double>, 6> Forces;
    std::array<std::array<double, 6>, 6> Stiffness; // per volume
  };

  AffineResponse FindAffineResponse(double volume) const;
  double FindCompliance(
    const ElasticBody& body, const AffineResponse& response, double volume, int axis) const;

  Watch& Asked;
  MassSpringState& State;
  const MassSpringNetwork& Network;
};

} // namespace deformvolume

#endif
