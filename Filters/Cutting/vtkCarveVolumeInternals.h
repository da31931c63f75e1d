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
  /// A function, surface or label. It carves again only after it has changed.
  struct Body
  {
    /// Identifies a body: its objects with their modification times, and settings.
    using Key = std::pair<deformvolume::Stamp, std::vector<double>>;

    Key Carved; // key of the body that carved last; empty: none
    std::uint64_t Edit = 0;
  };
  /// A new edit of a body, which is not yet applied.
  struct Change
  {
    Body* Changed;
    Body::Key Next; // empty: there is no body
    deformvolume::VolumeEdit Edit;
  };

  void Check() const;
  deformvolume::CarvingRule GetRule() const;
  vtkDataArray* FindLabels(vtkImageData* volume) const;
  /// Appends a change if the key of a body has changed. carve: finds the edit.
  void AddChange(Body& body, Body::Key&& next,
    const std::function<deformvolume::VolumeEdit()>& carve, std::vector<Change>& changes);

  vtkCarveVolume* Self;
  Body Function;
  Body Surface;
  Body Label;
  deformvolume::WorldSheet Sheet; // the surface that was read last
  double SheetVersion = 0.0;      // incremented if Sheet changes
};

#endif
