// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeformVolumeInteractorStyle
 * @brief   mouse and keyboard tools of vtkDeformVolumeSession
 *
 * vtkDeformVolumeInteractorStyle has a mouse and keys drive a session: it finds what is visible
 * under the cursor, turns movements into events of the session, and shows each new output. Put it
 * into any viewer: give it to the interactor, with the session and the vtkVolume that shows it.
 *
 * @par Buttons:
 * The left button is the tool. The right one turns the camera, the middle one moves it. The wheel
 * changes what the tool needs, and otherwise moves the camera to and fro.
 * - TURN: the camera is turned.
 * - GRAB: what is first visible under the cursor is dragged in the plane of the view, and with the
 *   wheel in depth. With Shift the handle stays where it is left.
 * - CUT: a stroke of the cursor; the sheet goes from it along the lines of sight, to CutDepth below
 *   what is first visible. The wheel changes CutDepth.
 * - CARVE: a sphere of CarveRadius is swept over what is visible. The wheel changes CarveRadius.
 * - PROBE: the value under the cursor, where it is, and where it is at rest.
 * - MEASURE: the distance between two places that are pressed on.
 *
 * @par Keys:
 * t g c v b m choose these tools; 1 2 3 4 the models NONE, CHAIN_MAIL, MASS_SPRING and
 * FINITE_ELEMENTS. p pins what is under the cursor, x releases the handle under the cursor. u is
 * undo, y redo, z undoes all. + and - are the wheel of CUT and CARVE. r resets the camera, h shows
 * help, q ends the interaction. Texts need VTK's module RenderingFreeType.
 *
 * @par What is visible:
 * With PickMode OPACITY, the voxel along the ray where half of the light has been absorbed that all
 * of them absorb (or half of all light), by the scalar opacity of the property of Volume; nothing
 * where that is less than a tenth of all light. With ISOSURFACE the first voxel whose value is
 * Isovalue or more; with SLICES the first voxel on one of the slice planes. Without Volume, OPACITY
 * finds the first voxel that the body covers. Values are the first component of the scalars.
 *
 * @par Events:
 * UpdateDataEvent after each new output, and UpdateInformationEvent where GetStatus() is another.
 * StartInteractionEvent and EndInteractionEvent where the button of a tool is pressed and released.
 *
 * @par Errors:
 * A tool that is used without an interactor, a renderer or a session is one vtkErrorMacro. What the
 * session reports is shown as GetMessage().
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
   * What is driven. Default null.
   */
  virtual void SetSession(vtkDeformVolumeSession* session);
  vtkDeformVolumeSession* GetSession();
  ///@}

  ///@{
  /**
   * What shows the outputs. Its mapper, a vtkVolumeMapper, gets each new one, and its user matrix
   * the direction of the output. Default null.
   */
  virtual void SetVolume(vtkVolume* volume);
  vtkVolume* GetVolume();
  ///@}

  ///@{
  /**
   * Have a thread of the session work, and a timer of the interactor poll it. Without them, Poll()
   * does both. StopSession() waits for the end of a step. It destroys the timer, and so must not be
   * called by an observer of this timer's event, nor of UpdateDataEvent.
   */
  void StartSession();
  void StopSession();
  ///@}

  /**
   * What each TimerEvent does: show the newest output, if there is one, and draw what has changed.
   * Where the thread of the session does not run, and events wait or something moves, that is one
   * Update() of the session. Returns whether something was drawn.
   */
  bool Poll();

  /**
   * What the left button does, see SetTool().
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
   * What the left button does. Default TURN.
   */
  virtual void SetTool(int tool);
  vtkGetMacro(Tool, int);
  ///@}

  ///@{
  /**
   * Set/Get how deep a sheet cuts below what is visible, and the radius of the sphere that carves,
   * in world units. 0 is a tenth and a fortieth of the diagonal of the output. Default 0.
   */
  vtkSetClampMacro(CutDepth, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(CutDepth, double);
  vtkSetClampMacro(CarveRadius, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(CarveRadius, double);
  ///@}

  /**
   * What counts as visible, see SetPickMode().
   */
  enum PickModes
  {
    OPACITY = 0,
    ISOSURFACE = 1,
    SLICES = 2
  };

  ///@{
  /**
   * Set/Get what counts as visible. Default OPACITY.
   */
  vtkSetClampMacro(PickMode, int, OPACITY, SLICES);
  vtkGetMacro(PickMode, int);
  ///@}

  ///@{
  /**
   * Set/Get the value from which on voxels are visible with ISOSURFACE. Default 0.
   */
  vtkSetMacro(Isovalue, double);
  vtkGetMacro(Isovalue, double);
  ///@}

  ///@{
  /**
   * The planes that are visible with SLICES: a point and the normal of each, in the world.
   */
  void AddSlicePlane(double x, double y, double z, double nx, double ny, double nz);
  void ClearSlicePlanes();
  ///@}

  /**
   * The voxel of the output that is first visible at a pixel of the window. False where there is
   * none.
   */
  bool FindPlace(int x, int y, double place[3]);

  ///@{
  /**
   * The last output of the session, and the image that the mapper has: the same scalars on a grid
   * along the axes. Null before there is one.
   */
  vtkImageData* GetOutput();
  vtkImageData* GetShownImage();
  ///@}

  /**
   * Forget measures and the output. Call it after SetInputs() or LoadSession() of the session.
   */
  void Forget();

  ///@{
  /**
   * Whether tools, models and messages are shown as text. Default on.
   */
  virtual void SetShowStatus(bool show);
  vtkGetMacro(ShowStatus, bool);
  vtkBooleanMacro(ShowStatus, bool);
  ///@}

  ///@{
  /**
   * Set/Get whether the keys are shown, as h does, and what is shown below them. Default off, and
   * "".
   */
  virtual void SetShowHelp(bool show);
  vtkGetMacro(ShowHelp, bool);
  vtkBooleanMacro(ShowHelp, bool);
  vtkSetMacro(AdditionalHelp, std::string);
  vtkGetMacro(AdditionalHelp, std::string);
  ///@}

  ///@{
  /**
   * What is shown: the last message alone, and all of it. A viewer may show messages of its own.
   */
  void ShowMessage(const std::string& message);
  vtkGetMacro(Message, std::string);
  std::string GetStatus();
  ///@}

  /**
   * The distance that was measured last, in world units; 0 where there is none.
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

protected:
  vtkDeformVolumeInteractorStyle();
  ~vtkDeformVolumeInteractorStyle() override;

private:
  vtkDeformVolumeInteractorStyle(const vtkDeformVolumeInteractorStyle&) = delete;
  void operator=(const vtkDeformVolumeInteractorStyle&) = delete;

  bool CheckInteractor();
  bool CheckSession();
  bool FindUsedRenderer();
  void ShowOutput();
  void UpdateOverlay();
  void BeginTool();
  void MoveTool();
  void EndTool(bool isHeld);
  void DragTo(int x, int y);
  void CarveAt(int x, int y, bool isLast);
  void FinishCut();
  void ProbeAt(int x, int y);
  void ReleaseAt(int x, int y);
  void PinAt(int x, int y);
  void MeasureAt(int x, int y);
  void Turn(int notches);
  bool ResizeTool(int notches);
  double GetDiagonal();
  double GetUsedCutDepth();
  double GetUsedCarveRadius();

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
