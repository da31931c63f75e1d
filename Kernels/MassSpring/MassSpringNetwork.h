// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMassSpringNetwork_h
#define DeformVolumeMassSpringNetwork_h

#include "ElasticBody.h"
#include "Watch.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// How stiff the springs and the volume of a tetrahedron are.
struct SpringStiffness
{
  /// Of each edge, in N/m. An edge of several tetrahedra has the sum.
  float Edge = 0.0F;
  /// In Pa: the energy of the volume is half of this, times the volume at rest, times the square of
  /// how much the volume has grown as a fraction.
  float Volume = 0.0F;
};

/// The material that springs can be of: Poisson ratios below 1/4 would need a volume that pushes
/// outwards, which is unstable. They count as 1/4, with the same Young modulus.
ElasticMaterial GetSpringMaterial(const ElasticMaterial& material);

/// The stiffness of a fifth of a cube of a material (GetSpringMaterial). In a lattice, edges of
/// cubes then have springs of mu h and diagonals of 2 mu h, which is the only isotropic choice;
/// their Poisson ratio is 1/4, and the volume makes the rest of it.
SpringStiffness GetSpringStiffness(
  const ElasticMaterial& material, double restVolume, double cubeEdge);

/// A body as the kernels have it. Tetrahedra lie in packets of so many lanes, the last one filled
/// up with tetrahedra that no node knows; see MassSpringForces.cl and MassSpringMotion.cl.
struct MassSpringNetwork
{
  /// cubeEdge: see FindCubeEdge.
  MassSpringNetwork(Watch& watch, const ElasticBody& body, int lanes, double cubeEdge);

  int Lanes;
  std::size_t NumberOfPackets;
  std::vector<std::int32_t> Tetrahedra; // nodes, times 3
  std::vector<float> Materials;
  std::vector<float> RestPoints; // from the middle of the body
  std::vector<std::uint32_t> Begins;
  std::vector<std::uint32_t> Places;
  std::vector<double> Masses; // in kg
  std::vector<float> Mobilities;
  double Size = 0.0; // the diagonal of the body, in m
  /// A time step with which the body is stable near rest, in s: 2 by a bound of its largest angular
  /// frequency.
  double StableTimeStep = 0.0;
};

} // namespace deformvolume

#endif
