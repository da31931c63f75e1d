// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMappingProgram_h
#define DeformVolumeMappingProgram_h

#include "OpenCLContext.h"

namespace deformvolume
{

/// The form of the deformation mapping, by which kernels compute the displacement of a vertex
/// (MAPPING in DeformationMapping.cl).
enum class MappingKind
{
  Links,
  Runs,
  Field,
  /// A field whose vectors are read in place. Needs double precision.
  FieldInPlace
};

/// Returns the program of the deformation mapping (DeformationMapping.cl) and of the states of
/// vertices (VertexState.cl). withCut: whether there is a smooth cut (CutPositions.cl).
/// hasTurnedAxes: see DeviceVolume.
cl::Program GetMappingProgram(
  OpenCLContext& context, MappingKind mapping, bool withCut = false, bool hasTurnedAxes = false);

/// Returns the program of the mask of bridges (ResampledMask.cl), for links or runs.
cl::Program GetResampledMaskProgram(
  OpenCLContext& context, MappingKind mapping, bool withCut = false, bool hasTurnedAxes = false);

/// Returns the program that converts vectors to displacements (VectorConversion.cl) and computes
/// bounds (VectorBounds.cl).
cl::Program GetConversionProgram(OpenCLContext& context);

/// Returns the source text of a form of the mapping (DeformationMapping.cl). It must follow
/// GetSamplingMeshText().
ProgramText GetMappingText(MappingKind mapping, bool hasTurnedAxes = false);

} // namespace deformvolume

#endif
