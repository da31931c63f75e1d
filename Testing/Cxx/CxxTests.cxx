// SPDX-License-Identifier: BSD-3-Clause
// The main function of the tests of the VTK classes. RunTests.h describes the arguments.
#include "RunTests.h"

int main(int argc, char* argv[])
{
  return RunTests(argc, argv);
}
