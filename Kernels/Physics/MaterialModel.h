// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaterialModel_h
#define DeformVolumeMaterialModel_h

namespace deformvolume
{

/// How the strain energy depends on the deformation gradient F. For small strains both models equal
/// linear elasticity. In both models the part of lambda above 4 mu acts on the mean of J - 1 of
/// each tetrahedron only, to avoid volumetric locking (FiniteElementModel). J is the determinant of
/// F.
enum class MaterialModel
{
  /// Stable neo-Hookean model without a logarithmic term: mu/2 (|F|^2 - 3) - mu (J - 1) + (lambda +
  /// mu)/2 (J - 1)^2. For soft tissue.
  StableNeoHookean,
  /// Corotational model: mu |F - R|^2 + lambda/2 tr(S - 1)^2, where F = R S and R is a rotation.
  /// This is linear elasticity in a frame that rotates with the material. It does not preserve the
  /// volume at large strains.
  Corotational
};

} // namespace deformvolume

#endif
