# SPDX-License-Identifier: BSD-3-Clause
"""On a system without a working linker, PoCL uses the linker of the package. If that is disabled, a failure raises an
error and does not end the process."""

import os
import unittest

from own_process import OwnProcess


class Linker(OwnProcess):
    def write_program(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w") as file:
            file.write(text)
        os.chmod(path, 0o755)

    def test_unknown_value(self):
        self.assertRegex(
            self.run_program(DEFORMVOLUME_LINKER="ld"), 'Error: .*DEFORMVOLUME_LINKER is "ld"'
        )

    def test_no_linker(self):
        output = self.run_program(DEFORMVOLUME_LINKER="system", PATH=self.folder)
        self.assertRegex(output, 'Error: The kernels cannot be compiled: .*"ld".*cannot be run')

    # The system has a linker that fails.
    def test_linker_that_fails(self):
        self.write_program("ld", "#!/bin/sh\necho ld: cannot find -lgcc >&2\nexit 1\n")
        output = self.run_program(DEFORMVOLUME_LINKER="system", PATH=self.folder)
        self.assertRegex(output, "Error: The kernels cannot be compiled: .*cannot find -lgcc")

    def test_own_linker(self):
        self.assertEqual(self.run_program(PATH=self.folder), "deformed\n")
        # The next process uses the kernels in the cache.
        self.assertEqual(self.run_program(PATH=self.folder), "deformed\n")

    def test_own_linker_in_place_of_one_that_fails(self):
        self.write_program("ld", "#!/bin/sh\nexit 1\n")
        self.assertEqual(self.run_program(PATH=self.folder), "deformed\n")

    def test_own_linker_with_a_path_of_the_user(self):
        self.assertEqual(
            self.run_program(PATH=self.folder, COMPILER_PATH="/nowhere"), "deformed\n"
        )

    def test_own_linker_on_demand(self):
        self.assertEqual(self.run_program(DEFORMVOLUME_LINKER="own"), "deformed\n")


if __name__ == "__main__":
    unittest.main()
