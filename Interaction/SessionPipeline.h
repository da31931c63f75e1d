// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSessionPipeline_h
#define DeformVolumeSessionPipeline_h

#include "SessionEvents.h"

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
class vtkLatticeTetrahedraSource;
class vtkMassSpringDeformation;
class vtkPolyData;
class vtkUnstructuredGrid;
class vtkVolumeEditAlgorithm;

namespace deformvolume
{

/// The filters of a session, and what has been done to them. One thread at a time may use it.
///
/// What is done is a list of actions.
class SessionPipeline
{
public:
  SessionPipeline();
  ~SessionPipeline();
  SessionPipeline(const SessionPipeline&) = delete;
  void operator=(const SessionPipeline&) = delete;

  /// Forgets everything. Without a mesh there is a lattice. Both must stay as they are.
  void SetInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh);

  /// Throws std::runtime_error. Actions are then as they were; where the model or the lattice
  /// cannot be changed, the body comes from rest again.
  void Apply(const SessionEvent& event);

  /// One step of the simulation. Where a handle cannot be where it is wanted, handles go back to
  /// where they were, and std::runtime_error is thrown; where that is not possible either, the body
  /// comes from rest, and as the last resort nothing holds it. Returns whether it still moves.
  bool Step();

  struct Sampling
  {
    int Factor = 1;
    int Padding = 8;
    double BackgroundValue = 0.0;
  };
  /// Throws std::runtime_error.
  vtkImageData* Resample(const Sampling& sampling);

  vtkImageData* GetVolume() { return this->Volume; }
  vtkDataSet* GetDeformation();
  vtkDeformVolumeFilter* GetResampler() { return this->Resampler; }
  int GetModel() const { return this->Model; }
  /// By ChainMail, in the last step.
  vtkIdType GetNumberOfMovedVoxels();
  /// Of the finite elements, in the last step; 0 with other models.
  double GetRelativeResidual();
  std::size_t GetNumberOfActions() const { return this->Done.size(); }
  std::size_t GetNumberOfUndoneActions() const { return this->Undone.size(); }
  /// What the filters have warned of since the last call.
  std::vector<std::string> TakeWarnings() { return std::exchange(this->Warnings, {}); }
  struct Handle
  {
    int Number;
    glm::dvec3 Rest;
    glm::dvec3 Now;
    bool IsGrabbed;
  };
  /// Those that hold something, in the order in which they were grabbed.
  std::vector<Handle> GetHandles() const;
  /// The settings, as events that make them.
  SessionEvents GetSettings() const;

private:
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
    glm::dvec3 ToNode{ 0.0 }; // from Rest to the nearest node of the mesh that can move
    bool IsGrabbed = false;
    bool IsHeld = false;
    vtkSmartPointer<vtkPolyData> RestSheet;
    int NumberOfEdits = 1;
    bool HasSplit = false; // whether a cut has split the mesh
    int Model = 0;
    int FormerModel = 0;
    // Where ChainMail had all voxels before the action, and when it was undone; -1: not known.
    vtkIdType Before = -1;
    vtkIdType After = -1;
  };
  using Actions = std::vector<Action>;

  void BeginGrab(double handle, const glm::dvec3& position);
  void TryBeginGrab(double handle, const glm::dvec3& position);
  void StepBack();
  Action& FindHandle(double handle, bool isGrabbed);
  void Release(double handle);
  void Cut(const SessionEvent& event);
  void Carve(const SessionEvent& event);
  void SetModel(int model);
  void SetLattice(int nodes);
  void Do(Action action);
  void Undo();
  void Redo();
  void UndoEdits(vtkVolumeEditAlgorithm* filter, int edits);
  void RedoEdits(vtkVolumeEditAlgorithm* filter, int edits);
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
  bool IsUsed(vtkIdType point);
  /// Warns once where a handle has pulled tissue out of the output.
  void CheckHandles();
  glm::dvec3 FindWayToNode(const glm::dvec3& rest);
  glm::dvec3 GetShift(const Action& drag);
  void Update(vtkAlgorithm* filter);
  void Connect();
  void MakeStill();
  void TakeRestMesh();
  bool FindMotion();
  vtkAlgorithm* GetModelFilter();
  vtkElasticDeformation* GetElastic();

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh; // that was given, or null
  vtkSmartPointer<vtkUnstructuredGrid> RestMesh;
  bool IsMeshOfElements = false;              // whether the rest mesh is that of finite elements
  vtkSmartPointer<vtkUnstructuredGrid> Still; // the deformation that does not deform
  vtkNew<vtkCutVolume> CutFilter;
  vtkNew<vtkCarveVolume> CarveFilter;
  vtkNew<vtkChainMailDeformation> ChainMail;
  vtkNew<vtkMassSpringDeformation> MassSpring;
  vtkNew<vtkFiniteElementDeformation> Elements;
  vtkNew<vtkDeformVolumeFilter> Resampler;
  vtkNew<vtkCallbackCommand> ErrorObserver;
  vtkNew<vtkCallbackCommand> WarningObserver;
  std::string Message; // the first error of the filters, since it was taken
  std::vector<std::string> Warnings;
  bool HasWarnedOfPadding = false;

  int Model = 0;
  int NumberOfNodes = 7;
  double HandleRadius = 0.0;
  int RelaxationSweeps = 5;
  double UndoMemory = 1073741824.0;
  bool IsStroke = false;    // whether a carving may go on
  std::set<double> Refused; // handles that could not be grabbed
  Actions Done;
  Actions Undone;
  std::vector<double> LastVectors; // of a mesh
  int QuietSteps = 0;
  bool IsToRebuild = false; // whether the body has to come from rest before it is used
};

} // namespace deformvolume

#endif
