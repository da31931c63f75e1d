// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePieceRequest_h
#define DeformVolumePieceRequest_h

#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

namespace deformvolume
{

/// Whether the first of several pieces is asked for, or all. A mesh that is made in one goes there,
/// so that all pieces together have each cell once.
inline bool IsFirstPiece(vtkInformationVector* output)
{
  vtkInformation* info = output->GetInformationObject(0);
  vtkInformationIntegerKey* key = vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER();
  return !info->Has(key) || info->Get(key) <= 0;
}

} // namespace deformvolume

#endif
