// SPDX-License-Identifier: BSD-3-Clause
// The main function of the programs of tests. CTest runs one process per source file, as the device
// and the compiled kernels are fixed within a process.
//
// Usage: PROGRAM [--files=NAME,...] [-T FOLDER] [-D FOLDER] [-V FILE] [OPTION OF GOOGLETEST]...
//   --files  run only the tests of these sources, such as --files=TestColumns,TestFolded
//   -T       the folder for output, which is made if it does not exist
//   -D       the folder Testing/Data
//   -V       the baseline of a picture
#ifndef RunTests_h
#define RunTests_h

#include <string>

/// Runs the tests of a program. Returns 0 if they pass, 125 if all were skipped, 1 if one failed,
/// and 2, after printing why, if the arguments are wrong or select no test.
int RunTests(int argc, char* argv[]);

/// Returns the argument that follows -T, -D or -V; "." if it is missing.
std::string GetTestArgument(const std::string& option);

#endif
