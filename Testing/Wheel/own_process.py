# SPDX-License-Identifier: BSD-3-Clause
"""Tests that have a volume deformed by the driver from PyPI in a process of its own, with an empty kernel
cache."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

FOLDER = os.path.dirname(os.path.abspath(__file__))

# Prints what becomes of it.
PROGRAM = """
import ctypes, sys
sys.path.insert(0, {folder!r})
import numpy
getenv = ctypes.CDLL(None).getenv
getenv.restype = ctypes.c_char_p
before = getenv(b"COMPILER_PATH")
import deformvolume
from moving_cube import deform
try:
    volume, output, coverage = deform()
except deformvolume.Error as error:
    print("Error:", error)
else:
    numpy.testing.assert_array_equal(output, volume)
    print("deformed")
assert getenv(b"COMPILER_PATH") == before
"""


class OwnProcess(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()

    def tearDown(self):
        shutil.rmtree(self.folder)

    def run_program(self, **variables):
        """What PROGRAM prints with these environment variables. It must not end by a signal or a traceback."""
        environment = dict(os.environ, POCL_CACHE_DIR=os.path.join(self.folder, "cache"))
        environment["DEFORMVOLUME_DRIVER"] = "pypi"
        environment.update(variables)
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM.format(folder=FOLDER)],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout
