// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkVolumeEditAlgorithmInternals_h
#define vtkVolumeEditAlgorithmInternals_h

#include "EditProgress.h"
#include "PipelineExecution.h"
#include "ToolPath.h"
#include "VolumeEdit.h"
#include "VolumeEditor.h"

#include "vtkVolumeEditAlgorithm.h"

/// What the subclasses keep from one execution to the next.
class vtkVolumeEditAlgorithm::vtkEdits
{
public:
  explicit vtkEdits(vtkVolumeEditAlgorithm* self)
    : Self(self)
  {
  }

  /// Takes the volume on port 0; see VolumeEditor::SetVolume().
  bool SetVolume(vtkInformationVector** input);
  /// What finds edits of the volume, as it is deformed by ports 2 and 3, without options. It is
  /// valid during this execution.
  deformvolume::EditFinder MakeFinder(vtkInformationVector** input);

  deformvolume::VolumeEditor Editor;
  deformvolume::ToolPath Tool;
  deformvolume::EditProgress Progress; // of the execution that there is
  deformvolume::PipelineExecution Execution;

private:
  /// Where its vertices are, by ports 2 and 3; see VolumeEditor::GetPositions().
  const deformvolume::VertexPositions& GetVertices(vtkInformationVector** input);

  vtkVolumeEditAlgorithm* Self;
};

#endif
