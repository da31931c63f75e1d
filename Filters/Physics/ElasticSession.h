// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElasticSession_h
#define DeformVolumeElasticSession_h

#include "BodyReading.h"
#include "ElasticSimulation.h"
#include "MeshSplit.h"
#include "SheetReading.h"
#include "Stamp.h"

#include "vtkSmartPointer.h"

#include <cstdint>
#include <functional>
#include <vector>

class vtkUnstructuredGrid;

namespace deformvolume
{

/// The body of a simulation with its cuts, and the simulated time.
class ElasticSession
{
public:
  /// Updates the body. Returns whether a simulated state is lost, by this call or by earlier ones
  /// that failed or were aborted. written: stamp of the grid, see GetWrittenStamp(). progress: see
  /// ElasticSimulation::SetBody().
  bool Update(ElasticSimulation& simulation, vtkUnstructuredGrid* grid,
    const Stamp::value_type& written, const BodySettings& settings,
    const std::function<bool()>& progress);

  /// Cuts the deformed body along a sheet, which is in units of the mesh. isAtRest: cuts the body
  /// at rest instead, as Reset() follows. Does nothing if the sheet is the same as in the last
  /// call.
  void Cut(const WorldSheet& sheet, bool isAtRest);
  /// Removes all cuts except the first ones. left: number of cuts to keep. The state of the body
  /// becomes that before the removed cuts. The time does not change.
  void RemoveCuts(std::size_t left);
  /// Like RemoveCuts(), but after an error: the same sheet then cuts again in the next call.
  void RevertNewCuts(std::size_t left);
  /// Discards a body in an unknown state: the next Update() begins with a new one.
  void Lose();
  std::size_t GetNumberOfCuts() const { return this->Cuts.size(); }
  std::int64_t GetNumberOfSplitFaces() const;

  /// Resets the body to its rest state, and the time to 0. The body is also at rest after cuts that
  /// were made before are removed.
  void Reset();

  bool HasBody() const { return this->Exists; }
  /// The body with its cuts.
  const BodyMesh& GetMesh() const { return this->Mesh; }
  const BodySettings& GetSettings() const { return this->Settings; }

  /// Returns the grid with the mid-side nodes that were added, and the nodes that cuts have added;
  /// the grid itself if there are none. As long as the mesh does not change, the result has the
  /// same points and cells.
  vtkUnstructuredGrid* GetGrid(vtkUnstructuredGrid* grid);

  double Time = 0.0;     // in s
  bool HasMoved = false; // whether there is a simulated state

private:
  struct AppliedCut
  {
    std::vector<Tetrahedron> Tetrahedra;
    std::vector<MidSideNodes> MidSides; // empty: the body is not quadratic
    std::vector<std::int32_t> Origins;  // the node that each copy was made from
    std::vector<TetrahedronPair> StillConnected;
    std::int64_t NumberOfFaces = 0;
    ElasticSimulation::State Before;
  };

  /// Adds the current cuts to a body.
  BodyMesh WithCuts(const BodyMesh& whole) const;
  /// The node of the body without cuts that a node was copied from, or the node itself.
  std::size_t GetOrigin(std::size_t node) const;
  void FillMesh(vtkUnstructuredGrid* grid, vtkUnstructuredGrid* made) const;
  void FillPointData(vtkUnstructuredGrid* grid, vtkUnstructuredGrid* made) const;

  bool Exists = false;
  bool WasLost = false;                    // whether a failed call has lost a simulated state
  ElasticSimulation* Simulation = nullptr; // has the body
  Stamp BodyStamp;
  BodySettings Settings;
  BodyMesh Whole;
  BodyMesh Mesh;
  std::vector<AppliedCut> Cuts;
  WorldSheet Sheet; // the sheet of the last cut
  vtkSmartPointer<vtkUnstructuredGrid> MadeGrid;
  Stamp MadeMeshStamp;           // of the points and cells that MadeGrid was made from
  Stamp MadeDataStamp;           // of the arrays that MadeGrid was made from
  std::uint64_t MeshVersion = 0; // changes with the nodes and tetrahedra of the body
  std::uint64_t MadeVersion = 0; // MeshVersion of MadeGrid
};

} // namespace deformvolume

#endif
