# SPDX-License-Identifier: BSD-3-Clause
"""Compares pictures with baselines. As with VTK's own regression tests, a picture may have several baselines and has to
match one of them: BASELINE.png, BASELINE_1.png and so on. One reason is that VTK 9.6 shades volumes differently."""
import glob

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader


def read_picture(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3).astype(float)


def read_baselines(path):
    return [read_picture(each) for each in [path, *glob.glob(path.replace(".png", "_*.png"))]]


def find_difference(path, baselines):
    """Returns the mean difference of the color components (0 to 255) from the most similar baseline."""
    drawn = read_picture(path)
    assert drawn.shape == baselines[0].shape, (drawn.shape, baselines[0].shape)
    difference = min(numpy.abs(drawn - expected).mean() for expected in baselines)
    print(f"{path} differs from the baseline by {difference}")
    return difference
