# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's pvbatch with one, two and three ranks: equal data to the last bit, and nearly equal
pictures of the volume.

Arguments: mpiexec, pvbatch, the plugin, the folder for output.
"""
import os
import subprocess
import sys

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLPImageDataReader

mpiexec, pvbatch, plugin, output = sys.argv[1:]
here = os.path.dirname(os.path.abspath(__file__))
volume = os.path.join(output, "TestParaViewRanks.vti")

source = vtkRTAnalyticSource()
source.SetWholeExtent(-30, 29, -28, 30, -31, 31)
writer = vtkXMLImageDataWriter()
writer.SetInputConnection(source.GetOutputPort())
writer.SetFileName(volume)
writer.SetDataModeToBinary()  # this ParaView cannot read what VTK appends
writer.Write()


def run(ranks):
    prefix = os.path.join(output, f"TestParaViewRanks{ranks}")
    command = [mpiexec, "-n", str(ranks), pvbatch, os.path.join(here, "ParaViewPipeline.py")]
    subprocess.run(command + [plugin, prefix, volume, str(ranks)], check=True, timeout=200)
    reader = vtkXMLPImageDataReader()
    reader.SetFileName(prefix + ".pvti")
    reader.Update()
    picture = vtkPNGReader()
    picture.SetFileName(prefix + ".png")
    picture.Update()
    pixels = vtk_to_numpy(picture.GetOutput().GetPointData().GetScalars())
    return reader.GetOutput(), pixels.astype(float)


serial, serial_picture = run(1)
names = [serial.GetPointData().GetArrayName(i) for i in range(2)]
if sorted(names) != ["RTData", "vtkValidPointMask"]:
    sys.exit(f"unexpected arrays {names}")
mask = vtk_to_numpy(serial.GetPointData().GetArray("vtkValidPointMask"))
if not 0.5 * mask.size < mask.sum() < mask.size:
    sys.exit(f"{mask.sum()} of {mask.size} voxels are covered")
if serial_picture.std() < 10.0:
    sys.exit("the picture is empty")
for ranks in (2, 3):
    parallel, picture = run(ranks)
    if parallel.GetExtent() != serial.GetExtent():
        sys.exit(f"{ranks} ranks: extent {parallel.GetExtent()} instead of {serial.GetExtent()}")
    for name in names:
        expected = vtk_to_numpy(serial.GetPointData().GetArray(name))
        actual = vtk_to_numpy(parallel.GetPointData().GetArray(name))
        if expected.tobytes() != actual.tobytes():
            sys.exit(f"{ranks} ranks: {(expected != actual).sum()} values of {name} differ")
    # Ranks blend their parts of a ray in 8 bits, and a ray starts anew in each part.
    difference = numpy.abs(picture - serial_picture)
    print(f"{ranks} ranks: pixels differ by {difference.mean():.3f} on average, "
          f"{difference.max():.0f} at most")
    if difference.mean() > 0.2 or difference.max() > 8.0:
        sys.exit(f"{ranks} ranks: the pictures differ")
