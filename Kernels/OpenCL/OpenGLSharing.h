// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOpenGLSharing_h
#define DeformVolumeOpenGLSharing_h

#include "DeformVolumeExport.h"
#include "Error.h"

#include <memory>
#include <string>

namespace deformvolume
{

/// An OpenGL context as its window system names it.
struct OpenGLContext
{
  enum class System
  {
    GLX, // Context is a GLXContext, Display a Display*
    EGL  // Context is an EGLContext, Display an EGLDisplay
  };
  System WindowSystem = System::GLX;
  void* Context = nullptr;
  void* Display = nullptr;

  bool operator==(const OpenGLContext& other) const
  {
    return this->WindowSystem == other.WindowSystem && this->Context == other.Context &&
      this->Display == other.Display;
  }
};

/// The context of a device, which is made now and serves for all that follows in this process,
/// shares buffers with an OpenGL context (cl_khr_gl_sharing), which has to be current in this
/// thread. request: as for ResolveDevice. To be called before anything else uses the device; once
/// more for the same two does nothing. The OpenGL context has to be there for as long as anything
/// uses the device: when it is destroyed, whatever is done with the device is undefined. Throws an
/// Error where the device cannot do that, is not the one that draws, or is in use already.
DEFORMVOLUME_EXPORT void ShareWithOpenGL(const std::string& request, const OpenGLContext& context);

/// A buffer object of OpenGL that outputs can be copied to on the device: see DeviceOutput::CopyTo.
class DEFORMVOLUME_EXPORT OpenGLBuffer
{
public:
  /// name: of a buffer object with memory, which lives longer than this one and keeps its size.
  OpenGLBuffer(unsigned int name, const OpenGLContext& context);
  ~OpenGLBuffer();
  OpenGLBuffer(const OpenGLBuffer&) = delete;
  OpenGLBuffer& operator=(const OpenGLBuffer&) = delete;

  /// For objects of this library.
  class DEFORMVOLUME_NO_EXPORT Internals;
  DEFORMVOLUME_NO_EXPORT Internals& GetInternals() const { return *this->Impl; }

private:
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
