# SPDX-License-Identifier: BSD-3-Clause
"""The CPU that the driver from PyPI compiles kernels for: DEFORMVOLUME_KERNEL_PROCESSOR decides whether the package or
the driver chooses it."""

import unittest

from own_process import OwnProcess


class Processor(OwnProcess):
    def test_unknown_value(self):
        self.assertRegex(
            self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR="zen"),
            'Error: .*DEFORMVOLUME_KERNEL_PROCESSOR is "zen". Set it to auto or driver.',
        )

    def test_chosen_by_package(self):
        self.assertEqual(self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR=""), "deformed\n")
        self.assertEqual(self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR="auto"), "deformed\n")

    # The driver does not compile kernels for CPUs that are newer than the driver.
    def test_chosen_by_driver(self):
        output = self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR="driver")
        if output != "deformed\n":
            self.assertRegex(
                output, "(?s)Error: .*(older than this CPU|would end the process).*pocl-opencl-icd"
            )


if __name__ == "__main__":
    unittest.main()
