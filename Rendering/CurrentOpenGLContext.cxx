// SPDX-License-Identifier: BSD-3-Clause
#include "CurrentOpenGLContext.h"

#ifndef _WIN32
#include <dlfcn.h>
#endif

namespace deformvolume
{

namespace
{

/// What a function without arguments of a library returns; null where the process has not loaded
/// that: then no context is of it.
void* Call(const char* library, const char* function)
{
#ifdef _WIN32
  (void)library;
  (void)function;
  return nullptr;
#else
  void* const loaded = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
  if (!loaded)
  {
    return nullptr;
  }
  auto* const call = reinterpret_cast<void* (*)()>(dlsym(loaded, function));
  void* const result = call ? call() : nullptr;
  dlclose(loaded);
  return result;
#endif
}

} // namespace

std::optional<OpenGLContext> FindCurrentOpenGLContext()
{
  // Of GLX, the older library stands for systems without GLVND.
  for (const char* library : { "libGLX.so.0", "libGL.so.1" })
  {
    if (void* const context = Call(library, "glXGetCurrentContext"))
    {
      return OpenGLContext{ OpenGLContext::System::GLX, context,
        Call(library, "glXGetCurrentDisplay") };
    }
  }
  if (void* const context = Call("libEGL.so.1", "eglGetCurrentContext"))
  {
    return OpenGLContext{ OpenGLContext::System::EGL, context,
      Call("libEGL.so.1", "eglGetCurrentDisplay") };
  }
  return std::nullopt;
}

} // namespace deformvolume
