// SPDX-License-Identifier: BSD-3-Clause
#include "PipelineExecution.h"

#include "Error.h"
#include "FailureReport.h"

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
    this->IsAborted = true;
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
  return Fail(algorithm);
}

void PipelineExecution::RenewAborted(vtkAlgorithm* algorithm)
{
  if (this->IsAborted)
  {
    this->IsAborted = false;
    algorithm->Modified();
  }
}

} // namespace deformvolume
