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

/// Moves the voxels or nodes within Radius of Point by Displacement. With the radius 0, moves only
/// the nearest one. World units.
struct Pull
{
  std::array<double, 3> Point{ { 0.0, 0.0, 0.0 } };
  std::array<double, 3> Displacement{ { 0.0, 0.0, 0.0 } };
  double Radius = 0.0;
};

/// Makes handles for vtkChainMailDeformation and vtkElasticDeformation. part: the fraction of the
/// displacements of the pulls by which the handles are moved.
vtkSmartPointer<vtkPolyData> MakeHandles(const std::vector<Pull>& pulls, double part = 1.0);

/// Computes the displacement field of --pull by ChainMail. Calls takeFrame with the field of each
/// frame.
void PullByChainMail(const Options& options, const Volume& volume, Messages& messages,
  Deformation& deformation, const FrameTaker& takeFrame);

#endif
