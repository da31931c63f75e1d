// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCurrentOpenGLContext_h
#define DeformVolumeCurrentOpenGLContext_h

#include "OpenGLSharing.h"

#include <optional>

namespace deformvolume
{

/// The OpenGL context that is current in this thread, whoever made it; nothing where there is none
/// of GLX or EGL.
std::optional<OpenGLContext> FindCurrentOpenGLContext();

} // namespace deformvolume

#endif
