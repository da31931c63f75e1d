// SPDX-License-Identifier: BSD-3-Clause
#include "PipelineExecution.h"

#include "Error.h"

#include "vtkAlgorithm.h"

#include <exception>
#include <new>

namespace deformvolume
{

int PipelineExecution::Run(
  vtkAlgorithm* algorithm, const char* noMemory, const std::function<void()>& body)
{
  try
  {
    body();
    return 1;
  }
  catch (const Aborted&)
  {
    this->Incomplete = true;
    return 1;
  }
  catch (const Error& error)
  {
    vtkErrorWithObjectMacro(algorithm, << error.what());
  }
  catch (const std::bad_alloc&)
  {
    vtkErrorWithObjectMacro(algorithm, << noMemory);
  }
  catch (const std::exception& error)
  {
    vtkErrorWithObjectMacro(algorithm, << "The update has failed: " << error.what());
  }
  this->Incomplete = true;
  this->Failed = true;
  return 0;
}

void PipelineExecution::Renew(vtkAlgorithm* algorithm)
{
  if (this->Incomplete)
  {
    this->Incomplete = false;
    this->Failed = false;
    algorithm->Modified();
  }
}

} // namespace deformvolume
