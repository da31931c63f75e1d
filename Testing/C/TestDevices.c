/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Devices and drivers in C.
 *
 * Usage: TestDevices [--none]
 *   --none  the system has no driver
 */
#include "Check.h"

#include <stdio.h>
#include <string.h>

/* Checks that a driver is rejected, and the reason in the error message. */
static void RefuseDriver(const char* path, const char* reason)
{
  const int32_t count = dv_device_count();
  CHECK(dv_add_driver(path) == DV_ERROR);
  CHECK(strstr(dv_last_error(), reason) != NULL);
  CHECK(dv_device_count() == count);
}

int main(int argc, char* argv[])
{
  const int has_none = argc > 1 && strcmp(argv[1], "--none") == 0;
  int32_t count = 0;
  int32_t i = 0;
  int32_t found = 0;
  char name[200];

  CHECK(dv_abi_version() == DV_ABI_VERSION);
  CHECK(strchr(dv_version(), '.') != NULL);
  CHECK(strcmp(dv_last_error(), "") == 0);

  RefuseDriver(NULL, "null");
  RefuseDriver("", "absolute");
  RefuseDriver("libpocl.so", "absolute");
  RefuseDriver("/nowhere/libpocl.so", "\"/nowhere/libpocl.so\" cannot be loaded");
  RefuseDriver("/", "is not a usable OpenCL driver");
  RefuseDriver("/etc/passwd", "invalid ELF header");

  CHECK(dv_set_linker(NULL) == DV_ERROR && strstr(dv_last_error(), "null") != NULL);
  CHECK(dv_set_linker("linker") == DV_ERROR && strstr(dv_last_error(), "absolute") != NULL);

  count = dv_device_count();
  CHECK(has_none ? count == 0 : count > 0);
  CHECK(dv_device_name(-1) == NULL);
  CHECK(dv_device_name(count) == NULL);
  CHECK(strstr(dv_last_error(), "There is no OpenCL device") != NULL);
  CHECK(dv_device_flags(-1) == -1);
  CHECK(dv_device_flags(count) == -1);
  for (i = 0; i < count; ++i)
  {
    CHECK(dv_device_name(i) != NULL && strchr(dv_device_name(i), '(') != NULL);
    CHECK(dv_device_flags(i) >= 0 && dv_device_flags(i) < 8);
  }

#ifdef POCL_LIBRARY
  /* If the same driver is added again, its devices are listed once. */
  CHECK(dv_add_driver(POCL_LIBRARY) == DV_OK);
  CHECK(dv_add_driver(POCL_LIBRARY) == DV_OK);
  CHECK(dv_device_count() == (has_none ? 1 : count));
  for (i = 0, found = 0; i < dv_device_count(); ++i)
  {
    CHECK(dv_device_name(i) != NULL && strlen(dv_device_name(i)) < sizeof(name));
    strcpy(name, dv_device_name(i));
    CHECK(strstr(name, "#2") == NULL);
    if (strstr(name, "Portable Computing Language") != NULL)
    {
      ++found;
      CHECK(dv_device_flags(i) & DV_DEVICE_PROCESSOR);
    }
  }
  CHECK(found == 1);
#else
  (void)name;
  (void)found;
#endif
  printf("%d failures\n", Failures);
  return Failures != 0;
}
