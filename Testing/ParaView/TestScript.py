# SPDX-License-Identifier: BSD-3-Clause
"""Runs the example Examples/paraview/deform_ct.py by pvbatch, with a synthetic CT of a body with two bones, and a mesh
with two arrays of vectors. The picture is compared with its baseline. With the other array, and with a mesh that is
shifted by a voxel, it must differ. Usage: TestScript.py SCRIPT BASELINE [--update]"""

import os
import shutil
import subprocess
import sys

import deformvolume_vtk
import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLUnstructuredGridWriter

from Baselines import find_difference, read_baselines
from PluginTesting import OUTPUT, PLUGIN, check

CT = os.path.join(OUTPUT, "TestScript.vti")
SPACING = 4.0


def write(writer, data, path):
    writer.SetFileName(path)
    writer.SetInputData(data)
    writer.SetDataModeToBinary()  # ParaView 5.11 cannot read VTK's appended data
    check(writer.Write() == 1, f"{path} is not written")


def make_ct():
    """Returns a CT in Hounsfield units, of type short: air, soft tissue, and two bones along z."""
    size = (48, 40, 52)
    image = vtkImageData()
    image.SetDimensions(size)
    image.SetSpacing([SPACING] * 3)
    image.SetOrigin([-0.5 * SPACING * (count - 1) for count in size])
    axes = [image.GetOrigin()[i] + SPACING * numpy.arange(size[i]) for i in range(3)]
    z, y, x = numpy.meshgrid(*reversed(axes), indexing="ij")
    values = numpy.full(z.shape, -1024.0)
    values[(x / 80) ** 2 + (y / 62) ** 2 + (z / 90) ** 2 < 1] = 40
    for side in (-35, 35):
        values[((x - side) ** 2 + y**2 < 12**2) & (numpy.abs(z) < 70)] = 700
    scalars = numpy_to_vtk(values.ravel().astype(numpy.int16), deep=True)
    scalars.SetName("HU")
    image.GetPointData().SetScalars(scalars)
    return image


def make_mesh(image, shift):
    """Returns a lattice with displacements in the array U, and with other vectors, which are active."""
    lattice = deformvolume_vtk.vtkLatticeTetrahedraSource()
    lattice.SetInputData(image)
    lattice.SetNumberOfNodes(11, 11, 11)
    lattice.Update()
    mesh = lattice.GetOutput()
    z = vtk_to_numpy(mesh.GetPoints().GetData())[:, 2].astype(float)
    bend = numpy.stack([40 * (z / 100) ** 2 + shift, 0 * z, 0 * z], axis=1)
    for name, vectors in (("V", 0.3 * bend), ("U", bend)):
        array = numpy_to_vtk(vectors, deep=True)
        array.SetName(name)
        mesh.GetPointData().AddArray(array)
    mesh.GetPointData().SetActiveVectors("V")
    return mesh


def draw(script, image, array, shift, name):
    mesh_file = os.path.join(OUTPUT, f"TestScript.{name}.vtu")
    picture = os.path.join(OUTPUT, f"TestScript.{name}.png")
    write(vtkXMLUnstructuredGridWriter(), make_mesh(image, shift), mesh_file)
    pvbatch = os.path.join(os.path.dirname(os.environ["DEFORMVOLUME_PVPYTHON"]), "pvbatch")
    run = subprocess.run(
        [pvbatch, script, PLUGIN, CT, mesh_file, array, picture],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=120,
    )
    check(run.returncode == 0 and "Covered voxels" in run.stdout, f"{name}: {run.stdout}")
    check("ERR|" not in run.stdout and "WARN|" not in run.stdout, f"{name}: {run.stdout}")
    return picture


def main(script, baseline, is_update):
    image = make_ct()
    write(vtkXMLImageDataWriter(), image, CT)
    picture = draw(script, image, "U", 0, "intact")
    if is_update:
        shutil.copy(picture, baseline)
    baselines = read_baselines(baseline)
    limit = 0.5
    difference = find_difference(picture, baselines)
    check(difference < limit, f"{picture} differs from {baseline} by {difference} of 255")
    for name, array, shift in (("other", "V", 0), ("shifted", "U", SPACING)):
        other = find_difference(draw(script, image, array, shift, name), baselines)
        check(
            other > 2 * limit,
            f"{name}: the spoiled picture must differ by more than {2 * limit}, not {other} of 255",
        )


main(sys.argv[1], sys.argv[2], "--update" in sys.argv)
