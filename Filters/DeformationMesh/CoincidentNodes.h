// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCoincidentNodes_h
#define DeformVolumeCoincidentNodes_h

#include <cstdint>
#include <vector>

namespace deformvolume
{

class RestMesh;

/// Groups of nodes of a mesh with the same position at rest, such as the nodes that a node was
/// split into. The groups are found once for a shape of the mesh, and then updated from the changes
/// of its connectivity.
class CoincidentNodes
{
public:
  void Update(const RestMesh& mesh);
  /// A number for each node, which is the same for coincident nodes. Empty if there are no
  /// coincident nodes.
  const std::vector<std::int32_t>& Get() const
  {
    static const std::vector<std::int32_t> none;
    return this->AnyShared ? this->Numbers : none;
  }

private:
  /// Joins the groups of two nodes.
  void Join(std::int32_t first, std::int32_t second);

  std::vector<std::int32_t> Numbers;
  std::vector<unsigned char> Shares; // whether a node may have coincident nodes
  bool AnyShared = false;
  std::uint64_t ShapeVersion = 0;
  std::uint64_t ConnectivityVersion = 0;
};

} // namespace deformvolume

#endif
