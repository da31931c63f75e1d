// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCoincidentNodes_h
#define DeformVolumeCoincidentNodes_h

#include <cstdint>
#include <vector>

namespace deformvolume
{

class RestMesh;

/// Which nodes of a mesh have one place at rest, as those have that a node was split into. Found
/// among all nodes once for a mesh, and then followed.
class CoincidentNodes
{
public:
  void Update(const RestMesh& mesh);
  /// A number for each node, which nodes with one place share. Empty where no two do.
  const std::vector<std::int32_t>& Get() const
  {
    static const std::vector<std::int32_t> none;
    return this->AnyShared ? this->Numbers : none;
  }

private:
  /// Two nodes have one place.
  void Join(std::int32_t first, std::int32_t second);

  std::vector<std::int32_t> Numbers;
  std::vector<unsigned char> Shares; // whether a node may share its place
  bool AnyShared = false;
  std::uint64_t ShapeVersion = 0;
  std::uint64_t ConnectivityVersion = 0;
};

} // namespace deformvolume

#endif
