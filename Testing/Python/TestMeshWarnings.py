# SPDX-License-Identifier: BSD-3-Clause
"""Tests meshes with a doubtful result: split meshes, points in single precision far from the origin, and blocks that
are ignored; and explicit structured grids."""

import numpy as np

import deformvolume_vtk as dv
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    VTK_HEXAHEDRON,
    vtkCellArray,
    vtkExplicitStructuredGrid,
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersSources import vtkPlaneSource


def make_volume(origin=(0, 0, 0)):
    volume = vtkImageData()
    volume.SetDimensions(21, 21, 21)
    volume.SetOrigin(origin)
    values = numpy_to_vtk(np.tile(np.arange(21, dtype=np.float32), 441), deep=True)
    values.SetName("x")
    volume.GetPointData().SetScalars(values)
    return volume


def make_mesh(boxes, displacements, origin=(0, 0, 0), kind=np.float64):
    """Returns hexahedra, each with nodes of its own. boxes: x of the two ends of each one."""
    points, vectors, cells = [], [], vtkCellArray()
    for box, displacement in zip(boxes, displacements):
        corners = [(box[i], y, z) for z in (0, 20) for i, y in ((0, 0), (1, 0), (1, 20), (0, 20))]
        cells.InsertNextCell(8, range(len(points), len(points) + 8))
        points += corners
        vectors += [(displacement, 0, 0)] * 8
    made = vtkPoints()
    made.SetData(numpy_to_vtk((np.array(points) + origin).astype(kind), deep=True))
    mesh = vtkUnstructuredGrid()
    mesh.SetPoints(made)
    mesh.SetCells(VTK_HEXAHEDRON, cells)
    array = numpy_to_vtk(np.array(vectors, float), deep=True)
    array.SetName("U")
    mesh.GetPointData().SetVectors(array)
    return mesh


class Deform:
    def __init__(self, volume, mesh):
        self.filter = dv.vtkDeformVolumeFilter()
        self.filter.SetInputData(volume)
        self.filter.SetDeformationData(mesh)
        self.warnings = []

        def observe(caller, event, text):
            self.warnings.append(text)

        observe.CallDataType = "string0"
        self.filter.AddObserver("WarningEvent", observe)

    def update(self):
        """Returns the warnings of an update."""
        self.warnings.clear()
        self.filter.Update()
        return " ".join(self.warnings)


def test_splits():
    mesh = make_mesh(((0, 9.5), (9.5, 20)), (0, 6))
    deform = Deform(make_volume(), mesh)
    assert "move more than an output voxel apart" in deform.update()
    gap = deform.filter.GetNumberOfCoveredVoxels()
    assert deform.update() == ""
    deform.filter.OpenSplitsOn()
    assert deform.update() == ""
    assert deform.filter.GetNumberOfCoveredVoxels() == gap - 6 * 21 * 21
    deform.filter.OpenSplitsOff()
    assert "apart" in deform.update()  # again, after it was away
    # The volume is cut along the split.
    sheet = vtkPlaneSource()
    sheet.SetOrigin(9.5, -5, -5)
    sheet.SetPoint1(9.5, 25, -5)
    sheet.SetPoint2(9.5, -5, 25)
    cut = dv.vtkCutVolume()
    cut.SetInputData(make_volume())
    cut.SetSheetConnection(sheet.GetOutputPort())
    deform.filter.SetInputConnection(cut.GetOutputPort())
    assert deform.update() == ""
    assert deform.filter.GetNumberOfCoveredVoxels() == gap - 6 * 21 * 21
    # Voxels are on one side only, or hidden on the other side.
    for split in (20.5, 20):
        assert Deform(make_volume(), make_mesh(((0, split), (split, 40)), (0, 6))).update() == ""
    hidden = make_volume()
    ghosts = numpy_to_vtk(np.where(np.arange(9261) % 21 >= 10, 2, 0).astype(np.uint8), deep=True)
    ghosts.SetName("vtkGhostType")
    hidden.GetPointData().AddArray(ghosts)
    assert Deform(hidden, mesh).update() == ""
    # Parts that were never merged, but move together.
    assert Deform(make_volume(), make_mesh(((0, 9.5), (9.5, 20)), (2, 2.5))).update() == ""


def test_rounding():
    far = (500000.3, 5000000.3, -1000.3)
    boxes, displacements = ((0, 20),), (0,)
    doubles = Deform(make_volume(far), make_mesh(boxes, displacements, far))
    assert doubles.update() == "" and doubles.filter.GetNumberOfCoveredVoxels() == 21**3
    floats = Deform(make_volume(far), make_mesh(boxes, displacements, far, np.float32))
    assert "points of the deformation mesh are floats" in floats.update()
    assert Deform(make_volume(), make_mesh(boxes, displacements, kind=np.float32)).update() == ""
    exact = (500000, 4000000, 0)
    assert Deform(make_volume(exact), make_mesh(boxes, displacements, exact, np.float32)).update() == ""
    # Rest positions have double precision there.
    doubles.filter.GenerateRestPositionsOn()
    output = doubles.update() or doubles.filter.GetOutput()
    rest = vtk_to_numpy(output.GetPointData().GetArray("RestPosition"))
    wanted = np.array([output.GetPoint(i) for i in range(output.GetNumberOfPoints())])
    assert rest.dtype == np.float64 and abs(rest - wanted).max() < 1e-4, abs(rest - wanted).max()


def test_blocks():
    blocks = vtkMultiBlockDataSet()
    blocks.SetBlock(0, make_mesh(((0, 20),), (0,)))
    blocks.SetBlock(1, make_volume())
    deform = Deform(make_volume(), blocks)
    assert "image data, and not part of the mesh: the block with flat index 2" in deform.update()
    assert deform.filter.GetNumberOfCoveredVoxels() == 21**3


def test_explicit_structured_grid():
    mesh = make_mesh(((0, 10), (10, 20)), (0, 3))
    grid = vtkExplicitStructuredGrid()
    grid.SetDimensions(3, 2, 2)
    grid.SetPoints(mesh.GetPoints())
    grid.SetCells(mesh.GetCells())
    grid.GetPointData().SetVectors(mesh.GetPointData().GetVectors())
    expected, found = Deform(make_volume(), mesh), Deform(make_volume(), grid)
    for hides in (False, True):
        if hides:
            grid.BlankCell(1)
            expected.filter.SetDeformationData(make_mesh(((0, 10),), (0,)))
        expected.update()
        found.update()
        arrays = [
            vtk_to_numpy(one.filter.GetOutput().GetPointData().GetScalars()) for one in (expected, found)
        ]
        assert arrays[0].size > 0 and np.array_equal(*arrays)


for test in (test_splits, test_rounding, test_blocks, test_explicit_structured_grid):
    test()
print("all tests passed")
