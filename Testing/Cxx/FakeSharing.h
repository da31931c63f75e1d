// SPDX-License-Identifier: BSD-3-Clause
// The extension cl_khr_gl_sharing for drivers that lack it, as far as buffers go: the values of a
// buffer go to OpenGL when OpenCL releases it, by way of the host. Programs that link it take its
// functions in place of those of the OpenCL library, as with FakeDriver.h.
#ifndef FakeSharing_h
#define FakeSharing_h

#include <atomic>

struct FakeSharing
{
  /// The device is not the one that draws.
  bool DrawsElsewhere = false;
  ///@{
  /// OpenCL gets no buffer to work with, or nothing is copied to it, unless 0: this error instead.
  int AcquireError = 0;
  int CopyError = 0;
  ///@}

  /// Contexts that were made to share with OpenGL, buffers that were shared and still are, and
  /// copies to such.
  int Contexts = 0;
  std::atomic<int> Buffers{
    0
  }; // drivers may let go of them in threads of their own, somewhat later
  int Copies = 0;
  /// Copies to buffers that OpenCL did not have.
  int WrongCopies = 0;
  /// Buffers that OpenCL has, and OpenGL must not use.
  int Held = 0;

  /// Waits until so many buffers are shared, and returns whether that is so in the end.
  bool WaitForBuffers(int number) const;

  static FakeSharing& Get();
};

#endif
