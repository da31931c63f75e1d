# SPDX-License-Identifier: BSD-3-Clause
"""A base class of tests that deform a volume with the driver from PyPI in another process, with an empty kernel
cache."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

FOLDER = os.path.dirname(os.path.abspath(__file__))

# Deforms a volume, and prints "deformed", or the error.
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
        """Runs PROGRAM with these environment variables, and returns its output. Its exit status must be 0."""
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
