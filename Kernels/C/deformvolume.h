/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * DeformVolume in C: what other languages call. The library is libdeformvolume.so, and all of its
 * names begin with dv_.
 *
 * Errors. Functions that can fail return DV_OK or another status. dv_last_error() then has a text
 * that says what is wrong and what to do about it. No C++ exception leaves the library.
 *
 * Texts are UTF-8 and end with a zero.
 *
 * Threads. All functions may be called from several threads at once, but not for one object
 * (volume, mesh, ...) from two threads at once.
 */
#ifndef deformvolume_h
#define deformvolume_h

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

#if defined(_WIN32)
#define DV_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define DV_EXPORT __attribute__((visibility("default")))
#else
#define DV_EXPORT
#endif

/* ---- Versions and errors ---- */

/* The version of this interface. It grows with every change that programs which were compiled
 * before do not survive. A change that only adds functions, or members at the end of structures
 * that begin with their size, leaves it. */
#define DV_ABI_VERSION 1

  /* The DV_ABI_VERSION that the library was built with. Programs that load the library at run time
   * compare it with their own before they call anything else. */
  DV_EXPORT int32_t dv_abi_version(void);

  /* The version of DeformVolume, such as "0.2.0". The text lives as long as the process. */
  DV_EXPORT const char* dv_version(void);

  /* What functions return. */
  enum
  {
    DV_OK = 0,
    DV_ERROR = 1,  /* dv_last_error() has the reason */
    DV_ABORTED = 2 /* a progress callback asked for the end */
  };

  /* Why the last function of this thread that returned DV_ERROR failed. Empty where none has
   * failed. The text belongs to the library, and stays until the next function of this thread
   * fails. */
  DV_EXPORT const char* dv_last_error(void);

  /* ---- Devices and drivers ---- */

  /* Of dv_device_flags(). */
  enum
  {
    DV_DEVICE_PROCESSOR = 1, /* a processor, by a driver for processors */
    DV_DEVICE_EMULATED = 2,  /* a renderer in software, or an interpreter: slow */
    DV_DEVICE_DOUBLE = 4     /* has double precision */
  };

  /* Adds an OpenCL driver that the system does not list, such as PoCL from a Python package. path:
   * the absolute path of the driver's library, which is loaded and stays loaded. The same path
   * again does nothing. Devices of drivers that were added come before equal ones of the system.
   * Indices of devices may change. Environment variables are neither read nor written for that.
   * Fails where the path is not absolute, where the library cannot be loaded, or where it is no
   * OpenCL driver. */
  DV_EXPORT int32_t dv_add_driver(const char* path);

  /* The number of OpenCL devices, the best first; 0 where there is none. The first call starts the
   * drivers, which may take some tenths of a second. */
  DV_EXPORT int32_t dv_device_count(void);

  /* The name of a device, "device (platform)", 0 <= index < dv_device_count(). Null, with an error,
   * where there is no such device. The text belongs to the library, and stays until the next call
   * of this function from this thread. */
  DV_EXPORT const char* dv_device_name(int32_t index);

  /* What a device is: a sum of DV_DEVICE_... -1, with an error, where there is no such device. */
  DV_EXPORT int32_t dv_device_flags(int32_t index);

#ifdef __cplusplus
}
#endif

#endif
