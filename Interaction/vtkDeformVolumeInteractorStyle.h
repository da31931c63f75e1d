// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformVolumeInteractorStyle
 * @brief   mouse and keyboard tools of vtkDeformVolumeSession
 *
 * vtkDeformVolumeInteractorStyle controls a session by mouse and keyboard: it finds the visible
 * voxel under the cursor, turns mouse movements into events of the session, and shows each new
 * output. To use it in a viewer, set it as the style of the interactor, and give it the session and
 * the vtkVolume that shows the output.
 *
 * @par Buttons:
 * The left button uses the tool. The right button rotates the camera, the middle one pans it. The
 * wheel changes a parameter of the tool, or else zooms.
 * - TURN: rotates the camera.
 * - GRAB: drags the visible voxel under the cursor in the plane of the view. The wheel moves it in
 *   depth. If Shift is pressed when the button is released, the handle stays there.
 * - CUT: cuts along a stroke of the cursor. The sheet extends from the stroke along the lines of
 *   sight, to CutDepth below the visible voxels. The wheel changes CutDepth.
 * - CARVE: sweeps a sphere of CarveRadius over visible voxels. The wheel changes CarveRadius.
 * - PROBE: shows the value under the cursor, its position, and its position at rest.
 * - MEASURE: measures the distance between two positions that are clicked.
 *
 * @par Keys:
 * t g c v b m choose these tools; 1 2 3 4 choose the models NONE, CHAIN_MAIL, MASS_SPRING and
 * FINITE_ELEMENTS. p pins the tissue under the cursor, x releases the handle under the cursor. u
 * undoes, y redoes, z undoes everything. + and - act like the wheel with CUT and CARVE. r resets
 * the camera, h shows help, q ends the interaction. Texts need VTK's module RenderingFreeType.
 *
 * @par Visible voxels:
 * With PickMode OPACITY, voxels along a ray absorb light, by the scalar opacity of the property of
 * Volume. The visible voxel is the one at which half of the light that the ray loses in total has
 * been absorbed. No voxel is visible if the ray loses less than a tenth of its light. Without
 * Volume, the first voxel that the body covers is visible. With ISOSURFACE, the first voxel whose
 * value is at least Isovalue is visible; with SLICES, the first voxel on one of the slice planes.
 * Values are the first component of the scalars.
 *
 * @par Events:
 * UpdateDataEvent: after each new output. UpdateInformationEvent: when the status text that the
 * window shows has changed.
 * StartInteractionEvent and EndInteractionEvent: when the button of a tool is pressed and released.
 *
 * @par Errors:
 * Using a tool without an interactor, a renderer or a session is an error (vtkErrorMacro). Errors
 * of the session are shown as GetMessage().
 *
 * @sa vtkDeformVolumeSession vtkInteractorEventRecorder
 */
#ifndef vtkDeformVolumeInteractorStyle_h
#define vtkDeformVolumeInteractorStyle_h

#include "vtkDeformVolumeInteractionModule.h" // for export macro
#include "vtkInteractorStyleTrackballCamera.h"

#include <memory> // for std::unique_ptr
#include <string> // for std::string

class vtkDeformVolumeSession;
class vtkImageData;
class vtkVolume;

