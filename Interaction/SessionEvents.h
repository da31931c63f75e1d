// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSessionEvents_h
#define DeformVolumeSessionEvents_h

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkImageData;
class vtkPolyData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// A call of a method that changes a session. A session is the sequence of its events: the same
/// events give the same arrays, to the last bit.
struct SessionEvent
{
  enum KindType
  {
    BEGIN_GRAB, // handle, x, y, z
    MOVE_GRAB,  // handle, x, y, z
    END_GRAB,   // handle
    HOLD,       // handle
    RELEASE,    // handle
    CUT,        // points, their coordinates, then the points of each triangle
    CARVE,      // 1 for a new stroke, x, y, z, radius
    UNDO,
    REDO,
    RESET,
    MODEL,         // one of vtkDeformVolumeSession::Models
    HANDLE_RADIUS, // world units
    RELAXATION,    // sweeps
    LATTICE,       // nodes on each axis
    UNDO_MEMORY,   // bytes
    STEP           // one step of the simulation
  };
  KindType Kind = STEP;
  std::vector<double> Numbers;

  bool operator==(const SessionEvent& other) const
  {
    return this->Kind == other.Kind && this->Numbers == other.Numbers;
  }
};

using SessionEvents = std::vector<SessionEvent>;

/// The name in files, followed by the numbers; they are read back to the last bit.
std::string FormatEvent(const SessionEvent& event);

/// Throws std::runtime_error where the text is no event.
SessionEvent ParseEvent(const std::string& text);

/// The triangles of a surface as an event, and back. Throws std::runtime_error where there are none
/// or a point is not finite.
SessionEvent MakeCutEvent(vtkPolyData* sheet);
vtkSmartPointer<vtkPolyData> MakeSheet(const SessionEvent& cut);

/// A number for the geometry and all point arrays of a volume and, where there is one, for the
/// points and cells of a mesh.
std::string HashInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh);

///@{
/// A file of events. Both throw std::runtime_error with a reason. The old file stays as it was
/// until the new one is complete.
void WriteEvents(
  const std::string& fileName, const std::string& inputHash, const SessionEvents& events);
SessionEvents ReadEvents(const std::string& fileName, const std::string& inputHash);
///@}

/// Has a file written under another name in the same folder, and renames it to its own name where
/// nothing is thrown.
template <typename WriterT>
void WriteAndRename(const std::string& fileName, const WriterT& write);
void RenameFile(const std::string& from, const std::string& to);
void RemoveFile(const std::string& fileName);

template <typename WriterT>
void WriteAndRename(const std::string& fileName, const WriterT& write)
{
  const std::string part = fileName + ".part";
  try
  {
    write(part);
    RenameFile(part, fileName);
  }
  catch (...)
  {
    RemoveFile(part);
    throw;
  }
}

} // namespace deformvolume

#endif
