# SPDX-License-Identifier: BSD-3-Clause
"""Devices and drivers on a system without a driver: the driver from PyPI, and environment variables. Each case is a
process of its own, since a process chooses its drivers once."""

import os
import subprocess
import sys
import unittest

PROGRAM = """
import os
before = dict(os.environ), open("/proc/self/environ", "rb").read()
import deformvolume
try:
    for device in deformvolume.devices():
        print(device.name, device.is_processor, device.is_emulated, device.double_precision, sep="|")
except deformvolume.Error as error:
    print("Error:", error)
assert before == (dict(os.environ), open("/proc/self/environ", "rb").read())
"""

POCL = "(Portable Computing Language)|True|False|True"


def run(**variables):
    """Runs PROGRAM with these environment variables, and returns the lines of its output."""
    environment = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("OCL_", "DEFORMVOLUME_"))
    }
    environment.update(variables)
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        universal_newlines=True,
        check=False,
    )
    if done.returncode != 0:
        raise AssertionError(f"status {done.returncode}: {done.stdout}")
    return done.stdout.splitlines()


def find_driver():
    from deformvolume import _driver

    return _driver.find_pypi_driver()


class Devices(unittest.TestCase):
    def expect_error(self, words, **variables):
        lines = run(**variables)
        self.assertEqual(len(lines), 1, lines)
        self.assertRegex(lines[0], "^Error: .*" + words)

    def test_missing_driver(self):
        self.expect_error("/nowhere/lib.so.* cannot be loaded", DEFORMVOLUME_DRIVER="/nowhere/lib.so")

    def test_file_that_is_not_a_driver(self):
        self.expect_error("not a usable OpenCL driver.*invalid ELF", DEFORMVOLUME_DRIVER="/etc/passwd")

    def test_unknown_value(self):
        self.expect_error('DEFORMVOLUME_DRIVER is "pocl"', DEFORMVOLUME_DRIVER="pocl")

    def test_no_driver(self):
        self.assertEqual(run(DEFORMVOLUME_DRIVER="system"), [])

    def test_vendors_are_respected(self):
        self.assertEqual(run(OCL_ICD_VENDORS="/nowhere"), [])
        self.assertEqual(run(OCL_ICD_FILENAMES="/nowhere/lib.so"), [])

    def expect_pocl(self, **variables):
        lines = run(**variables)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn(POCL, lines[0])

    def test_driver_from_pypi(self):
        self.assertTrue(os.path.isabs(find_driver()))
        self.expect_pocl()
        self.expect_pocl(DEFORMVOLUME_DRIVER="")
        self.expect_pocl(DEFORMVOLUME_DRIVER="auto")
        self.expect_pocl(DEFORMVOLUME_DRIVER="pypi", OCL_ICD_VENDORS="/nowhere")
        self.expect_pocl(DEFORMVOLUME_DRIVER=find_driver())

    # If the system has a driver for CPUs, the driver from PyPI is not added. Devices of a driver that is listed twice
    # are listed once.
    def test_driver_of_the_system(self):
        self.expect_pocl(OCL_ICD_VENDORS=find_driver())
        self.expect_pocl(OCL_ICD_VENDORS=find_driver(), DEFORMVOLUME_DRIVER="pypi")
        self.expect_pocl(OCL_ICD_FILENAMES=find_driver(), DEFORMVOLUME_DRIVER="system")
        self.expect_pocl(OCL_ICD_FILENAMES=f"{find_driver()}:{find_driver()}", DEFORMVOLUME_DRIVER="system")


if __name__ == "__main__":
    unittest.main()