class VTKDEFORMVOLUMEINTERACTION_EXPORT vtkDeformVolumeInteractorStyle
  : public vtkInteractorStyleTrackballCamera
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkDeformVolumeInteractorStyle* New();
  vtkTypeMacro(vtkDeformVolumeInteractorStyle, vtkInteractorStyleTrackballCamera);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  ///@{
  /**
   * Set/Get the session. Default null. A drag with the former session ends.
   */
  virtual void SetSession(vtkDeformVolumeSession* session);
  vtkDeformVolumeSession* GetSession();
  ///@}

  ///@{
  /**
   * Set/Get the vtkVolume that shows the outputs. Its mapper, a vtkVolumeMapper, gets each new
   * output, and its user matrix gets direction and origin of the output, and the signs of its
   * spacing. Default null.
   */
  virtual void SetVolume(vtkVolume* volume);
  vtkVolume* GetVolume();
  ///@}

  ///@{
  /**
   * Start/Stop the thread of the session, and a timer of the interactor that calls Poll(). Without
   * them, each Poll() also updates the session. StopSession() waits for the end of a step. It
   * destroys the timer, and must not be called by an observer of this timer's event or of
   * UpdateDataEvent.
   */
  void StartSession();
  /// Stop the thread of the session, after the end of a step, and destroy the timer.
  void StopSession();
  ///@}

  /**
   * Show the newest output, if there is one, and render if anything has changed. Called for each
   * TimerEvent. If the thread of the session does not run, but the session is busy, calls its
   * Update() first. Returns whether the window was rendered.
   */
  bool Poll();

  /**
   * The tools of the left button, see SetTool().
   */
  enum Tools
  {
    TURN = 0,
    GRAB = 1,
    CUT = 2,
    CARVE = 3,
    PROBE = 4,
    MEASURE = 5
  };

  ///@{
  /**
   * Set/Get the tool of the left button. Default TURN.
   */
  virtual void SetTool(int tool);
  vtkGetMacro(Tool, int);
  ///@}

  ///@{
  /**
   * Set/Get the depth of cuts below visible voxels, and the radius of the carving sphere, in world
   * units. 0 means a tenth and a fortieth of the diagonal of the output. Default 0.
   */
  vtkSetClampMacro(CutDepth, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(CutDepth, double);
  /// Set/Get the radius of the carving sphere, in world units; 0: a fortieth of the diagonal of the
  /// output. Default 0.
  vtkSetClampMacro(CarveRadius, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(CarveRadius, double);
  ///@}

  /**
   * Definitions of visible voxels, see SetPickMode().
   */
  enum PickModes
  {
    OPACITY = 0,
    ISOSURFACE = 1,
    SLICES = 2
  };

  ///@{
  /**
   * Set/Get which voxels are visible. Default OPACITY.
   */
  vtkSetClampMacro(PickMode, int, OPACITY, SLICES);
  vtkGetMacro(PickMode, int);
  ///@}

  ///@{
  /**
   * Set/Get the minimum value of visible voxels with ISOSURFACE. Default 0.
   */
  vtkSetMacro(Isovalue, double);
  vtkGetMacro(Isovalue, double);
  ///@}

  ///@{
  /**
   * Add/Clear the planes that are visible with SLICES: a point and a normal, in world coordinates.
   */
  void AddSlicePlane(double x, double y, double z, double nx, double ny, double nz);
  /// Remove all planes.
  void ClearSlicePlanes();
  ///@}

  /**
   * Get the position of the voxel of the output that is visible at a pixel of the window, in world
   * coordinates. Returns false if there is none.
   */
  bool FindPosition(int x, int y, double position[3]);

  ///@{
  /**
   * Get the last output of the session, and the image that the mapper shows: the same scalars
   * without direction and origin, and with a positive spacing. Null before the first output.
   */
  vtkImageData* GetOutput();
  vtkImageData* GetShownImage();
  ///@}

  /**
   * Clear measurements and the output. Call it after SetInputs() or LoadSession() of the session.
   */
  void Forget();

  ///@{
  /**
   * Set/Get whether tools, models and messages are shown as text. Default on.
   */
  vtkSetMacro(ShowStatus, bool);
  vtkGetMacro(ShowStatus, bool);
  vtkBooleanMacro(ShowStatus, bool);
  ///@}

  ///@{
  /**
   * Set/Get whether the list of keys is shown (also toggled by the key h), and additional text
   * below it. Default off, and "".
   */
  vtkSetMacro(ShowHelp, bool);
  vtkGetMacro(ShowHelp, bool);
  vtkBooleanMacro(ShowHelp, bool);
  /// Set/Get additional text below the list of keys. Default "".
  vtkSetMacro(AdditionalHelp, std::string);
  vtkGetMacro(AdditionalHelp, std::string);
  ///@}

  ///@{
  /**
   * Set/Get the last message, and get the whole status text, which contains the message. A viewer
   * may show its own messages.
   */
  void ShowMessage(const std::string& message);
  vtkGetMacro(Message, std::string);
  std::string GetStatus();
  ///@}

  /**
   * Get the last measured distance, in world units; 0 if nothing was measured.
   */
  vtkGetMacro(MeasuredDistance, double);

  ///@{
  /**
   * Reimplemented from vtkInteractorStyle.
   */
  void OnMouseMove() override;
  void OnLeftButtonDown() override;
  void OnLeftButtonUp() override;
  void OnRightButtonDown() override;
  void OnRightButtonUp() override;
  void OnMouseWheelForward() override;
  void OnMouseWheelBackward() override;
  void OnChar() override;
  void OnTimer() override;
  void SetInteractor(vtkRenderWindowInteractor* interactor) override;
  ///@}

  /**
   * Set the renderer that is used. While the button of a tool is pressed, the renderer in which it
   * was pressed stays in use.
   */
  void SetCurrentRenderer(vtkRenderer* renderer) override;

protected:
  vtkDeformVolumeInteractorStyle();
  ~vtkDeformVolumeInteractorStyle() override;

private:
  vtkDeformVolumeInteractorStyle(const vtkDeformVolumeInteractorStyle&) = delete;
  void operator=(const vtkDeformVolumeInteractorStyle&) = delete;

  bool CheckInteractor();
  bool CheckSession();
  bool SelectRenderer();
  bool SelectRenderer(int x, int y);
  void ShowOutput();
  bool UpdateOverlay(); // returns whether the status has changed
  void BeginTool();
  void MoveTool();
  void EndTool(bool keepHandle);
  void DragTo(int x, int y);
  void CarveAt(int x, int y, bool isLast);
  void FinishCut();
  void ProbeAt(int x, int y);
  void ReleaseAt(int x, int y);
  void PinAt(int x, int y);
  void MeasureAt(int x, int y);
  void TurnWheel(int notches);
  bool ResizeTool(int notches);
  double GetDiagonal();
  double GetEffectiveCutDepth();
  double GetEffectiveCarveRadius();

  int Tool = TURN;
  double CutDepth = 0.0;
  double CarveRadius = 0.0;
  int PickMode = OPACITY;
  double Isovalue = 0.0;
  bool ShowStatus = true;
  bool ShowHelp = false;
  std::string AdditionalHelp;
  std::string Message;
  double MeasuredDistance = 0.0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
