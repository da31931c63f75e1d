// SPDX-License-Identifier: BSD-3-Clause
#include "MappingProgram.h"

#include "KernelSources.h"
#include "KernelText.h"
#include "SamplingMeshText.h"

namespace deformvolume
{
namespace
{

ProgramText GetFormText(MappingForm mapping)
{
  switch (mapping)
  {
    case MappingForm::Links:
      return ProgramText("#define MAPPING 0\n") + MultiplyAdd_cl + DeformationMapping_cl;
    case MappingForm::Runs:
      return ProgramText("#define MAPPING 1\n") + MultiplyAdd_cl + RunMapping_cl +
        DeformationMapping_cl;
    case MappingForm::FieldInPlace:
      return ProgramText("#define MAPPING 3\n") + MultiplyAdd_cl + DeformationMapping_cl;
    default:
      return ProgramText("#define MAPPING 2\n") + MultiplyAdd_cl + FieldPoints_cl + FieldFading_cl +
        DeformationMapping_cl;
  }
}

} // namespace

ProgramText GetMappingText(MappingForm mapping, bool hasTurnedAxes)
{
  return ProgramText("#define HAS_TURNED_AXES ") + (hasTurnedAxes ? "1\n" : "0\n") +
    GetFormText(mapping);
}

cl::Program GetMappingProgram(
  OpenCLContext& context, MappingForm mapping, bool withCut, bool hasTurnedAxes)
{
  const char* const evaluation = mapping == MappingForm::Runs ? RunEvaluation_cl : "";
  const char* const positions = withCut ? CutPositions_cl : "";
  return context.GetProgram(ProgramText(GetReal(context)) + GetSamplingMeshText(withCut) +
      GetMappingText(mapping, hasTurnedAxes) + VertexState_cl + positions + evaluation,
    KernelOptions);
}

cl::Program GetBridgeProgram(
  OpenCLContext& context, MappingForm mapping, bool withCut, bool hasTurnedAxes)
{
  return context.GetProgram(ProgramText(GetReal(context)) + GetSamplingMeshText(withCut) +
      GetMappingText(mapping, hasTurnedAxes) + VertexState_cl + BridgeMask_cl,
    KernelOptions);
}

cl::Program GetConversionProgram(OpenCLContext& context)
{
  const ProgramText products =
    HasDouble(context) ? GetMappingText(MappingForm::FieldInPlace) : ProgramText("");
  return context.GetProgram(ProgramText(GetReal(context)) + GetSamplingMeshText() + products +
      VectorConversion_cl + GroupReduction_cl + VectorBounds_cl,
    KernelOptions);
}

} // namespace deformvolume
