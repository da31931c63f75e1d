// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveViewer_h
#define DeformInteractiveViewer_h

#include "Arguments.h"
#include "Transfer.h"
#include "VolumeView.h"

#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkSmartPointer.h>

#include <chrono>
#include <deque>
#include <memory>
#include <string>

class Messages;
class vtkDeformVolumeInteractorStyle;
class vtkDeformVolumeSession;
class vtkInteractorEventRecorder;
class vtkRenderWindow;
class vtkRenderWindowInteractor;
class vtkRenderer;
class vtkTextActor;

/// The window of deform-interactive: it opens and saves files, switches displays, edits the
/// transfer function and shows measured times. The tools are those of
/// vtkDeformVolumeInteractorStyle.
class Viewer
{
public:
  Viewer(const Arguments& arguments, Messages& messages);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  void operator=(const Viewer&) = delete;

  /// Returns when the window is closed, or when the replay has ended. Throws a Failure if an option
  /// of the command line cannot be carried out.
  void Run();

private:
  using Clock = std::chrono::steady_clock;

  void OnKeyPress(vtkObject*, unsigned long, void*);
  /// Returns whether the key is one of this program. The style does not get it then.
  bool OnChar(vtkObject*, unsigned long, void*);
  void OnOutput(vtkObject*, unsigned long, void*);
  void OnFrame(vtkObject*, unsigned long event, void*);
  void OnInteraction(vtkObject*, unsigned long event, void*);
  void OnTimer(vtkObject*, unsigned long, void* timer);
  void OnDrop(vtkObject*, unsigned long, void* files);

  void OpenVolume(const std::string& path);
  void Open(const std::string& path);
  /// Saves all files under a new name, and shows it or an error message.
  void SaveAll();
  /// Throws a Failure if the file cannot be written.
  void Save(const std::string& path);
  void LoadSession(const std::string& path);
  void ToggleRecording();
  void StartRecording(const std::string& path);
  void Replay(const std::string& path);
  /// Writes the last rendered frame.
  void SavePicture(const std::string& path);
  void AimCamera(const double view[3]);
  void ChoosePreset(Transfer::Preset preset);
  void ChangeHandleRadius(int steps);
  void ShowTransfer();
  void ShowTexts();
  /// Draws a message before a long operation.
  void Announce(const std::string& message);

  Arguments Asked;
  Messages& Reports;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindowInteractor> Interactor;
  vtkNew<vtkDeformVolumeSession> Session;
  vtkNew<vtkDeformVolumeInteractorStyle> Style;
  VolumeView View;
  std::unique_ptr<Histogram> Values; // null before there is a volume
  Transfer Shown;
  double Diagonal = 0.0;         // of the volume, in world units
  double HandleRadiusPart = 0.0; // as a fraction of Diagonal
  vtkNew<vtkTextActor> Numbers;
  vtkSmartPointer<vtkInteractorEventRecorder> Recorder; // null if nothing is recorded
  std::string FileName;                                 // the beginning of the names of SaveAll()
  std::string Dropped;                                  // path of a file to open
  int DropTimer = -1;                                   // opens Dropped
  bool ShowNumbers = true;
  bool IsChanged = false; // since the last frame
  bool IsReplaying = false;
  bool IsInteracting = false; // a tool is used, or the camera is moved
  int Frame = 0;              // number of the next picture of --frames

  double UploadTime = 0.0;
  double RenderTime = 0.0;
  Clock::time_point FrameBegin;
  std::deque<Clock::time_point> Frames; // end times of the frames of the last second
  Clock::time_point LastTexts;
};

#endif
