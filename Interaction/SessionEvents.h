// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSessionEvents_h
#define DeformVolumeSessionEvents_h

#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

class vtkImageData;
class vtkPolyData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// A call of a method that changes a session. A session is the sequence of its events: the same
/// events give bitwise equal arrays.
struct SessionEvent
{
  enum KindType
  {
    BEGIN_GRAB, // handle, x, y, z
    MOVE_GRAB,  // handle, x, y, z
    END_GRAB,   // handle
    HOLD_GRAB,  // handle
    RELEASE,    // handle
    CUT,        // number of points, their coordinates, then the point ids of each triangle
    CARVE,      // 1 for a new stroke, x, y, z, radius
    UNDO,
    REDO,
    RESET,
    MODEL,             // one of vtkDeformVolumeSession::Models
    HANDLE_RADIUS,     // world units
    RELAXATION_SWEEPS, // sweeps
    NUMBER_OF_NODES,   // maximum number of nodes on an axis
    UNDO_MEMORY,       // bytes
    STEP               // one step of the simulation
  };
  KindType Kind = STEP;
  std::vector<double> Numbers;
};

using SessionEvents = std::vector<SessionEvent>;

/// Returns the text of an event in files: its name and its numbers. ParseEvent() reads the numbers
/// exactly.
std::string FormatEvent(const SessionEvent& event);

/// Throws std::runtime_error if the text is not an event.
SessionEvent ParseEvent(const std::string& text);

/// Convert the triangles of a surface to an event, and back. MakeCutEvent() throws
/// std::runtime_error if there are no triangles, if a polygon is not a triangle or refers to a
/// missing point, if there are triangle strips, or if a point is not finite. Vertices and lines are
/// ignored.
SessionEvent MakeCutEvent(vtkPolyData* sheet);
vtkSmartPointer<vtkPolyData> MakeSheet(const SessionEvent& cut);

/// Returns a hash of the geometry and all point arrays of a volume, and of the points and cells of
/// a mesh if it is not null; a hash of the arrays of the mesh, if it is not null; and a hash of
/// everything else that the result depends on, such as cell arrays. Spaces separate the parts.
std::string HashInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh);

///@{
/// Write and read a file of events. Both throw std::runtime_error with the reason of a failure. An
/// existing file is replaced only when the new file is complete.
void WriteEvents(
  const std::string& fileName, const std::string& inputHash, const SessionEvents& events);
SessionEvents ReadEvents(const std::string& fileName, const std::string& inputHash);
///@}

/// Calls `write` with the name of a new temporary file in the same folder, and then renames this
/// file to fileName, or to the file that the symbolic link fileName refers to. It has the
/// permissions of the file that it replaces. If something is thrown, removes the temporary file.
void WriteAndRename(
  const std::string& fileName, const std::function<void(const std::string& name)>& write);

} // namespace deformvolume

#endif
