// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveViewer_h
#define DeformInteractiveViewer_h

#include "Arguments.h"
#include "LinePrompt.h"
#include "Transfer.h"
#include "TransferPlot.h"
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

/// The window of deform-interactive: files, displays, the editor of the transfer function and the
/// numbers. The tools are those of vtkDeformVolumeInteractorStyle.
class Viewer
{
public:
  Viewer(const Arguments& arguments, Messages& messages);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  void operator=(const Viewer&) = delete;

  /// Until the window is closed, or the replay has come to its end. Throws a Failure where
  /// something that was asked for on the command line cannot be done.
  void Run();

private:
  using Clock = std::chrono::steady_clock;

  // Observers, which return whether nobody else is to see the event.
  bool OnKeyPress(vtkObject*, unsigned long, void*);
  bool OnChar(vtkObject*, unsigned long, void*);
  bool OnLeftButton(vtkObject*, unsigned long event, void*);
  bool OnMouseMove(vtkObject*, unsigned long, void*);
  void OnOutput(vtkObject*, unsigned long, void*);
  void OnFrame(vtkObject*, unsigned long event, void*);
  void OnInteraction(vtkObject*, unsigned long event, void*);
  void OnTimer(vtkObject*, unsigned long, void* timer);
  void OnDrop(vtkObject*, unsigned long, void* files);

  void OpenVolume(const std::string& path);
  void Open(const std::string& path);
  void Save(const std::string& path);
  /// "" or why not.
  std::string TrySave(const std::string& path);
  void LoadSession(const std::string& path);
  void ToggleRecording();
  void StartRecording(const std::string& path);
  void Replay(const std::string& path);
  /// Of what was drawn last.
  void SavePicture(const std::string& path);
  void AimCamera(const double view[3]);
  void ChoosePreset(Transfer::Preset preset);
  void ChangeHandleRadius(int steps);
  void ShowTransfer();
  void ShowTexts();
  /// Draws a message before something that takes its time.
  void Announce(const std::string& message);

  Arguments Asked;
  Messages& Reports;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindowInteractor> Interactor;
  vtkNew<vtkDeformVolumeSession> Session;
  vtkNew<vtkDeformVolumeInteractorStyle> Style;
  VolumeView View;
  TransferPlot Plot;
  std::unique_ptr<Histogram> Values; // null before there is a volume
  Transfer Shown;
  double Diagonal = 0.0;         // of the volume
  double HandleRadiusPart = 0.0; // of it
  LinePrompt Prompt;
  vtkNew<vtkTextActor> Numbers;
  vtkNew<vtkTextActor> PromptLine;
  vtkSmartPointer<vtkInteractorEventRecorder> Recorder; // while it records
  std::string FileName = "deformed";                    // without its ending
  std::string Dropped;                                  // a file that is to be opened
  int DropTimer = -1;                                   // that opens it
  bool ShowNumbers = true;
  bool IsChanged = false; // since it was drawn
  bool IsReplaying = false;
  bool IsInteracting = false; // a button is pressed
  bool IsEditing = false;     // the plot is dragged
  int Frame = 0;

  double UploadTime = 0.0;
  double RenderTime = 0.0;
  Clock::time_point FrameBegin;
  std::deque<Clock::time_point> Frames; // of the last second
  Clock::time_point LastTexts;
};

#endif
