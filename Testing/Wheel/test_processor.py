# SPDX-License-Identifier: BSD-3-Clause
"""What the driver from PyPI compiles kernels for: a member of its own structure is set, or it is left alone."""

import unittest

from own_process import OwnProcess


class Processor(OwnProcess):
    def test_unknown_word(self):
        self.assertRegex(
            self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR="zen"),
            'Error: .*DEFORMVOLUME_KERNEL_PROCESSOR is "zen". Set it to auto or driver.',
        )

    def test_set(self):
        self.assertEqual(self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR=""), "deformed\n")
        self.assertEqual(self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR="auto"), "deformed\n")

    # The driver alone knows the processors of its time. It compiles nothing for later ones.
    def test_left_alone(self):
        output = self.run_program(DEFORMVOLUME_KERNEL_PROCESSOR="driver")
        if output != "deformed\n":
            self.assertRegex(
                output, "(?s)Error: .*(older than this CPU|would end the process).*pocl-opencl-icd"
            )


if __name__ == "__main__":
    unittest.main()
