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

/// The body that a simulation was given, with the cuts in it, and the time that it has come to.
class ElasticSession
{
public:
  /// Brings the body up to date. Returns whether something that was simulated is lost by that, or
  /// has been by calls before that failed or were given up. progress: see
  /// ElasticSimulation::SetBody.
  bool Update(ElasticSimulation& simulation, vtkUnstructuredGrid* grid,
    const BodySettings& settings, const std::function<bool()>& progress);

  /// Cuts the body where it is now along a sheet in its units, where that is another one than the
  /// last time.
  void Cut(const WorldSheet& sheet);
  /// Takes back the last cuts, but for so many: the body is as it was before, its time is not.
  void RemoveCuts(std::size_t left);
  /// The same after an error: the sheet that has made them is to cut again.
  void TakeBackNewCuts(std::size_t left);
  /// For a body in an unknown state: the next Update() begins with a new one.
  void Lose();
  std::size_t GetNumberOfCuts() const { return this->Cuts.size(); }
  std::int64_t GetNumberOfSplitFaces() const;

  /// Puts the body to rest.
  void Reset();

  bool HasBody() const { return this->Exists; }
  /// As it is cut.
  const BodyMesh& GetMesh() const { return this->Mesh; }
  const BodySettings& GetSettings() const { return this->Settings; }

  /// The grid with the nodes that mid-sides and cuts have appended: the grid itself where there are
  /// none. It has the same points and cells as long as the mesh is unchanged.
  vtkUnstructuredGrid* GetGrid(vtkUnstructuredGrid* grid);

  double Time = 0.0;     // in s
  bool HasMoved = false; // whether there is something to lose

private:
  struct AppliedCut
  {
    std::vector<Tetrahedron> Tetrahedra;
    std::vector<MidSideNodes> MidSides; // empty: the body is not quadratic
    std::vector<std::int32_t> Origins;  // of all copies of nodes
    std::vector<TetrahedronPair> Unparted;
    std::int64_t NumberOfFaces = 0;
    ElasticSimulation::State Before;
  };

  /// A body with the cuts that there are.
  BodyMesh WithCuts(const BodyMesh& whole) const;
  /// The node of the body without cuts that a node is, or is a copy of.
  std::size_t GetOrigin(std::size_t node) const;
  void FillMesh(vtkUnstructuredGrid* grid, vtkUnstructuredGrid* made) const;
  void FillPointData(vtkUnstructuredGrid* grid, vtkUnstructuredGrid* made) const;

  bool Exists = false;
  bool WasLost = false;                    // what was simulated, in a call that has failed
  ElasticSimulation* Simulation = nullptr; // that the body was given to
  Stamp BodyStamp;
  BodySettings Settings;
  BodyMesh Whole;
  BodyMesh Mesh;
  std::vector<AppliedCut> Cuts;
  WorldSheet Sheet; // the last one
  vtkSmartPointer<vtkUnstructuredGrid> MadeGrid;
  Stamp MadeMeshStamp;           // of the points and cells that it was made of
  Stamp MadeDataStamp;           // of the arrays
  std::uint64_t MeshVersion = 0; // changes with the nodes and tetrahedra of the body
  std::uint64_t MadeVersion = 0; // that of the grid
};

} // namespace deformvolume

#endif
