# SPDX-License-Identifier: BSD-3-Clause
"""Makes a small mesh as each type of dataset that mesh files can contain, and writes the files."""
import os

import numpy
from HdfFiles import write_vtkhdf
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (
    VTK_HEXAHEDRON,
    VTK_TETRA,
    vtkMultiBlockDataSet,
    vtkPolyData,
    vtkRectilinearGrid,
    vtkStructuredGrid,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkIOExodus import vtkExodusIIWriter

SIZE = (3, 4, 5)


def to_vtk(name, values):
    array = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def make_places(bounds):
    """Returns the nodes of a grid of SIZE nodes over a box, with x running fastest. The numbers of the box are exact
    in single precision, which Exodus files have."""
    axes = [numpy.linspace(bounds[2 * axis], bounds[2 * axis + 1], SIZE[axis]).astype(
        numpy.float32).astype(float) for axis in range(3)]
    z, y, x = numpy.meshgrid(*reversed(axes), indexing="ij")
    return axes, numpy.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def make_moves(places):
    """Returns displacements that are not exact in single precision."""
    x, y, z = (places - places.mean(axis=0)).T / numpy.ptp(places, axis=0).max()
    return numpy.stack([2.1 + 0.7 * y, 1.3 * numpy.sin(3 * z), 1.1 * x * y - 0.3], axis=1)


def make_hexahedra():
    """Returns the hexahedra of the grid."""
    nx, ny, nz = SIZE
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    return [[x + dx + nx * (y + dy + ny * (z + dz)) for dx, dy, dz in corners]
            for z in range(nz - 1) for y in range(ny - 1) for x in range(nx - 1)]


def make_tetrahedra():
    """Returns six tetrahedra for each hexahedron, around its diagonal. So the split does not depend on node numbers."""
    ring = (1, 2, 3, 7, 4, 5, 1)
    return [[cell[0], cell[a], cell[b], cell[6]] for cell in make_hexahedra()
            for a, b in zip(ring, ring[1:])]


def add_arrays(data, moves):
    """Adds the array of displacements, between two other arrays."""
    temperature = 300 + numpy.arange(len(moves), dtype=float)
    for name, values in (("Temperature", temperature), ("Reaction", 100 * moves),
                         ("Displacement", moves)):
        data.GetPointData().AddArray(to_vtk(name, values))
    return data


def to_points(places):
    points = vtkPoints()
    points.SetData(to_vtk("Points", places))
    return points


def make_unstructured(places, moves, cells=None):
    grid = vtkUnstructuredGrid()
    grid.SetPoints(to_points(places))
    for cell in make_tetrahedra() if cells is None else cells:
        grid.InsertNextCell(VTK_TETRA if len(cell) == 4 else VTK_HEXAHEDRON, len(cell), cell)
    return add_arrays(grid, moves)


def make_structured(places, moves):
    grid = vtkStructuredGrid()
    grid.SetDimensions(*SIZE)
    grid.SetPoints(to_points(places))
    return add_arrays(grid, moves)


def make_rectilinear(axes, moves):
    grid = vtkRectilinearGrid()
    grid.SetDimensions(*SIZE)
    grid.SetXCoordinates(to_vtk("x", axes[0]))
    grid.SetYCoordinates(to_vtk("y", axes[1]))
    grid.SetZCoordinates(to_vtk("z", axes[2]))
    return add_arrays(grid, moves)


def make_blocks(*parts):
    blocks = vtkMultiBlockDataSet()
    for number, (name, part) in enumerate(parts):
        blocks.SetBlock(number, part)
        blocks.GetMetaData(number).Set(vtkMultiBlockDataSet.NAME(), name)
    return blocks


def make_sheet(bounds, x):
    """Returns a rectangle, perpendicular to x, which is larger than a box."""
    plane = vtkPlaneSource()
    plane.SetOrigin(x, bounds[2] - 1, bounds[4] - 1)
    plane.SetPoint1(x, bounds[3] + 1, bounds[4] - 1)
    plane.SetPoint2(x, bounds[2] - 1, bounds[5] + 1)
    plane.Update()
    return plane.GetOutput()


def make_handles(pull):
    """Returns the handle of an argument of --pull, and its radius."""
    numbers = numpy.array(pull.split(","), float)
    handles = vtkPolyData()
    handles.SetPoints(to_points([numbers[:3] + numbers[3:6]]))
    handles.GetPointData().AddArray(to_vtk("RestPosition", [numbers[:3]]))
    return handles, numbers[6]


def state_space(data, space):
    """States the world of a mesh as 3D Slicer does in .vtu and .vtp files."""
    array = vtkStringArray()
    array.SetName("SPACE")
    array.InsertNextValue(space)
    data.GetFieldData().AddArray(array)
    return data


def write(writer, data, path, **settings):
    """Writes data with a writer. settings: methods of the writer and their arguments."""
    writer.SetFileName(path)
    writer.SetInputData(data)
    for name, argument in settings.items():
        getattr(writer, name)(argument)
    assert writer.Write(), path


def write_collection(path, entries):
    """Writes a .pvd file. entries: times and names of files."""
    with open(path, "w", encoding="ascii") as file:
        file.write('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n')
        for part, (time, name) in enumerate(entries):
            file.write(f'<DataSet timestep="{time}" group="" part="{part}" file="{name}"/>\n')
        file.write("</Collection>\n</VTKFile>\n")


class Series(VTKPythonAlgorithmBase):
    """A mesh that varies in time. The displacements at a time are the given ones times this time."""

    def __init__(self, mesh, times):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=0, nOutputPorts=1,
                                        outputType="vtkUnstructuredGrid")
        self.mesh, self.times = mesh, times

    def RequestInformation(self, _request, _inputs, outputs):
        keys = vtkStreamingDemandDrivenPipeline
        outputs.GetInformationObject(0).Set(keys.TIME_STEPS(), self.times, len(self.times))
        outputs.GetInformationObject(0).Set(keys.TIME_RANGE(), [self.times[0], self.times[-1]], 2)
        return 1

    def RequestData(self, _request, _inputs, outputs):
        output = vtkUnstructuredGrid.GetData(outputs, 0)
        time = outputs.GetInformationObject(0).Get(vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP())
        output.DeepCopy(self.mesh)
        moves = vtk_to_numpy(output.GetPointData().GetArray("Displacement"))
        output.GetPointData().AddArray(to_vtk("Displacement", moves * time))
        output.GetInformation().Set(output.DATA_TIME_STEP(), time)
        return 1


def write_exodus(mesh, path, times=(1.0,)):
    writer = vtkExodusIIWriter()
    writer.SetFileName(path)
    writer.SetStoreDoubles(1)
    if len(times) > 1:
        series = Series(mesh, list(times))
        writer.SetInputConnection(series.GetOutputPort())
    else:
        writer.SetInputData(mesh)
    writer.WriteAllTimeStepsOn()
    assert writer.Write(), path
    assert os.path.getsize(path) > 1000, os.path.getsize(path)


def write_hdf(path, places, moves, **settings):
    cells = make_tetrahedra()
    write_vtkhdf(path, places, cells, [VTK_TETRA] * len(cells),
                 {"Temperature": places[:, 0].astype(numpy.float32), "Displacement": moves},
                 **settings)
