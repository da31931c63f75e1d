// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMail_h
#define DeformVolumeChainMail_h

#include "FrameTaker.h"

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <vector>

class Messages;
struct Deformation;
struct Options;
struct Volume;

/// Takes the voxels within Radius of a point, or the nearest one, and moves them. World units.
struct Pull
{
  std::array<double, 3> Point{ { 0.0, 0.0, 0.0 } };
  std::array<double, 3> Displacement{ { 0.0, 0.0, 0.0 } };
  double Radius = 0.0;
};

/// The handles that pulls are when they have gone a part of their way, as vtkChainMailDeformation
/// and vtkElasticDeformation take them.
vtkSmartPointer<vtkPolyData> MakeHandles(const std::vector<Pull>& pulls, double part = 1.0);

/// The displacement field of the pulls of the options: voxels follow their neighbours, by
/// ChainMail. takeFrame is called for each frame with the field that it has led to.
void PullByChainMail(const Options& options, const Volume& volume, Messages& messages,
  Deformation& deformation, const FrameTaker& takeFrame);

#endif
