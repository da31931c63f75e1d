// SPDX-License-Identifier: BSD-3-Clause
// A random pipeline with vtkDeformVolumeFilter, and random edits of it.
#ifndef Fuzz_Pipeline_h
#define Fuzz_Pipeline_h

#include "Random.h"
#include "Settings.h"
#include "Subject.h"

#include "../Sources.h"

#include <vtkDataArray.h>
#include <vtkDataObject.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace fuzz
{

class Pipeline
{
public:
  /// Makes the inputs. log gets a line for each input and each edit. Every eighth seed makes many
  /// small edits of a large volume.
  Pipeline(std::uint64_t seed, std::ostream& log);

  /// Updates and edits the pipeline in turn. Returns a description of the failure, or "".
  std::string Run();

  /// Numbers of updates that gave an output, and that ended with an error.
  int GetNumberOfOutputs() const { return this->Outputs; }
  int GetNumberOfErrors() const { return this->Errors; }
  int GetNumberOfReferences() const { return this->References; }

  /// Numbers of updates of a large volume: all, those that resampled a part of the output, and
  /// among these the updates of a folded volume and of a mesh whose nodes were split.
  struct LiveUpdates
  {
    int All = 0;
    int Parts = 0;
    int FoldedParts = 0;
    int SplitParts = 0;
  };
  const LiveUpdates& GetLiveUpdates() const { return this->Live; }

private:
  // The form in which the filter gets the mesh. this->Deformation has points at rest, and
  // displacements.
  enum class Form
  {
    Displacements,
    TwoConfigurations,
    DeformedPoints
  };

  void MakeDeformation();
  void ApplySettings();
  void MakeShape();
  void EditForm();
  void Connect(Subject& subject, bool copies);
  void Edit();
  void EditDeformation();
  void Abort();
  void TouchSources();
  std::vector<vtkDataSet*> GetDeformed() const;
  std::string Check();
  std::string CheckError(const Outcome& tested, const Outcome& fresh);
  std::string CheckChangedExtent(vtkImageData* output);
  void CountLive(const Outcome& tested);
  std::string CheckOutput(const Outcome& tested, const Outcome& fresh, bool divided);

  fuzz::Random Random;
  std::ostream& Log;
  bool IsLive;
  fuzz::Geometry Geometry;
  fuzz::Settings Settings;

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkDataObject> Deformation;
  Form Given = Form::Displacements;
  vtkNew<PartSource> Parts;
  vtkNew<TimedMesh> Times;
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> Steps; // the meshes at the times 0, 1, 2...
  bool VolumeInParts = false;
  bool VariesInTime = false;
  double Time = 0.0;

  fuzz::Settings StartSettings;
  std::vector<vtkSmartPointer<vtkDataObject>> Before; // earlier deformations, the first one first
  std::function<void()> Repair;                       // removes an error from the deformation

  Subject Tested;
  vtkSmartPointer<vtkImageData> Shown; // a copy of the output, updated within GetChangedExtent()
  int Outputs = 0;
  int Errors = 0;
  int References = 0;
  LiveUpdates Live;
};

} // namespace fuzz

#endif
