// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMappingProgram_h
#define DeformVolumeMappingProgram_h

#include "OpenCLContext.h"

namespace deformvolume
{

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
/// withCut: there is a smooth cut (CutPositions.cl). hasTurnedAxes: see DeviceVolume.
cl::Program GetMappingProgram(
  OpenCLContext& context, MappingForm mapping, bool withCut = false, bool hasTurnedAxes = false);

/// What leaves out tetrahedra that bridge a gap (BridgeMask.cl), for links or runs.
cl::Program GetBridgeProgram(
  OpenCLContext& context, MappingForm mapping, bool withCut = false, bool hasTurnedAxes = false);

/// What makes displacements of vectors (VectorConversion.cl), and finds bounds by them
/// (VectorBounds.cl).
cl::Program GetConversionProgram(OpenCLContext& context);

/// The text of a form of the mapping (DeformationMapping.cl). It expects GetSamplingMeshText
/// before.
ProgramText GetMappingText(MappingForm mapping, bool hasTurnedAxes = false);

} // namespace deformvolume

#endif
