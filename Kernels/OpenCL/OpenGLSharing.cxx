// SPDX-License-Identifier: BSD-3-Clause
#include "OpenGLSharing.h"

#include "GuardedCall.h"
#include "OpenGLBufferInternals.h"

#include <vector>

namespace deformvolume
{

void ShareWithOpenGL(const std::string& request, const OpenGLContext& context)
{
  CallGuarded([&] { OpenCLContext::Share(FindDevice(request), context); });
}

bool OpenGLBuffer::Internals::CopyFrom(
  const cl::CommandQueue& queue, const cl::Buffer& source, std::uint64_t bytes)
{
  const OpenCLContext* const context = OpenCLContext::Find(queue);
  if (!context || !context->IsSharedWith(this->Context))
  {
    return false;
  }
  if (this->Owner != context)
  {
    this->Buffer = cl::BufferGL(context->GetContext(), CL_MEM_WRITE_ONLY, this->Name);
    this->Owner = context;
  }
  const std::vector<cl::Memory> objects{ this->Buffer };
  queue.enqueueAcquireGLObjects(&objects);
  try
  {
    queue.enqueueCopyBuffer(source, this->Buffer, 0, 0, bytes);
  }
  catch (const cl::Error&)
  {
    // OpenGL gets it back whatever happens. These throw nothing.
    clEnqueueReleaseGLObjects(queue(), 1, &this->Buffer(), 0, nullptr, nullptr);
    clFinish(queue());
    throw;
  }
  queue.enqueueReleaseGLObjects(&objects);
  queue.finish();
  return true;
}

OpenGLBuffer::OpenGLBuffer(unsigned int name, const OpenGLContext& context)
  : Impl(std::make_unique<Internals>(name, context))
{
}

OpenGLBuffer::~OpenGLBuffer() = default;

} // namespace deformvolume
