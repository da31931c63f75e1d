// SPDX-License-Identifier: BSD-3-Clause
// MeshRasterizer: inverse displacement fields.
#include "MeshRasterizer.h"

#include "DeviceVolume.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "RasterizationProgram.h"
#include "WorkDevice.h"

#include <algorithm>

namespace deformvolume
{

void MeshRasterizer::SetField(const DisplacementField& inverse)
{
  cl::Buffer vectors = this->FieldVectors;
  this->Clear(); // there is no field if a call below throws
  std::uint64_t bytes = 3 * sizeof(float);
  for (const int size : inverse.Dimensions)
  {
    bytes *= static_cast<std::uint64_t>(size);
  }
  CheckAllocation(bytes, this->Device->GetAllocationLimit(),
    "The vectors of the displacement field", "Use a coarser field");
  for (std::size_t i = 0; i < inverse.IndexToField.size(); ++i)
  {
    this->Field.OutputToField[i] = static_cast<float>(inverse.IndexToField[i]);
    this->Field.OutputToFieldRest[i] =
      static_cast<float>(inverse.IndexToField[i] - this->Field.OutputToField[i]);
  }
  std::copy_n(inverse.Dimensions.begin(), 3, this->Field.Dimensions);
  this->Field.Extrapolate = inverse.Extrapolate;
  std::transform(inverse.Fading.begin(), inverse.Fading.end(), this->Field.Fading,
    [](double step) { return static_cast<float>(step); });
  this->Device->Send(vectors, inverse.Vectors, static_cast<std::size_t>(bytes));
  this->FieldVectors = vectors;
}

std::size_t MeshRasterizer::GetNumberOfNodes() const
{
  return this->RestNodes.size() / 3 +
    static_cast<std::size_t>(this->Field.Dimensions[0]) *
    static_cast<std::size_t>(this->Field.Dimensions[1]) *
    static_cast<std::size_t>(this->Field.Dimensions[2]);
}

cl::Kernel MeshRasterizer::MakeKernel(Interpolation interpolation) const
{
  return cl::Kernel(GetRasterizationProgram(this->Device->GetContext(),
                      this->Volume->GetArrays().Get(), this->Volume->GetVoxelGrid(), interpolation,
                      this->HasField(), this->Volume->GetMasks().HasAny()),
    this->HasField() ? "LookUpField" : "RasterizeMesh");
}

cl_uint MeshRasterizer::SetDeformationArguments(cl::Kernel& kernel) const
{
  return this->HasField() ? deformvolume::SetArguments(kernel, 0, this->FieldVectors, this->Field)
                          : deformvolume::SetArguments(kernel, 0, this->Tetrahedra, this->Positions,
                              this->Displacements, this->Lists.GetBegins(), this->Lists.GetLists());
}

} // namespace deformvolume
