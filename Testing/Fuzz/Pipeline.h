// SPDX-License-Identifier: BSD-3-Clause
// A random pipeline round vtkDeformVolumeFilter, and random edits of it.
#ifndef Fuzz_Pipeline_h
#define Fuzz_Pipeline_h

#include "Random.h"
#include "Settings.h"
#include "Sources.h"
#include "Subject.h"

#include <vtkDataObject.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

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
  /// The inputs are made at once. log gets what is made and done, one line each.
  Pipeline(std::uint64_t seed, std::ostream& log);

  /// Updates and edits. Returns what went wrong, or "".
  std::string Run();

  /// Updates that gave an output, and that ended in an error.
  int GetNumberOfOutputs() const { return this->Outputs; }
  int GetNumberOfErrors() const { return this->Errors; }
  int GetNumberOfReferences() const { return this->References; }

private:
  void MakeDeformation();
  void MakeRest();
  void Connect(Subject& subject, bool copies);
  void Edit();
  void EditDeformation();
  void Abort();
  void TouchSources();
  std::vector<vtkDataSet*> GetDeformed() const;
  std::string Check();
  std::string CheckError(const Outcome& tested, const Outcome& fresh);
  std::string CheckOutput(const Outcome& tested, const Outcome& fresh, bool divided);

  fuzz::Random Random;
  std::ostream& Log;
  fuzz::Geometry Geometry;
  fuzz::Settings Settings;

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkDataObject> Deformation;
  vtkSmartPointer<vtkDataObject> Rest;
  vtkNew<PartSource> Parts;
  vtkNew<TimeSource> Times;
  bool VolumeInParts = false;
  bool VariesInTime = false;
  double Time = 0.0;

  Subject Tested;
  std::string LastMessage;
  int Outputs = 0;
  int Errors = 0;
  int References = 0;
};

} // namespace fuzz

#endif
