// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePreconditioner_h
#define DeformVolumePreconditioner_h

#include "AbortCheck.h"
#include "BlockMatrix.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace deformvolume
{

/// A symmetric approximation of the inverse of the free rows and columns of a matrix. Vectors are 0
/// at nodes that are not free.
class Preconditioner
{
public:
  virtual ~Preconditioner() = default;
  /// size: the approximate length of the vector, for scaling.
  virtual void Apply(AbortCheck& abortCheck, const std::vector<glm::dvec3>& vector, double size,
    std::vector<glm::dvec3>& result) = 0;
};

/// Block Jacobi: the inverses of the diagonal blocks.
class BlockJacobi : public Preconditioner
{
public:
  void Build(
    AbortCheck& abortCheck, const BlockMatrix& matrix, const std::vector<unsigned char>& isFree);
  void Apply(AbortCheck& abortCheck, const std::vector<glm::dvec3>& vector, double size,
    std::vector<glm::dvec3>& result) override;

private:
  std::vector<glm::dmat3> Inverses;
};

} // namespace deformvolume

#endif
