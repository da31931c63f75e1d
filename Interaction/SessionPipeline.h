// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSessionPipeline_h
#define DeformVolumeSessionPipeline_h

#include "SessionEvents.h"
#include "SessionPositions.h"

#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <glm/vec3.hpp>

#include <set>
#include <string>
#include <utility>
#include <vector>

class vtkAlgorithm;
class vtkCallbackCommand;
class vtkCarveVolume;
class vtkChainMailDeformation;
class vtkFiniteElementDeformation;
class vtkCutVolume;
class vtkDataSet;
class vtkDeformVolumeFilter;
class vtkElasticDeformation;
class vtkImageData;
class vtkMassSpringDeformation;
class vtkPolyData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// The filters of a session, and the list of the actions that can be undone and redone. Only one
/// thread at a time may use it.
class SessionPipeline
{
public:
  SessionPipeline();
  ~SessionPipeline();
  SessionPipeline(const SessionPipeline&) = delete;
  void operator=(const SessionPipeline&) = delete;

  /// Begins a new session. mesh: null for a lattice. Volume and mesh must not be modified any more.
  void SetInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh);

  /// Applies an event. Throws std::runtime_error if the event fails; the actions are then the same
  /// as before. If the model or the lattice cannot be changed, the body is rebuilt from rest.
  void Apply(const SessionEvent& event);

  /// Simulates one step. Returns whether the body still moves. If the positions of the handles are
  /// not possible, handles return to their last possible positions, and std::runtime_error is
  /// thrown. If that fails as well, the body is rebuilt from rest, and if necessary all handles are
  /// released.
  bool Step();

  struct Sampling
  {
    int Factor = 1;
    int Padding = 8;
    double BackgroundValue = 0.0;
    std::set<std::string> CategoricalArrays;
  };
  /// Returns the deformed volume. Throws std::runtime_error if a filter fails.
  vtkImageData* Resample(const Sampling& sampling);
  /// Returns the deformed volume. If sides of a cut may overlap, it has the array RestPosition,
  /// which FindRestPosition() needs.
  vtkImageData* ResampleForSearch(const Sampling& sampling);

  vtkImageData* GetVolume() { return this->Volume; }
  vtkDataSet* GetDeformation();
  /// Returns the position at rest of the tissue at a position. Where the sides of a cut overlap,
  /// this is the side that the output of ResampleForSearch() shows.
  glm::dvec3 FindRestPosition(const glm::dvec3& deformed, const Sampling& sampling);
  int GetModel() const { return this->Model; }
  /// Number of voxels that ChainMail has moved in the last step; 0 with other models.
  vtkIdType GetNumberOfMovedVoxels();
  /// Residual of the finite elements after the last step; 0 with other models.
  double GetRelativeResidual();
  std::size_t GetNumberOfActions() const { return this->Done.size(); }
  std::size_t GetNumberOfUndoneActions() const { return this->Undone.size(); }
  /// Returns the warnings of the filters since the last call.
  std::vector<std::string> TakeWarnings() { return std::exchange(this->Warnings, {}); }
  struct Handle
  {
    int Number;
    glm::dvec3 Rest;
    glm::dvec3 Now;
    bool IsGrabbed;
  };
  /// The handles that hold tissue, in the order in which they were grabbed.
  std::vector<Handle> GetHandles() const;
  /// The settings, as events that set them.
  SessionEvents GetSettings() const;

