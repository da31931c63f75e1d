# SPDX-License-Identifier: BSD-3-Clause
"""Tests ParaView's pvbatch with one, two, three and eight ranks: data are equal to the last bit, of a volume that is
deformed, and of one that is cut, carved and dragged. Pictures are nearly equal.

Arguments: mpiexec, pvbatch, the plugin, the folder for output.
"""
import os
import subprocess
import sys

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkImageData, vtkUnstructuredGrid
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataWriter, vtkXMLPImageDataReader, vtkXMLUnstructuredGridWriter)

mpiexec, pvbatch, plugin, output = sys.argv[1:]
here = os.path.dirname(os.path.abspath(__file__))
volume = os.path.join(output, "TestParaViewRanks.vti")

source = vtkRTAnalyticSource()
source.SetWholeExtent(-30, 29, -28, 30, -31, 31)
writer = vtkXMLImageDataWriter()
writer.SetInputConnection(source.GetOutputPort())
writer.SetFileName(volume)
writer.SetDataModeToBinary()  # ParaView 5.11 cannot read what VTK appends
writer.Write()


def write_mesh(pieces):
    """Writes a mesh of tetrahedra to a file with several pieces. A filter of ParaView could redistribute a mesh
    instead, but ParaView 5.11 sends meshes between ranks as appended data, which it cannot read."""
    box = vtkImageData()
    box.SetDimensions(7, 7, 7)
    box.SetOrigin(-32, -31, -33)
    box.SetSpacing(64 / 6, 62 / 6, 66 / 6)
    split = vtkDataSetTriangleFilter()
    split.SetInputData(box)
    split.Update()
    grid = split.GetOutput()
    x, y, z = vtk_to_numpy(grid.GetPoints().GetData()).astype(float).T
    vectors = numpy.stack([6 * numpy.sin(0.09 * y), 5 * numpy.cos(0.07 * z), 0.2 * x], axis=1)
    displacements = numpy_to_vtk(vectors, deep=1)
    displacements.SetName("displacement")
    grid.GetPointData().AddArray(displacements)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetDataModeToBinary()
    for piece in range(pieces):
        part = vtkUnstructuredGrid()
        part.SetPoints(grid.GetPoints())
        part.GetPointData().ShallowCopy(grid.GetPointData())
        for cell in range(piece, grid.GetNumberOfCells(), pieces):
            part.InsertNextCell(VTK_TETRA, grid.GetCell(cell).GetPointIds())
        writer.SetInputData(part)
        writer.SetFileName(f"{mesh[:-5]}_{piece}.vtu")
        writer.Write()
    sources = [f'<Piece Source="{os.path.basename(mesh)[:-5]}_{i}.vtu"/>' for i in range(pieces)]
    with open(mesh, "w", encoding="ascii") as file:
        file.write(
            '<VTKFile type="PUnstructuredGrid" version="0.1"><PUnstructuredGrid GhostLevel="0">'
            '<PPointData><PDataArray type="Float64" Name="displacement" NumberOfComponents="3"/>'
            '</PPointData><PPoints><PDataArray type="Float32" NumberOfComponents="3"/></PPoints>'
            + "".join(sources) + "</PUnstructuredGrid></VTKFile>")


mesh = os.path.join(output, "TestParaViewRanks.pvtu")
write_mesh(3)


def read(name):
    """Returns the extent of a volume in a file with pieces, and its arrays by name."""
    reader = vtkXMLPImageDataReader()
    reader.SetFileName(name)
    reader.Update()
    volume = reader.GetOutput()
    arrays = {}
    for data in (volume.GetPointData(), volume.GetCellData()):
        for i in range(data.GetNumberOfArrays()):
            arrays[data.GetArrayName(i)] = vtk_to_numpy(data.GetArray(i))
    return volume.GetExtent(), arrays


def run(ranks):
    prefix = os.path.join(output, f"TestParaViewRanks{ranks}")
    command = [mpiexec, "-n", str(ranks), pvbatch, os.path.join(here, "ParaViewPipeline.py")]
    subprocess.run(command + [plugin, prefix, volume, mesh, str(ranks)], check=True, timeout=200)
    picture = vtkPNGReader()
    picture.SetFileName(prefix + ".png")
    picture.Update()
    pixels = vtk_to_numpy(picture.GetOutput().GetPointData().GetScalars())
    volumes = {what: read(f"{prefix}{what}.pvti") for what in ("", "-edited", "-dragged")}
    return volumes, pixels.astype(float)


serial, serial_picture = run(1)
deformed, edited, dragged = (serial[what][1] for what in ("", "-edited", "-dragged"))
for arrays, names in ((deformed, ["RTData", "vtkValidPointMask"]),
                      (edited, ["ActiveTetrahedra", "RTData", "vtkGhostType"]),
                      (dragged, ["RTData", "vtkValidPointMask"])):
    if sorted(arrays) != names:
        sys.exit(f"the arrays are {sorted(arrays)}, not {names}")
for mask in (deformed["vtkValidPointMask"], dragged["vtkValidPointMask"]):
    if not 0.5 * mask.size < mask.sum() < mask.size:
        sys.exit(f"expected more than half of the voxels to be covered, but not all: {mask.sum()} of {mask.size}")
# A plane cuts 58 x 62 cells, and a carved ball adds about 2,100.
off = (edited["ActiveTetrahedra"] & 31 != 31).sum()
if not 58 * 62 + 2000 < off < 58 * 62 + 3000:
    sys.exit(f"expected 5596 to 6596 cells with tetrahedra switched off, not {off}")
moved = (dragged["RTData"] != edited["RTData"]).sum()
if not 8000 < moved < 0.5 * dragged["RTData"].size:
    sys.exit(f"the drag changes {moved} of {dragged['RTData'].size} voxels, expected over 8000 and under half")
if serial_picture.std() < 10.0:
    sys.exit(f"the picture is empty: the standard deviation is {serial_picture.std()}")
for ranks in (2, 3, 8):
    parallel, picture = run(ranks)
    for what, (extent, arrays) in serial.items():
        if parallel[what][0] != extent:
            sys.exit(f"{ranks} ranks: extent {parallel[what][0]} instead of {extent}{what}")
        for name, expected in arrays.items():
            actual = parallel[what][1][name]
            if expected.tobytes() != actual.tobytes():
                sys.exit(f"{ranks} ranks: {(expected != actual).sum()} values of {name}{what} differ")
    # Pictures differ because ranks blend their parts of a ray with 8 bits, and sampling starts again in each part.
    difference = numpy.abs(picture - serial_picture)
    print(f"{ranks} ranks: pixels differ by {difference.mean():.3f} on average, "
          f"{difference.max():.0f} at most")
    if difference.mean() > 0.2 or difference.max() > 8.0:
        sys.exit(f"{ranks} ranks: pictures may differ by 0.2 on average and by 8 at most")
