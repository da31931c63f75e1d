# SPDX-License-Identifier: BSD-3-Clause
"""Tests that filters notice changes of their inputs: times of handles and sheets, values that were written before
Modified() of the data object, and other values of a volume that has been edited."""

import numpy as np

import deformvolume_vtk as dv
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersGeneral import vtkTransformFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkImagingCore import vtkImageShiftScale, vtkRTAnalyticSource
from vtkmodules.vtkImagingGeneral import vtkImageGaussianSmooth


class Series(VTKPythonAlgorithmBase):
    """A source with the time steps 0 to 3. make(time) returns its data. has_time: whether these always have a time."""

    def __init__(self, kind, make, has_time=True):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=kind)
        self.make, self.has_time = make, has_time

    def RequestInformation(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        info.Set(Pipeline.TIME_STEPS(), [0.0, 1.0, 2.0, 3.0], 4)
        info.Set(Pipeline.TIME_RANGE(), [0.0, 3.0], 2)
        return 1

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        time = info.Get(Pipeline.UPDATE_TIME_STEP()) if info.Has(Pipeline.UPDATE_TIME_STEP()) else 0.0
        made = self.make(time)
        output = type(made).GetData(outputs)
        output.ShallowCopy(made)
        if self.has_time:
            output.GetInformation().Set(output.DATA_TIME_STEP(), time)
        return 1


def make_source():
    source = vtkRTAnalyticSource()
    source.SetWholeExtent(0, 16, 0, 16, 0, 16)
    return source


def add(data, name, values):
    """Adds a point array, and returns it and its values."""
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    data.AddArray(array)
    return vtk_to_numpy(array)


def make_handle(time):
    points = vtkPoints()
    points.InsertNextPoint(8 + time, 8, 8)
    handles = vtkPolyData()
    handles.SetPoints(points)
    add(handles.GetPointData(), "RestPosition", np.array([[8.0, 8, 8]]))
    return handles


def make_sheet(time):
    plane = vtkPlaneSource()
    plane.SetOrigin(5.3 + time, -1, -1)
    plane.SetPoint1(5.3 + time, 5 + 2 * time, -1)
    plane.SetPoint2(5.3 + time, -1, 17)
    plane.Update()
    return plane.GetOutput()


def make_lattice(nodes=3, size=30.0):
    lattice = dv.vtkLatticeTetrahedraSource()
    lattice.SetNumberOfNodes(nodes, nodes, nodes)
    lattice.SetBounds(0, size, 0, size, 0, size)
    lattice.Update()
    mesh = vtkUnstructuredGrid()
    mesh.ShallowCopy(lattice.GetOutput())
    return mesh, vtk_to_numpy(mesh.GetPoints().GetData())


def move_lattice(time):
    mesh, points = make_lattice(size=16.0)
    add(mesh.GetPointData(), "U", np.tile([time, 0, 0], (len(points), 1)))
    return mesh


def warp_lattice(time):
    mesh, points = make_lattice(size=16.0)
    made = vtkPoints()
    made.SetData(numpy_to_vtk(points + [time, 0, 0], deep=True))
    mesh.SetPoints(made)
    return mesh


def test_times():
    handles, sheet = Series("vtkPolyData", make_handle), Series("vtkPolyData", make_sheet)
    source = make_source()
    chainmail = dv.vtkChainMailDeformation()
    chainmail.SetInputConnection(source.GetOutputPort())
    chainmail.SetHandlesConnection(handles.GetOutputPort())
    deform = dv.vtkDeformVolumeFilter()
    deform.SetInputConnection(source.GetOutputPort())
    deform.SetDeformationConnection(chainmail.GetOutputPort())
    deform.SetOutputBoundsModeToVolumeBounds()
    cut = dv.vtkCutVolume()
    cut.SetInputConnection(source.GetOutputPort())
    cut.SetSheetConnection(sheet.GetOutputPort())
    counts = []
    for time in (0.0, 1.0, 2.0, 3.0):
        deform.UpdateTimeStep(time)
        assert abs(vtk_to_numpy(chainmail.GetOutput().GetPointData().GetVectors())).max() == time
        cut.UpdateTimeStep(time)
        counts.append(cut.GetNumberOfSwitchedOffTetrahedra())
    assert counts == sorted(set(counts)) and counts[0] > 0, counts


def test_chosen_time():
    """A time that a program has chosen on the source is kept if no time is requested."""
    lattice = Series("vtkUnstructuredGrid", move_lattice)
    lattice.UpdateTimeStep(2.0)
    source = make_source()
    deform = dv.vtkDeformVolumeFilter()
    deform.SetInputConnection(source.GetOutputPort())
    deform.SetDeformationConnection(lattice.GetOutputPort())
    deform.SetInputArrayToProcess(0, 1, 0, 0, "U")
    deform.Update()
    assert deform.GetOutput().GetExtent() == (2, 18, 0, 16, 0, 16), deform.GetOutput().GetExtent()
    deform.UpdateTimeStep(3.0)
    assert deform.GetOutput().GetExtent() == (2, 19, 0, 16, 0, 16), deform.GetOutput().GetExtent()
    # A source whose data have a time only if one is requested.
    lattice = Series("vtkUnstructuredGrid", move_lattice, has_time=False)
    deform.SetDeformationConnection(lattice.GetOutputPort())
    deform.Update()
    deform.UpdateTimeStep(3.0)
    assert deform.GetOutput().GetExtent()[1] == 19, deform.GetOutput().GetExtent()
    # The deformed mesh and the mesh at rest are at different times.
    moved = Series("vtkUnstructuredGrid", warp_lattice)
    rest = Series("vtkUnstructuredGrid", warp_lattice)
    moved.UpdateTimeStep(2.0)
    deform = dv.vtkDeformVolumeFilter()
    deform.SetInputConnection(source.GetOutputPort())
    deform.SetDeformationConnection(moved.GetOutputPort())
    deform.SetRestConnection(rest.GetOutputPort())
    deform.Update()
    assert deform.GetOutput().GetExtent()[:2] == (2, 18), deform.GetOutput().GetExtent()
    deform.UpdateTimeStep(0.0)
    assert deform.GetOutput().GetExtent()[:2] == (0, 18), deform.GetOutput().GetExtent()
    # A simulation advances with each update, also behind another filter.
    mesh, points = make_lattice(size=16.0)
    add(mesh.GetPointData(), "Fixed", (points[:, 2] == 0).astype(np.uint8))
    springs = dv.vtkMassSpringDeformation()
    springs.SetInputData(mesh)
    springs.SetGravity(300, 0, 0)
    springs.SetEndTime(1.0)
    deform = dv.vtkDeformVolumeFilter()
    deform.SetInputConnection(source.GetOutputPort())
    same = vtkTransformFilter()
    same.SetInputConnection(springs.GetOutputPort())
    same.SetTransform(vtkTransform())
    deform.SetDeformationConnection(same.GetOutputPort())
    times = []
    for _ in range(3):
        springs.Modified()
        deform.Update()
        times.append(springs.GetTime())
    assert times[0] < times[1] < times[2], times


def test_written_values():
    """Values are written with numpy, and Modified() of the data object is called, not that of the array."""
    image = vtkImageData()
    image.SetDimensions(16, 16, 16)
    material, pinned, label = (
        add(image.GetPointData(), name, np.zeros(16**3, np.uint8)).reshape(16, 16, 16)
        for name in ("material", "Pinned", "label")
    )
    active = add(image.GetCellData(), "ActiveTetrahedra", np.full(15**3, 31, np.uint8))

    handle = dv.vtkDeformationHandleSource()
    handle.SetRestPosition(8, 8, 8)
    handle.SetPosition(10, 8, 8)
    chainmail = dv.vtkChainMailDeformation()
    chainmail.SetInputData(image)
    chainmail.SetHandlesConnection(handle.GetOutputPort())
    chainmail.SetMaterialArrayName("material")
    chainmail.SetRelaxationSweeps(0)

    def drag():
        image.Modified()
        chainmail.Reset()
        chainmail.Update()
        return chainmail.GetNumberOfMovedVoxels()

    soft = drag()
    material[:] = 4
    stiff = drag()
    assert stiff == 16**3 > soft, (soft, stiff)
    pinned[:, :, 0] = 1
    assert 0 < drag() < stiff
    active[:] = 0
    assert drag() <= 1
    active[:] = 31

    carve = dv.vtkCarveVolume()
    carve.SetInputData(image)
    carve.SetLabelArrayName("label")
    label[3:6, 3:6, 3:6] = 1
    image.Modified()
    carve.Update()
    before = carve.GetNumberOfSwitchedOffTetrahedra()
    label[3:9, 3:9, 3:9] = 1
    image.Modified()
    carve.Update()
    assert carve.GetNumberOfSwitchedOffTetrahedra() > 2 * before > 0
    active[:100] = 0
    image.Modified()
    carve.Update()
    assert (vtk_to_numpy(carve.GetOutput().GetCellData().GetArray("ActiveTetrahedra"))[:100] == 0).all()

    mesh, points = make_lattice()
    add(mesh.GetPointData(), "Fixed", (points[:, 2] == 0).astype(np.uint8))
    force = add(mesh.GetPointData(), "Force", np.zeros((len(points), 3)))
    elastic = dv.vtkFiniteElementDeformation()
    elastic.SetInputData(mesh)
    largest = []
    for newtons in (0.01, 0.02):
        force[points[:, 2] == 30, 0] = newtons
        mesh.Modified()
        elastic.Update()
        largest.append(abs(vtk_to_numpy(elastic.GetOutput().GetPointData().GetVectors())).max())
    assert 1.9 < largest[1] / largest[0] < 2.1, largest


def test_edits_stay():
    """Edits of a tool stay if the values of the volume change, behind a filter that does not announce a direction."""
    source = make_source()
    smooth = vtkImageGaussianSmooth()
    smooth.SetInputConnection(source.GetOutputPort())
    carve = dv.vtkCarveVolume()
    carve.SetInputConnection(smooth.GetOutputPort())
    carve.SetToolRadius(4)
    deform = dv.vtkDeformVolumeFilter()
    deform.SetInputConnection(carve.GetOutputPort())
    carve.AddToolPosition(8, 8, 8)
    deform.Update()
    carve.ClearToolPositions()
    deform.Update()
    counts = carve.GetNumberOfSwitchedOffTetrahedra(), deform.GetNumberOfCoveredVoxels()
    assert counts[0] > 0 and counts[1] < 17**3, counts
    smooth.SetStandardDeviation(1.0)
    deform.Update()
    assert (carve.GetNumberOfSwitchedOffTetrahedra(), deform.GetNumberOfCoveredVoxels()) == counts


def test_announcements():
    """Filters that follow see the type of densities, and a failed update leaves no results."""
    image = vtkImageData()
    image.SetDimensions(12, 12, 12)
    dose = numpy_to_vtk(np.full(12**3, 7, np.int16), deep=True)
    dose.SetName("dose")
    image.GetPointData().SetScalars(dose)
    mesh, points = make_lattice(size=11.0)
    add(mesh.GetPointData(), "U", 0.3 * (points - 5.5))
    deform = dv.vtkDeformVolumeFilter()
    deform.SetInputData(image)
    deform.SetDeformationData(mesh)
    deform.SetInputArrayToProcess(0, 1, 0, 0, "U")
    deform.AddDensityArray("dose")
    follower = vtkImageShiftScale()
    follower.SetInputConnection(deform.GetOutputPort())
    follower.Update()
    values = vtk_to_numpy(follower.GetOutput().GetPointData().GetScalars())
    assert values.dtype == np.float32 and abs(values.max() - 7 / 1.3**3) < 1e-4, (values.dtype, values.max())
    assert deform.GetNumberOfCoveredVoxels() > 0
    deform.SetInputArrayToProcess(0, 1, 0, 0, "none")
    deform.AddObserver("ErrorEvent", lambda *_: None)
    deform.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    deform.Update()
    assert deform.GetNumberOfCoveredVoxels() == 0 and deform.GetChangedExtent() == (0, -1, 0, -1, 0, -1)


for test in (test_times, test_chosen_time, test_written_values, test_edits_stay, test_announcements):
    test()
print("all tests passed")
