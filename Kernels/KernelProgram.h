// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelProgram_h
#define DeformVolumeKernelProgram_h

#include "OpenCLContext.h"
#include "VolumeDeformer.h"

namespace deformvolume
{

/// Whether the device has double precision.
bool HasDouble(const OpenCLContext& context);

/// How the kernels find the displacement of a vertex: the names of MAPPING in
/// DeformationMapping.cl.
enum class MappingForm
{
  Links,
  Runs,
  Field,
  /// A field whose vectors are read where they lie; for devices with double precision.
  FieldInPlace
};

/// The deformation mapping (DeformationMapping.cl) and the state of vertices (VertexState.cl).
cl::Program GetMappingProgram(OpenCLContext& context, MappingForm mapping);

/// The kernels of the exact resampling.
enum class ResamplingForm
{
  /// Cell by cell: Resample in Resampling.cl.
  Cells,
  /// By lanes: ResampleBricks in BrickResampling.cl.
  Lanes,
  /// What either puts off: ResampleLargeCells in LargeCells.cl.
  LargeCells
};

/// The exact resampling for arrays of these types. wideKeys: cells are too many for the 30 bits of
/// a narrow winner's key. Throws Error where the device lacks what the arrays need.
cl::Program GetResamplingProgram(OpenCLContext& context, MappingForm mapping,
  const std::vector<VolumeArray>& arrays, bool wideKeys, ResamplingForm form);

/// Whether the kernel ResampleBricks works in local memory: where there is enough. Else it does so
/// in a buffer, which has room for each work-item.
bool HasLocalBricks(const OpenCLContext& context);
/// Bytes of that for a work-item.
std::size_t GetBrickMemory(const OpenCLContext& context, const std::vector<VolumeArray>& arrays);

/// What is done with the output besides resampling (CoverageCount.cl, OutputClearing.cl).
cl::Program GetOutputProgram(OpenCLContext& context);

/// The published resampling (PublishedResampling.cl) for arrays of these types.
cl::Program GetPublishedProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays);

/// The binning of the tetrahedra of the deformation mesh (TetrahedronBinning.cl).
cl::Program GetBinningProgram(OpenCLContext& context);

/// The mesh rasterisation (MeshRasterization.cl, RestSampling.cl), or for a field the look-up
/// through it (FieldLookup.cl), for arrays of these types. Throws Error where the device lacks what
/// the arrays need.
cl::Program GetRasterizationProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const Lattice& lattice, Interpolation interpolation, bool field);

} // namespace deformvolume

#endif
