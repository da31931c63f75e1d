// SPDX-License-Identifier: BSD-3-Clause
// For the tests of deformations that vary in time.
#ifndef TimedDeformation_h
#define TimedDeformation_h

#include "FilterTesting.h"

#include "../../Sources.h"

#include <functional>
#include <utility>

namespace filterTesting
{

/// A volume, and a lattice that moves it along x by a number of voxels that depends on the time.
struct TimedDeformation : Deformed
{
  explicit TimedDeformation(std::function<double(double)> way, double lastTime = 4.0)
  {
    this->Lattice->GetMesh = [mesh = MakeMesh(this->Volume), way = std::move(way)](double time)
    {
      SetDisplacements(mesh, Shift(way(time), 0.0, 0.0));
      return mesh;
    };
    this->Lattice->LastTime = lastTime;
    this->Filter->SetInputData(this->Volume);
    this->Filter->SetDeformationConnection(this->Lattice->GetOutputPort());
  }

  vtkSmartPointer<vtkImageData> Volume = MakeVolume();
  vtkNew<TimedMesh> Lattice;
};

} // namespace filterTesting

#endif
