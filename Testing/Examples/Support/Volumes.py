# SPDX-License-Identifier: BSD-3-Clause
"""Makes, reads and writes small volumes, and calls programs."""
import functools
import os
import shutil
import subprocess
import sys

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter


def make_ball(dimensions=(25, 22, 19), spacing=(1.0, 1.5, 2.0), origin=(-3.0, 5.0, 7.0),
              direction=(1, 0, 0, 0, 1, 0, 0, 0, 1)):
    """Returns a volume of signed 16-bit integers: a bright ball in the middle, and noise around it."""
    image = vtkImageData()
    image.SetDimensions(*dimensions)
    image.SetSpacing(*spacing)
    image.SetOrigin(*origin)
    image.SetDirectionMatrix(*direction)
    z, y, x = numpy.meshgrid(*(numpy.arange(n, dtype=float) for n in reversed(dimensions)),
                             indexing="ij")
    middle = [(n - 1) / 2 for n in dimensions]
    radius = numpy.sqrt(sum(((index - center) * step) ** 2
                            for index, center, step in zip((x, y, z), middle, spacing)))
    noise = numpy.random.default_rng(1).integers(0, 50, x.shape)
    values = numpy.where(radius < 9.0, 800, 0) + noise
    array = numpy_to_vtk(values.astype(numpy.int16).ravel(), deep=True)
    array.SetName("Values")
    image.GetPointData().SetScalars(array)
    return image


def get_values(image, name=None):
    """Returns the values as an array [z, y, x]."""
    data = image.GetPointData()
    array = data.GetArray(name) if name else data.GetScalars()
    return vtk_to_numpy(array).reshape(image.GetDimensions()[::-1])


def write_vti(image, path):
    writer = vtkXMLImageDataWriter()
    # Not appended: with recent versions of libexpat, ParaView 5.11 cannot read appended data.
    writer.SetDataModeToBinary()
    writer.SetInputData(image)
    writer.SetFileName(path)
    assert writer.Write(), path


def read_vti(path):
    reader = vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def begin_test(name):
    """Returns the arguments of this script, the last of which is a folder. In its place returns a function path(file)
    for the files of this test. They are in an empty folder therein, path()."""
    *arguments, parent = sys.argv[1:]
    folder = os.path.join(parent, name)
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    return *arguments, functools.partial(os.path.join, folder)


def call(*command, code=0, environment=None, quiet=False):
    """Calls a program, checks its exit code (None: any), and returns its standard output and standard error.
    quiet: does not print them, because expected errors of VTK in the output would fail the test."""
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                            timeout=240, check=False, env=environment)
    print("$", *command)
    if not quiet:
        print(result.stdout + result.stderr)
    assert code in (None, result.returncode), f"exit code {result.returncode} instead of {code}"
    return result.stdout, result.stderr
