// SPDX-License-Identifier: BSD-3-Clause
#include "MappingProgram.h"

#include "KernelSources.h"
#include "KernelText.h"
#include "SamplingMeshText.h"

namespace deformvolume
{
namespace
{

ProgramText GetFormText(MappingKind mapping)
{
  switch (mapping)
  {
    case MappingKind::Links:
      return ProgramText("#define MAPPING 0\n") + MultiplyAdd_cl + DeformationMapping_cl;
    case MappingKind::Runs:
      return ProgramText("#define MAPPING 1\n") + MultiplyAdd_cl + RunMapping_cl +
        DeformationMapping_cl;
    case MappingKind::FieldInPlace:
      return ProgramText("#define MAPPING 3\n") + MultiplyAdd_cl + DeformationMapping_cl;
    default:
      return ProgramText("#define MAPPING 2\n") + MultiplyAdd_cl + FieldPoints_cl + FieldFading_cl +
        DeformationMapping_cl;
  }
}

} // namespace

ProgramText GetMappingText(MappingKind mapping, bool hasTurnedAxes)
{
  return ProgramText("#define HAS_TURNED_AXES ") + (hasTurnedAxes ? "1\n" : "0\n") +
    GetFormText(mapping);
}

cl::Program GetMappingProgram(
  OpenCLContext& context, MappingKind mapping, bool withCut, bool hasTurnedAxes)
{
  const char* const evaluation = mapping == MappingKind::Runs ? RunEvaluation_cl : "";
  const char* const positions = withCut ? CutPositions_cl : "";
  return context.GetProgram(ProgramText(GetReal(context)) + GetSamplingMeshText(withCut) +
      GetMappingText(mapping, hasTurnedAxes) + VertexState_cl + positions + evaluation,
    KernelOptions);
}

cl::Program GetResampledMaskProgram(
  OpenCLContext& context, MappingKind mapping, bool withCut, bool hasTurnedAxes)
{
  return context.GetProgram(ProgramText(GetReal(context)) + GetSamplingMeshText(withCut) +
      GetMappingText(mapping, hasTurnedAxes) + VertexState_cl + ResampledMask_cl,
    KernelOptions);
}

cl::Program GetConversionProgram(OpenCLContext& context)
{
  const ProgramText products =
    HasDouble(context) ? GetMappingText(MappingKind::FieldInPlace) : ProgramText("");
  return context.GetProgram(ProgramText(GetReal(context)) + GetSamplingMeshText() + products +
      VectorConversion_cl + GroupReduction_cl + VectorBounds_cl,
    KernelOptions);
}

} // namespace deformvolume
