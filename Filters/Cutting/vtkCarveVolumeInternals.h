// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkCarveVolumeInternals_h
#define vtkCarveVolumeInternals_h

#include "Carving.h"
#include "SheetReading.h"
#include "VolumeEdit.h"

#include "vtkCarveVolume.h"
#include "vtkVolumeEditAlgorithmInternals.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

class vtkDataArray;

/// What vtkCarveVolume keeps from one execution to the next.
class vtkCarveVolume::vtkInternals
{
public:
  explicit vtkInternals(vtkCarveVolume* self)
    : Self(self)
  {
  }

  /// See vtkVolumeEditAlgorithm::UpdateEdits().
  void Execute(vtkInformationVector** input);

private:
  /// Something that carves at most once until it changes: a function, a surface, a label.
  struct Body
  {
    /// What tells two bodies apart: objects with their times, and settings.
    using Key = std::pair<deformvolume::Stamp, std::vector<double>>;

    Key Carved; // the body that has carved; empty: none
    std::uint64_t Edit = 0;
  };
  /// A change of the edit of a body, found and not yet made.
  struct Change
  {
    Body* Changed;
    Body::Key Next; // empty: there is no body
    deformvolume::VolumeEdit Edit;
  };

  void Check() const;
  deformvolume::CarvingRule GetRule() const;
  vtkDataArray* FindLabels(vtkImageData* volume) const;
  /// Appends a change where a body is another one. carve: finds what it carves out.
  void Find(Body& body, Body::Key&& next, const std::function<deformvolume::VolumeEdit()>& carve,
    std::vector<Change>& changes);

  vtkCarveVolume* Self;
  Body Function;
  Body Surface;
  Body Label;
  deformvolume::WorldSheet Sheet; // the surface that was read last
  double SheetVersion = 0.0;      // changes with it
};

#endif
