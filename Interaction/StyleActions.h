// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStyleActions_h
#define DeformVolumeStyleActions_h

#include <glm/vec3.hpp>

#include <cstddef>
#include <map>
#include <vector>

namespace deformvolume
{

/// What a style has had its session do, as far as it needs it to know which handles are held: the
/// session makes events later, and some of them fail.
class StyleActions
{
public:
  struct Handle
  {
    int Number = -1;
    glm::dvec3 Place{ 0.0 };
  };

  void BeginDrag(int handle, const glm::dvec3& place);
  void MoveDrag(int handle, const glm::dvec3& place);
  void EndDrag(int handle, bool isHeld);
  void Release(int handle);
  /// A cut, a carving or a change of the model.
  void DoOther();
  void Undo();
  void Redo();
  void Reset();
  void Clear();

  /// What the session says when no event waits. Actions that it does not have have failed.
  void Compare(std::size_t done, std::size_t undone);

  /// Those that hold something now.
  std::vector<Handle> GetHeld() const;

private:
  struct Action
  {
    enum KindType
    {
      DRAG,
      RELEASE,
      OTHER
    };
    KindType Kind = OTHER;
    int Handle = -1;
  };
  void Do(Action::KindType kind, int handle);

  struct State
  {
    glm::dvec3 Place{ 0.0 };
    bool IsHeld = true;
  };
  std::map<int, State> Handles;
  std::vector<Action> Done;
  std::vector<Action> Undone;
};

} // namespace deformvolume

#endif
