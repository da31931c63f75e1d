// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkVolumeEditAlgorithmInternals_h
#define vtkVolumeEditAlgorithmInternals_h

#include "EditProgress.h"
#include "PipelineExecution.h"
#include "ToolPath.h"
#include "VolumeEdit.h"
#include "VolumeEditor.h"

#include "vtkVolumeEditAlgorithm.h"

/// State that the subclasses keep from one execution to the next.
class vtkVolumeEditAlgorithm::vtkEdits
{
public:
  explicit vtkEdits(vtkVolumeEditAlgorithm* self)
    : Self(self)
  {
  }

  /// Sets the volume on port 0; see VolumeEditor::SetVolume().
  bool SetVolume(vtkInformationVector** input);
  /// Makes an EditFinder with default options for the volume as deformed by the inputs on ports 2
  /// and 3. It is valid during this execution.
  deformvolume::EditFinder MakeFinder(vtkInformationVector** input);

  deformvolume::VolumeEditor Editor;
  deformvolume::ToolPath Tool;
  deformvolume::EditProgress Progress; // of the current execution
  deformvolume::PipelineExecution Execution;

private:
  /// Positions of the vertices of the volume, deformed by the inputs on ports 2 and 3; see
  /// VolumeEditor::GetPositions().
  const deformvolume::VertexPositions& GetVertices(vtkInformationVector** input);

  vtkVolumeEditAlgorithm* Self;
};

#endif
