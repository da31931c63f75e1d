// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformVolumeSession
 * @brief   drag, cut and carve a volume interactively, without a window
 *
 * vtkDeformVolumeSession is an interactive deformation without a user interface: it holds a volume
 * at rest, a model of its tissue, and all actions, and computes the deformed volume. It draws
 * nothing and needs no window, so that a viewer, a server or a script can control it.
 *
 * Positions are world coordinates of the deformed volume.
 *
 * @par Order of events:
 * Methods that change the session (the tools, Undo(), ChangeModel() and settings) add an event to
 * the pending events and return at once. Update() processes all pending events and one step of the
 * simulation. After Start(), a thread of the session repeats that while events are pending or the
 * body moves. If several moves of a handle are pending, it processes only the last one.
 * TakeOutput() returns the newest volume. All methods may be called while the thread is active, but
 * only by one thread at a time.
 *
 * @par Undo:
 * Each drag, cut, carving stroke, release of a handle, and change of the model is an action that
 * can be undone. Undo restores masks exactly. With ChainMail it also restores the positions of all
 * voxels before the action, if they have been kept (ChangeUndoMemory()); otherwise the body is
 * rebuilt from rest with the handles. A mesh moves by itself to where the remaining handles hold
 * it. When all actions are undone, the output is bitwise equal to the volume at rest. Redo restores
 * the positions of ChainMail before the undo. A mesh is rebuilt from rest when a cut is redone.
 *
 * @par Models:
 * NONE does not deform. CHAIN_MAIL is vtkChainMailDeformation: tissue stays where a handle leaves
 * it, and relaxes. MASS_SPRING and FINITE_ELEMENTS are vtkMassSpringDeformation and
 * vtkFiniteElementDeformation on the mesh of SetInputs(), or else on a vtkLatticeTetrahedraSource
 * whose first layer of nodes is fixed, in millimeters. MASS_SPRING refuses meshes whose cells are
 * not equal cubes. Tissue outside the mesh is not part of their output. A change of the model ends
 * all grabs, and keeps the handles of HoldGrab(), cuts and carvings. Cuts split meshes along the
 * faces of tetrahedra. Cuts that were made with another model, or that are redone, split the mesh
 * at rest. Carving removes voxels; the mesh of MASS_SPRING and FINITE_ELEMENTS keeps its
 * tetrahedra, and still connects what was carved apart.
 *
 * @par Output:
 * The vtkImageData of vtkDeformVolumeFilter, with the bounds of the volume at rest and Padding.
 * Each output is a separate object, whose arrays the session does not change while the caller holds
 * them.
 *
 * @par Files:
 * A session is saved as the record of its events, in XML with a version, a checksum, and a hash of
 * the volume and the mesh with their arrays. Loading a session replays the events. On the same
 * device, the result is bitwise equal if Padding, BackgroundValue, MovingSamplingFactor and the
 * categorical arrays, which files do not contain, are equal; and the same actions can be undone.
 * Files are written under a temporary name in the same folder, and renamed when they are complete.
 * They keep the permissions of the file that they replace. A symbolic link stays; the file it
 * refers to is replaced.
 *
 * @par Errors:
 * Each error is one vtkErrorMacro, which says what is wrong and what to do, and GetErrorMessage().
 * Observers of errors may call the session. An event that fails changes nothing, but ends a stroke
 * of CarveSphere(); if the model or the lattice cannot be changed, or if a simulation diverges or
 * moves a node by more than 16,383 voxels, the body is rebuilt from rest. If a step fails or a mesh
 * cannot be cut, handles return to their last possible positions. MoveGrab(), EndGrab() and
 * HoldGrab() of a handle that could not be grabbed have no effect. Errors of events are reported by
 * Update() and TakeOutput(). Errors are: no inputs; positions that are not finite, or outside the
 * volume; a handle that is not grabbed, or that cannot be moved so far; a sheet that is empty, not
 * made of triangles, or more than 2^31 voxels away; errors of the filters; files that cannot be
 * written or read, are damaged, or belong to another version or volume.
 *
 * @sa vtkDeformVolumeFilter vtkChainMailDeformation vtkCutVolume vtkCarveVolume
 */
#ifndef vtkDeformVolumeSession_h
#define vtkDeformVolumeSession_h

#include "vtkDeformVolumeInteractionModule.h" // for export macro
#include "vtkObject.h"
#include "vtkWrappingHints.h" // for VTK_NEWINSTANCE

#include <functional> // for std::function
#include <memory>     // for std::unique_ptr
#include <string>     // for std::string
#include <vector>     // for std::vector

