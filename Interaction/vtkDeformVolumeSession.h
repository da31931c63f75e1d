// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformVolumeSession
 * @brief   drag, cut and carve a volume live, without a window
 *
 * vtkDeformVolumeSession does the work of an interactive program: it holds a volume at rest, a
 * model of its tissue, and everything that was done to it, and gives the deformed volume. It draws
 * nothing and needs no window, so that a viewer, a server or a script can drive it.
 *
 * Places are world coordinates of the deformed volume, as it is seen.
 *
 * @par Order of events:
 * Methods that change something (the tools, Undo(), ChangeModel() and the settings below it) put an
 * event into a queue and return at once. Update() makes all events that wait and one step of the
 * simulation. After Start() a thread of the session does that as often as something moves; of
 * several moves of a handle that wait it takes the last one. TakeOutput() gives the newest volume.
 * All methods may be called while the thread runs, by one thread at a time.
 *
 * @par Undo:
 * Each drag, cut, stroke of carving, release of a handle, and change of the model is an action that
 * can be undone. Undo takes masks back to the last bit, and with ChainMail all voxels to where they
 * were before the action (as far as ChangeUndoMemory() lets that be kept; else the body
 * comes from rest to where handles hold it). A mesh moves by itself to where the remaining actions
 * hold it. When all actions are undone, the output is the volume at rest, to the last bit. Redo
 * takes ChainMail to where it was before the undo; a mesh that is cut again comes from rest.
 *
 * @par Models:
 * NONE does not deform. CHAIN_MAIL is vtkChainMailDeformation: tissue stays where a handle leaves
 * it, and relaxes. MASS_SPRING and FINITE_ELEMENTS are vtkMassSpringDeformation and
 * vtkFiniteElementDeformation on the mesh that SetInputs() was given, or else on a
 * vtkLatticeTetrahedraSource with the first layer of nodes fixed, in millimetres. MASS_SPRING
 * refuses meshes of other cells than equal cubes. A change of the model keeps handles, cuts and
 * carvings. Cuts split meshes along the faces of tetrahedra; those that were made with another
 * model, or undone and made again, split the mesh at rest.
 *
 * @par Output:
 * vtkImageData as vtkDeformVolumeFilter makes it, with the bounds of the volume at rest and
 * Padding. Each output is an object of its own, which the session never changes as long as somebody
 * holds it; memory that nobody holds is used again.
 *
 * @par Files:
 * A session is saved as the record of its events, in XML with a version, a checksum, and a hash of
 * the volume and the mesh. Loading replays them: the result is the same to the last bit on the same
 * device, with all that can be undone. Files are written under another name in the same folder, and
 * renamed when they are complete.
 *
 * @par Errors:
 * Each is one vtkErrorMacro that says what is wrong and what to do, and GetErrorMessage(). The
 * event that failed has then changed nothing; only where the model or the lattice cannot be
 * changed, or a simulation has diverged, the body comes from rest again. What is called for a
 * handle that could not be grabbed does nothing. Errors of events are reported by Update() and
 * TakeOutput(): no inputs; places that are not finite, or where there is nothing to grab; a handle
 * that is not grabbed, or cannot go so far; a sheet that is empty or not made of triangles; what
 * the filters report; files that cannot be written or read, are damaged, or are of another version
 * or volume.
 *
 * @sa vtkDeformVolumeFilter vtkChainMailDeformation vtkCutVolume vtkCarveVolume
 */
#ifndef vtkDeformVolumeSession_h
#define vtkDeformVolumeSession_h

#include "vtkDeformVolumeInteractionModule.h" // for export macro
#include "vtkObject.h"
#include "vtkWrappingHints.h" // for VTK_NEWINSTANCE

#include <memory> // for std::unique_ptr
#include <string> // for std::string
#include <vector> // for std::vector

class vtkImageData;
class vtkPolyData;
class vtkUnstructuredGrid;