private:
  // A node that a handle holds.
  struct NodeOfHandle
  {
    vtkIdType Id; // of the output of the elastic filter
    glm::dvec3 Rest;
    glm::dvec3 Offset; // from the handle to the node
  };
  struct Action
  {
    enum KindType
    {
      DRAG,
      RELEASE,
      CUT,
      CARVE,
      MODEL
    };
    KindType Kind = DRAG;
    double Handle = 0.0;
    glm::dvec3 Rest{ 0.0 };
    glm::dvec3 Now{ 0.0 };
    glm::dvec3 LastPossible{ 0.0 };
    std::vector<NodeOfHandle> Nodes; // with an elastic model
    bool IsGrabbed = false;
    bool IsHeld = false;
    vtkSmartPointer<vtkPolyData> RestSheet;
    int NumberOfEdits = 1;
    bool HasSplit = false; // whether a cut has split the mesh
    vtkIdType NodesBeforeCut = 0;
    int Model = 0;
    int FormerModel = 0;
    // States of ChainMail before the action, and when it was undone (SaveState); -1: not saved.
    vtkIdType Before = -1;
    vtkIdType After = -1;
  };
  using Actions = std::vector<Action>;

  void BeginGrab(double handle, const glm::dvec3& position);
  void TryBeginGrab(double handle, const glm::dvec3& position);
  // Whether a voxel next to a rest position has tissue that was not carved out.
  bool HasTissue(const glm::dvec3& rest) const;
  // Throws if a handle holds no node, or only those of other handles.
  void CheckNodes(const Action& drag) const;
  void RestoreLastPossible();
  Action& FindHandle(double handle, bool isGrabbed);
  void Release(double handle);
  void Cut(const SessionEvent& event);
  void Carve(const SessionEvent& event);
  void SetModel(int model);
  void SetLattice(int nodes);
  void AddActionWithState(Action action);
  void AddAction(Action action);
  void Undo();
  void Redo();
  void CutMesh(
    vtkElasticDeformation* elastic, vtkPolyData* sheet, const Actions& held, Action& cut);
  void Reset();
  void EndGrabs();

  vtkIdType SaveState();
  void RestoreState(vtkIdType state);
  void ForgetStates(Action& action);
  void LimitStates();
  void Rebuild();
  Actions GetHeld() const;
  void UpdateModel(const Actions& held);
  void CheckDisplacements();
  /// Warns once if a handle lies outside the output.
  void CheckHandles();
  // Returns the nodes that a handle at a rest position holds, of those that can move: those within
  // the handle radius, or else those of the tetrahedron that contains the position, or else the
  // nearest one. Other handles may hold them, too.
  std::vector<NodeOfHandle> FindNodes(const glm::dvec3& rest);
  bool MayOverlap() const;
  vtkImageData* Resample(const Sampling& sampling, bool hasRestPositions);
  void Update(vtkAlgorithm* filter);
  void Connect();
  void MakeUndeformedMesh();
  void MakeRestMesh();
  bool UpdateMotion();
  vtkAlgorithm* GetModelFilter();
  vtkElasticDeformation* GetElastic();

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh; // of SetInputs(), or null
  vtkSmartPointer<vtkUnstructuredGrid> RestMesh;
  bool IsMeshOfElements = false; // whether RestMesh was made for finite elements
  vtkSmartPointer<vtkUnstructuredGrid> UndeformedMesh; // a mesh whose displacements are 0
  vtkNew<vtkCutVolume> CutFilter;
  vtkNew<vtkCarveVolume> CarveFilter;
  vtkNew<vtkChainMailDeformation> ChainMail;
  vtkNew<vtkMassSpringDeformation> MassSpring;
  vtkNew<vtkFiniteElementDeformation> Elements;
  vtkNew<vtkDeformVolumeFilter> Resampler;
  std::set<std::string> CategoricalArrays; // of Resampler
  PositionSearch Positions;
  vtkNew<vtkCallbackCommand> ErrorObserver;
  vtkNew<vtkCallbackCommand> WarningObserver;
  std::string Message; // first error of the filters in an update
  std::vector<std::string> Warnings;
  bool HasWarnedOfPadding = false;

  int Model = 0;
  int NodesPerAxis = 7;
  double HandleRadius = 0.0;
  int RelaxationSweeps = 5;
  double UndoMemory = 1073741824.0;
  bool IsStroke = false;            // whether CarveTo() continues a stroke
  std::set<double> RejectedHandles; // handles that could not be grabbed
  Actions Done;
  Actions Undone;
  std::vector<double> LastVectors; // displacements of the mesh after the last step
  int QuietSteps = 0;
  bool NeedsRebuild = false; // whether the body must be rebuilt from rest before it is used
};

} // namespace deformvolume

#endif
