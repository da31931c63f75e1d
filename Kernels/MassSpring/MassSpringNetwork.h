// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMassSpringNetwork_h
#define DeformVolumeMassSpringNetwork_h

#include "AbortCheck.h"
#include "ElasticBody.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Returns the cube edge, in m, of a mesh whose tetrahedra are the five tetrahedra of equal cubes.
/// Each tetrahedron has either three edges of the cube that meet at a corner, or six face
/// diagonals. Edge lengths may deviate by a thousandth. Throws an Error with the number of the
/// first tetrahedron that has another shape or size.
double FindCubeEdge(AbortCheck& abortCheck, const ElasticBody& body);

/// The stiffness of the springs and of the volume of a tetrahedron.
struct SpringStiffness
{
  /// The stiffness of each edge, in N/m. The stiffness of an edge that several tetrahedra share is
  /// the sum of theirs.
  float Edge = 0.0F;
  /// The modulus of the volume, in Pa. The energy is Volume / 2 times the volume at rest times the
  /// square of the relative change of the volume.
  float Volume = 0.0F;
};

/// Returns a material with a Poisson ratio of at least 1/4 and the same Young modulus. A smaller
/// ratio would need a negative modulus of the volume, which is unstable.
ElasticMaterial GetSpringMaterial(const ElasticMaterial& material);

/// Returns the stiffness of one of the five tetrahedra of a cube. In a lattice, the springs along
/// cube edges then have mu h in total, and those along face diagonals 2 mu h. This is the only
/// isotropic choice. Springs alone have a Poisson ratio of 1/4; the modulus of the volume gives
/// larger ratios.
SpringStiffness GetSpringStiffness(
  const ElasticMaterial& material, double restVolume, double cubeEdge);

/// A body in the memory layout of the kernels (see MassSpringForces.cl and MassSpringMotion.cl).
/// The last packet is padded with tetrahedra whose forces no node adds.
struct MassSpringNetwork
{
  /// cubeEdge: see FindCubeEdge.
  MassSpringNetwork(AbortCheck& abortCheck, const ElasticBody& body, int lanes, double cubeEdge);

  int Lanes;
  std::size_t NumberOfPackets;
  std::vector<std::int32_t> Tetrahedra; // numbers of nodes, times 3
  std::vector<float> Materials;
  std::vector<float> RestPoints; // relative to the center of the body
  std::vector<std::uint32_t> Begins;
  std::vector<std::uint32_t> ForceIndices;
  std::vector<double> Masses; // in kg
  std::vector<float> Mobilities;
  double Size = 0.0; // the diagonal of the bounding box, in m
  /// A time step with which the body is stable near rest, in s: 2 divided by an upper bound of its
  /// largest angular frequency.
  double StableTimeStep = 0.0;
};

} // namespace deformvolume

#endif