class vtkDataSet;
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
   * Begin a session with a volume at rest, of at least two voxels on each axis and with active
   * point scalars that are not bits, and optionally a mesh, the input of vtkMassSpringDeformation
   * or vtkFiniteElementDeformation, without hidden cells and points. Removes all actions and
   * pending events, and sets the model to NONE. Settings do not change, and pending changes of
   * settings stay pending. The arrays of the volume are shared, and must not be modified; the mesh
   * is copied. Returns false after an error.
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
   * Set/Get the model of the tissue. GetModel() returns the model of the last update. Default NONE.
   */
  void ChangeModel(int model);
  int GetModel();
  ///@}

  ///@{
  /**
   * Grab the tissue at a position, move the handle, and end the grab. BeginGrab() returns the
   * number of the handle, or -1 if there is no volume or a number is not finite; other errors, such
   * as a position without tissue, are reported by the next update. MASS_SPRING and
   * FINITE_ELEMENTS hold the nodes within the radius of ChangeHandleRadius() or, if there are none,
   * those of the tetrahedron at the position, whose fixed nodes do not follow. If none of them can
   * move, they hold the nearest node that can. With the model NONE a grab has no effect. Several
   * handles may be grabbed at the same time. EndGrab() removes the handle. HoldGrab() ends the grab
   * and keeps the handle at its position; Release() removes such a handle.
   */
  int BeginGrab(double x, double y, double z);
  /// Move the handle with this number.
  void MoveGrab(int handle, double x, double y, double z);
  /// End the grab, and remove the handle.
  void EndGrab(int handle);
  /// End the grab, and keep the handle at its position.
  void HoldGrab(int handle);
  /// Remove a handle that HoldGrab() has kept.
  void Release(int handle);
  ///@}

  /**
   * Hold the tissue at its position: BeginGrab() and HoldGrab(). Returns the number of the handle,
   * or -1 after an error.
   */
  int Pin(double x, double y, double z);

  /**
   * Cut along a sheet of triangles, which is copied; its vertices and lines are ignored. NONE and
   * CHAIN_MAIL divide the tetrahedra that the sheet crosses (SmoothCut of vtkCutVolume): no tissue
   * is lost, and a cut is visible only when it opens. The other models split their mesh along the
   * faces of its tetrahedra.
   */
  void Cut(vtkPolyData* sheet);

  ///@{
  /**
   * Carve out a sphere, which begins a stroke, and continue the stroke: CarveTo() carves the region
   * that the sphere sweeps from its last position. The surface passes between the voxels
   * (SmoothBoundary of vtkCarveVolume). Any event of another kind ends the stroke. A stroke is one
   * action. With another radius than before, CarveTo() sweeps with the new one.
   */
  void CarveSphere(double x, double y, double z, double radius);
  /// Continue the stroke: carve what the sphere sweeps from its last position.
  void CarveTo(double x, double y, double z, double radius);
  ///@}

  ///@{
  /**
   * Undo the last action, redo the last undone action, or undo all actions. Ends the grabs of all
   * handles. Without an action, nothing else happens.
   */
  void Undo();
  /// Redo the last action that was undone.
  void Redo();
  /// Undo all actions.
  void Reset();
  ///@}

  /**
   * Get the handles that hold tissue after the last update: a point at the position of each handle,
   * with the point arrays "Handle" (its number), "RestPosition" (3 components, the rest position of
   * the tissue that it holds) and "Grabbed" (0 after HoldGrab()). vtkChainMailDeformation and
   * vtkElasticDeformation read handles in this form. The contents of the argument are replaced.
   */
  void GetHandles(vtkPolyData* handles);

  ///@{
  /**
   * Get the number of actions that can be undone and redone after the last update.
   */
  vtkIdType GetNumberOfActions();
  vtkIdType GetNumberOfUndoneActions();
  ///@}

  ///@{
  /**
   * Change settings, by events that cannot be undone:
   * - the radius within which a handle holds voxels or nodes, in world units (initially 0). With a
   *   mesh it applies to handles that are grabbed later, with CHAIN_MAIL to all handles,
   * - the sweeps of relaxation in a step of ChainMail, 0 to 10000 (initially 5),
   * - the maximum number of nodes of the lattice on an axis, 2 to 100 (initially 7); with
   *   FINITE_ELEMENTS this number includes mid-side nodes, and is at least 3,
   * - the memory for positions of voxels that ChainMail restores, in bytes (initially 1 GiB).
   */
  void ChangeHandleRadius(double radius);
  /// Change the sweeps of relaxation in a step of ChainMail, 0 to 10000 (initially 5).
  void ChangeRelaxationSweeps(int sweeps);
  /// Change the maximum number of nodes of the lattice on an axis, 2 to 100 (initially 7).
  void ChangeNumberOfNodes(int nodes);
  /// Change the memory for positions that ChainMail restores, in bytes (initially 1 GiB).
  void ChangeUndoMemory(double bytes);
  ///@}

  ///@{
  /**
   * Set/Get the SamplingFactor of vtkDeformVolumeFilter while the body moves: 1, 2 or 4. Other
   * values are errors and change nothing. If less than two voxels would remain on an axis, a
   * smaller factor is used. At rest, the output has full resolution. Default 1.
   */
  void SetMovingSamplingFactor(int factor);
  int GetMovingSamplingFactor();
  ///@}

  ///@{
  /**
   * Set/Get the width of the border of the output around the volume at rest, in voxels, for tissue
   * that is pulled out. The next output uses it: a change alone makes no output. Default 8, 0 to
   * 1000.
   */
  void SetPadding(int voxels);
  int GetPadding();
  ///@}

  ///@{
  /**
   * Set/Get the value of uncovered voxels of the output, in all arrays (BackgroundValue of
   * vtkDeformVolumeFilter). SetInputs() sets it to the minimum of the first component of the
   * scalars, which is air in CT, but to 0 if the minimum is greater than 0. The next output uses a
   * new value.
   */
  void SetBackgroundValue(double value);
  double GetBackgroundValue();
  ///@}

  ///@{
  /**
   * Add the name of a point array of the volume that holds labels, which are not interpolated; or
   * remove all names (see vtkDeformVolumeFilter). The next output uses a change. Initially there is
   * none.
   */
  void AddCategoricalArray(const std::string& name);
  /// Remove all names.
  void ClearCategoricalArrays();
  ///@}

  /**
   * Process the pending events, simulate one step, and compute an output, in the thread of the
   * caller. Returns whether the body still moves. It is an error to call it between Start() and
   * Stop().
   */
  bool Update();

  ///@{
  /**
   * Start/Stop a thread of the session that calls Update() repeatedly. Stop() waits for the end of
   * a step; pending events stay pending. The destructor calls Stop().
   */
  void Start();
  /// Stop the thread of the session, after the end of a step. Pending events stay pending.
  void Stop();
  bool GetIsRunning();
  ///@}

  /**
   * Get whether events are pending or the body moves.
   */
  bool GetIsBusy();

  /**
   * Get the newest output, or null if it was taken already. The caller must delete it (Python does
   * so automatically). Reports errors of events.
   */
  VTK_NEWINSTANCE vtkImageData* TakeOutput();

  /**
   * Get a copy of the deformation after the last update, or null after an error: a
   * vtkImageData or a vtkUnstructuredGrid, at rest, with the displacements as active vectors. By
   * it vtkDeformGeometryFilter moves surfaces and landmarks, and vtkDeformVolumeFilter other
   * volumes. It does not contain cuts and carvings, except that the mesh of MASS_SPRING and
   * FINITE_ELEMENTS is split by cuts. Waits for the end of a step. The caller must delete it
   * (Python does so automatically).
   */
  VTK_NEWINSTANCE vtkDataSet* CopyDeformation();

  ///@{
  /**
   * Get the value at a position of the deformed volume (the first component of the scalars), and
   * its rest position. Where the sides of a cut overlap, both are those of the visible side.
   * Probe() returns false if no tissue is there. It waits for the end of a step.
   */
  bool Probe(double x, double y, double z);
  vtkGetMacro(ProbedValue, double);
  vtkGetVector3Macro(ProbedRestPosition, double);
  ///@}

  ///@{
  /**
   * Write the record of all events to a file, or replay the record of a file (ProgressEvent reports
   * the progress). SaveSession() processes pending events first; LoadSession() discards them. Both
   * return false after an error, which does not change the session or an existing file. The
   * functions that return the state of the last update, such as GetModel(), GetHandles() and
   * TakeOutput(), know the loaded session after the next Update() or step of the thread.
   */
  bool SaveSession(const std::string& fileName);
  /// Replay the record of a file. Returns false after an error.
  bool LoadSession(const std::string& fileName);
  ///@}

  ///@{
  /**
   * Write the deformed volume at full resolution, or the deformed mesh of the model. The file name
   * must end in .vti or .vtu, respectively. Both return false after an error.
   */
  bool SaveVolume(const std::string& fileName);
  /// Write the deformed mesh of the model as .vtu. Returns false after an error.
  bool SaveMesh(const std::string& fileName);
  ///@}

  ///@{
  /**
   * Get the durations of the last update, in seconds: of the events and the step, and of
   * resampling; and the number of steps since SetInputs().
   */
  double GetSimulationTime();
  double GetResamplingTime();
  vtkIdType GetNumberOfSteps();
  ///@}

  /**
   * Get the number of voxels that ChainMail has moved in the last step; 0 with other models.
   */
  vtkIdType GetNumberOfMovedVoxels();

  /**
   * Get the distance of the finite elements from equilibrium: the largest residual force on a node,
   * divided by the largest force that is applied to or holds a node; 0 with other models.
   */
  double GetRelativeResidual();

  /**
   * Get the message of the last error; "" if there was none.
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
  bool UsePipeline(const std::function<bool()>& body);
  bool Save(const std::string& fileName, const char* suffix, const std::function<bool()>& write);

  double ProbedValue = 0.0;
  double ProbedRestPosition[3] = { 0.0, 0.0, 0.0 };
  std::string ErrorMessage;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