class VTKDEFORMVOLUMEINTERACTION_EXPORT vtkDeformVolumeSession : public vtkObject
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkDeformVolumeSession* New();
  vtkTypeMacro(vtkDeformVolumeSession, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  /**
   * Begin with a volume at rest, of at least two voxels on each axis, and, if it is not null, with
   * a mesh of vtkTetra cells for the models that need one, as vtkElasticDeformation reads it. What
   * was done before is forgotten, the model is NONE, and settings stay. The arrays of the volume
   * are shared, and must not change; the mesh is copied. False after an error.
   */
  bool SetInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh = nullptr);

  /**
   * The models of the tissue, see ChangeModel().
   */
  enum Models
  {
    NONE = 0,
    CHAIN_MAIL = 1,
    MASS_SPRING = 2,
    FINITE_ELEMENTS = 3
  };

  ///@{
  /**
   * The model of the tissue. GetModel() gives the one of the last update. Default NONE.
   */
  void ChangeModel(int model);
  int GetModel();
  ///@}

  ///@{
  /**
   * Take hold of the tissue at a place, move the handle, and let go. BeginGrab() returns the number
   * of the handle, -1 after an error. Several handles may be grabbed. HoldGrab() ends a grab and
   * leaves the handle where it is; Release() removes such a handle.
   */
  int BeginGrab(double x, double y, double z);
  void MoveGrab(int handle, double x, double y, double z);
  void EndGrab(int handle);
  void HoldGrab(int handle);
  void Release(int handle);
  ///@}

  /**
   * Hold the tissue at a place where it is: BeginGrab() and HoldGrab().
   */
  int Pin(double x, double y, double z);

  /**
   * Cut along a sheet of triangles. It is copied. NONE and CHAIN_MAIL divide what the sheet crosses
   * (SmoothCut of vtkCutVolume), so that nothing is lost and a cut is seen when it opens; the other
   * models split their mesh along the faces of its tetrahedra.
   */
  void Cut(vtkPolyData* sheet);

  ///@{
  /**
   * Carve out a sphere, which begins a stroke, and go on with the stroke: what a sphere sweeps from
   * its last place. The surface passes between the voxels (SmoothBoundary of vtkCarveVolume). A
   * stroke ends with any event of another kind, and is undone as one.
   */
  void CarveSphere(double x, double y, double z, double radius);
  void CarveTo(double x, double y, double z, double radius);
  ///@}

  ///@{
  /**
   * Undo the last action, redo the one that was undone last, or undo all. A handle that is grabbed
   * is let go. Nothing happens where there is none.
   */
  void Undo();
  void Redo();
  void Reset();
  ///@}

  /**
   * The handles that hold something after the last update: a point where each of them is, with the
   * point arrays "Handle" (its number), "RestPosition" (3 components, the place at rest that it
   * holds) and "Grabbed" (0 once it is left where it is). vtkChainMailDeformation and
   * vtkElasticDeformation read handles in this form. What handles held is replaced.
   */
  void GetHandles(vtkPolyData* handles);

  ///@{
  /**
   * Actions that can be undone and redone after the last update.
   */
  vtkIdType GetNumberOfActions();
  vtkIdType GetNumberOfUndoneActions();
  ///@}

  ///@{
  /**
   * Settings, which are events but cannot be undone: how far round its place a handle holds voxels
   * or nodes, in world units (initially 0); sweeps of relaxation in a step of ChainMail, 0 to 10000
   * (initially 5); the most nodes of the lattice on an axis, 2 to 100 (initially 7), with those in
   * the middle of edges that finite elements have, but at least 3 there; bytes that may be kept of
   * where ChainMail had voxels before actions (initially 1 GiB).
   */
  void ChangeHandleRadius(double radius);
  void ChangeRelaxationSweeps(int sweeps);
  void ChangeNumberOfNodes(int nodes);
  void ChangeUndoMemory(double bytes);
  ///@}

  ///@{
  /**
   * SamplingFactor of vtkDeformVolumeFilter while something moves: 1, 2 or 4; others are errors.
   * The output is at full resolution again when the body rests. Default 1.
   */
  void SetMovingSamplingFactor(int factor);
  int GetMovingSamplingFactor();
  ///@}

  ///@{
  /**
   * Voxels of the output beyond the volume at rest on each side, for tissue that is pulled out.
   * Default 8, 0 to 1000.
   */
  void SetPadding(int voxels);
  int GetPadding();
  ///@}

  ///@{
  /**
   * What voxels of the output get that nothing covers, in every array, as by BackgroundValue of
   * vtkDeformVolumeFilter. SetInputs() sets it to the least value of the first component of the
   * scalars, which is air in CT, or to 0 where that is less.
   */
  void SetBackgroundValue(double value);
  double GetBackgroundValue();
  ///@}

  /**
   * Make the events that wait, one step of the simulation, and an output, in the thread of the
   * caller. Returns whether the body still moves. An error while the thread of the session runs.
   */
  bool Update();

  ///@{
  /**
   * Have a thread of the session do it. Stop() waits for the end of a step; what waits stays in the
   * queue. A session that is deleted stops by itself.
   */
  void Start();
  void Stop();
  bool GetIsRunning();
  ///@}

  /**
   * Whether events wait, or something moves.
   */
  bool GetIsBusy();

  /**
   * The output, if there is one that was not taken yet, else null. It belongs to the caller (Python
   * sees to that by itself). Errors of events are reported here.
   */
  VTK_NEWINSTANCE vtkImageData* TakeOutput();

  ///@{
  /**
   * What is seen at a place: false where there is nothing. Otherwise the first component of the
   * scalars of the voxel there, and its place at rest. It waits for the end of a step.
   */
  bool Probe(double x, double y, double z);
  vtkGetMacro(ProbedValue, double);
  vtkGetVector3Macro(ProbedRestPosition, double);
  ///@}

  ///@{
  /**
   * Write the record of all events to a file, and replay one (ProgressEvent tells how far that is).
   * Before it is saved, events that wait are made; before another is loaded, they are dropped.
   * False after an error: the session and an old file are then as they were.
   */
  bool SaveSession(const std::string& fileName);
  bool LoadSession(const std::string& fileName);
  ///@}

  ///@{
  /**
   * Write the deformed volume at full resolution (.vti), or the deformed mesh of the model (.vtu).
   * False after an error.
   */
  bool SaveVolume(const std::string& fileName);
  bool SaveMesh(const std::string& fileName);
  ///@}

  ///@{
  /**
   * Seconds that the last update took: for the events and the step, and for the resampling. How
   * many steps there were since SetInputs().
   */
  double GetSimulationTime();
  double GetResamplingTime();
  vtkIdType GetNumberOfSteps();
  ///@}

  /**
   * Voxels that ChainMail has moved in the last step; 0 with other models.
   */
  vtkIdType GetNumberOfMovedVoxels();

  /**
   * How far the finite elements are from equilibrium: the largest force that is left on a node, as
   * a part of the largest force that is applied or holds a node; 0 with other models.
   */
  double GetRelativeResidual();

  /**
   * The last error in words; "" where there was none.
   */
  vtkGetMacro(ErrorMessage, std::string);

protected:
  vtkDeformVolumeSession();
  ~vtkDeformVolumeSession() override;

private:
  vtkDeformVolumeSession(const vtkDeformVolumeSession&) = delete;
  void operator=(const vtkDeformVolumeSession&) = delete;

  void Report(const std::string& message);
  void ReportErrors();
  bool CheckInputs();
  bool CheckFinite(const std::vector<double>& numbers);
  bool Enqueue(int kind, const std::vector<double>& numbers = {});
  bool Save(const std::string& fileName, bool isMesh);

  double ProbedValue = 0.0;
  double ProbedRestPosition[3] = { 0.0, 0.0, 0.0 };
  std::string ErrorMessage;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
