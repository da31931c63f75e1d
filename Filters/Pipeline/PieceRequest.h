// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePieceRequest_h
#define DeformVolumePieceRequest_h

#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

namespace deformvolume
{

/// Whether the first of several pieces is requested, or the whole output. A mesh that cannot be
/// divided is the output of the first piece, so that all pieces together have each cell once.
inline bool IsFirstPiece(vtkInformationVector* output)
{
  vtkInformation* info = output->GetInformationObject(0);
  vtkInformationIntegerKey* key = vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER();
  return !info->Has(key) || info->Get(key) <= 0;
}

/// The result of a request after an error: 0, and 1 if one piece of several is requested. Ranks
/// whose results differ would wait for each other forever in filters downstream that communicate.
inline int GetResultOfError(vtkInformationVector* output)
{
  vtkInformation* info = output->GetInformationObject(0);
  vtkInformationIntegerKey* key = vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES();
  return info->Has(key) && info->Get(key) > 1 ? 1 : 0;
}

/// Requests the whole of the inputs on the ports from first to before last, each as one piece.
inline void AskForAll(vtkInformationVector** input, int first, int last)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  for (int port = first; port < last; ++port)
  {
    vtkInformation* info = input[port]->GetInformationObject(0);
    if (!info)
    {
      continue;
    }
    info->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
    info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
    info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    if (info->Has(Pipeline::WHOLE_EXTENT()))
    {
      info->Set(Pipeline::UPDATE_EXTENT(), info->Get(Pipeline::WHOLE_EXTENT()), 6);
    }
  }
}

} // namespace deformvolume

#endif
