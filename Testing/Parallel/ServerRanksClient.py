# SPDX-License-Identifier: BSD-3-Clause
"""The client of TestServerRanks. Arguments: the port of the server, its number of ranks."""

import os
import pickle
import sys

import deformvolume_vtk
import numpy
from paraview import simple
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkIOXML import vtkXMLPImageDataReader

from PluginTesting import (
    OUTPUT,
    arrays_of,
    bent_lattice,
    check,
    check_equal_images,
    check_one_message,
    check_silent,
    fetch,
    load_plugin,
    messages,
    wavelet,
)

# A programmable source that has a mesh on one rank only. If no rank has this number, no rank has the mesh.
ON_ONE_RANK = """
from vtkmodules.vtkParallelCore import vtkMultiProcessController
if vtkMultiProcessController.GetGlobalController().GetLocalProcessId() == {rank}:
    import pickle
    points, cells, vectors = pickle.loads({mesh!r})
    from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
    made = vtkPoints()
    made.SetDataTypeToDouble()
    for point in points:
        made.InsertNextPoint(point)
    output = self.GetUnstructuredGridOutput()
    output.SetPoints(made)
    output.Allocate(len(cells))
    for cell in cells:
        output.InsertNextCell(10, 4, cell)
    array = vtkDoubleArray()
    array.SetName("Displacement")
    array.SetNumberOfComponents(3)
    for vector in vectors:
        array.InsertNextTuple(vector)
    output.GetPointData().SetVectors(array)
"""


def update(filter_):
    with messages() as texts:
        filter_.UpdatePipeline()
    return texts


def whole_image(proxy):
    """Returns the data of all ranks. ParaView's Fetch returns the piece of the first rank."""
    path = os.path.join(OUTPUT, "ServerRanksClient.pvti")
    simple.SaveData(path, proxy=proxy, DataMode="Binary")
    reader = vtkXMLPImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def expected_output(mesh):
    """Returns the output of the class in the client, with the background that ParaView chooses from the data of all
    ranks."""
    source = vtkRTAnalyticSource()
    source.SetWholeExtent(-9, 9, -9, 9, -9, 9)
    source.Update()
    filter_ = deformvolume_vtk.vtkDeformVolumeFilter()
    filter_.SetInputConnection(source.GetOutputPort())
    filter_.SetDeformationData(mesh)
    filter_.SetInputArrayToProcess(0, 1, 0, 0, "Displacement")
    filter_.SetBackgroundValue(source.GetOutput().GetScalarRange()[0])
    filter_.Update()
    return filter_.GetOutput()


def on_rank(mesh, rank):
    """Returns a source that has the mesh on one rank."""
    data = fetch(mesh)
    points = [data.GetPoint(i) for i in range(data.GetNumberOfPoints())]
    cells = []
    for i in range(data.GetNumberOfCells()):
        ids = data.GetCell(i).GetPointIds()
        cells.append([ids.GetId(k) for k in range(4)])
    vectors = arrays_of(data)["Displacement"].tolist()
    source = simple.ProgrammableSource(OutputDataSetType="vtkUnstructuredGrid")
    source.ScriptRequestInformation = (
        "self.GetOutputInformation(0).Set(self.CAN_HANDLE_PIECE_REQUEST(), 1)"
    )
    source.Script = ON_ONE_RANK.format(rank=rank, mesh=pickle.dumps((points, cells, vectors), 2))
    source.UpdatePipeline()
    return source


def main(port, ranks):
    simple.Connect("localhost", port)
    load_plugin(remote=True)
    load_plugin()
    volume = wavelet(9)
    mesh = bent_lattice(volume)
    cells = mesh.GetDataInformation().GetNumberOfCells()
    check(cells == 5 * 5**3, f"All ranks together have {cells} cells, not {5 * 5**3}")
    expected = expected_output(fetch(mesh))

    filter_ = simple.DeformVolume(Volume=volume, Deformation=mesh)
    check(
        list(filter_.DisplacementArray) == ["POINTS", "Displacement"],
        f"DisplacementArray is {list(filter_.DisplacementArray)}",
    )
    check_silent(update(filter_))
    check_equal_images(whole_image(filter_), expected, "three ranks")
    covered = int(numpy.sum(arrays_of(expected)["vtkValidPointMask"]))
    # Voxels on the planes between two pieces are counted twice.
    check(
        covered < filter_.CoveredVoxels < 1.5 * covered,
        f"CoveredVoxels is {filter_.CoveredVoxels}, that of one process is {covered}",
    )
    check(f"Covered voxels: {int(filter_.CoveredVoxels):,}" in filter_.Summary, filter_.Summary)
    for rank in (ranks - 1, 0):
        one = on_rank(mesh, rank)
        only = simple.DeformVolume(Volume=volume, Deformation=one)
        check_silent(update(only))
        check_equal_images(whole_image(only), expected, f"mesh on rank {rank}")

    # The client displays one message, whichever rank fails.
    none = simple.DeformVolume(Volume=volume, Deformation=on_rank(mesh, ranks))
    check_one_message(update(none), ["no points"])
    filter_.Device = "no such device"
    check_one_message(update(filter_), ['no OpenCL device "no such device"'])
    check(filter_.GetDataInformation().GetNumberOfPoints() == 0, "The output is not empty after an error")
    filter_.Device = "best"
    filter_.DisplacementScale = 1.0
    check_silent(update(filter_))
    check_equal_images(whole_image(filter_), expected, "after errors")


main(int(sys.argv[1]), int(sys.argv[2]))
