// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOpenGLBufferInternals_h
#define DeformVolumeOpenGLBufferInternals_h

#include "OpenCLContext.h"
#include "OpenGLSharing.h"

#include <cstdint>

namespace deformvolume
{

/// What an OpenGLBuffer is to OpenCL.
class OpenGLBuffer::Internals
{
public:
  Internals(unsigned int name, const OpenGLContext& context)
    : Name(name)
    , Context(context)
  {
  }

  /// Copies bytes from the begin of a buffer to that of this one, in a queue, and waits. Returns
  /// false where the context of the queue does not share with that of this buffer. Throws
  /// cl::Error. OpenGL may not use the buffer meanwhile, which its user ensures.
  bool CopyFrom(const cl::CommandQueue& queue, const cl::Buffer& source, std::uint64_t bytes);

private:
  unsigned int Name;
  OpenGLContext Context;
  cl::BufferGL Buffer; // made when it is needed first, for this context of OpenCL
  const OpenCLContext* Owner = nullptr;
};

} // namespace deformvolume

#endif
