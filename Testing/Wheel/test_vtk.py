# SPDX-License-Identifier: BSD-3-Clause
"""The filter for VTK pipelines. The tests are skipped without VTK."""

import sys
import unittest
from unittest import mock

import numpy

try:
    from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
except ImportError:
    vtkRTAnalyticSource = None


def values(image):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])


def add_vectors(data, vectors):
    from vtkmodules.util.numpy_support import numpy_to_vtk

    array = numpy_to_vtk(numpy.asarray(vectors, dtype=float), deep=True)
    array.SetName("vectors")
    data.GetPointData().SetVectors(array)
    return data


def make_field(shift):
    from vtkmodules.vtkCommonDataModel import vtkImageData

    field = vtkImageData()
    field.SetDimensions(2, 2, 2)
    field.SetOrigin(-10, -10, -10)
    field.SetSpacing(20, 20, 20)
    return add_vectors(field, numpy.tile(shift, (8, 1)))


def make_mesh(shift, kind=None):
    """A box of the size of the volume, as one cell."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
    from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, vtkUnstructuredGrid

    corners = [(x, y, z) for z in (-10, 10) for x, y in ((-10, -10), (10, -10), (10, 10), (-10, 10))]
    points = vtkPoints()
    points.SetData(numpy_to_vtk(numpy.array(corners, dtype=float), deep=True))
    numbers = vtkIdList()
    for number in range(8):
        numbers.InsertNextId(number)
    mesh = vtkUnstructuredGrid()
    mesh.SetPoints(points)
    mesh.InsertNextCell(VTK_HEXAHEDRON if kind is None else kind, numbers)
    return add_vectors(mesh, numpy.tile(shift, (8, 1)))


def make_series(times, make):
    """A source of make(time), which has the last of these times that is not after the requested one."""
    from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
    from vtkmodules.vtkCommonDataModel import vtkDataObject
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline

    class Series(VTKPythonAlgorithmBase):
        def __init__(self):
            VTKPythonAlgorithmBase.__init__(self, nInputPorts=0, outputType=make(times[0]).GetClassName())

        def RequestInformation(self, request, inInfo, outInfo):
            info = outInfo.GetInformationObject(0)
            info.Set(pipeline.TIME_STEPS(), times, len(times))
            info.Set(pipeline.TIME_RANGE(), [times[0], times[-1]], 2)
            if self.OutputType == "vtkImageData":
                info.Set(pipeline.WHOLE_EXTENT(), make(times[0]).GetExtent(), 6)
            return 1

        def RequestData(self, request, inInfo, outInfo):
            info = outInfo.GetInformationObject(0)
            asked = info.Get(pipeline.UPDATE_TIME_STEP()) if info.Has(pipeline.UPDATE_TIME_STEP()) else times[0]
            time = max(step for step in times if step <= max(asked, times[0]))
            output = vtkDataObject.GetData(info)
            output.ShallowCopy(make(time))
            # A reader of one time step gives the requested time to its data.
            output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time if len(times) > 1 else asked)
            return 1

    return Series()


class Pipeline(unittest.TestCase):
    SHIFT = [3.0, -2.0, 1.0]

    def setUp(self):
        # Skip each test and not the class: Python 3.12.1 reports a failure if a program has no tests.
        if vtkRTAnalyticSource is None:
            self.skipTest("VTK is not installed")
        from deformvolume.vtk import DeformVolume

        self.source = vtkRTAnalyticSource()
        self.filter = DeformVolume()
        self.filter.SetInputConnection(self.source.GetOutputPort())
        self.filter.SetOutputBoundsMode(DeformVolume.VOLUME_BOUNDS)

    def expect_shift(self):
        volume, output = values(self.source.GetOutput()), values(self.filter.GetOutputDataObject(0))
        numpy.testing.assert_array_equal(output[1:, :-2, 3:], volume[:-1, 2:, :-3])

    def test_field(self):
        from vtkmodules.vtkImagingCore import vtkImageFlip

        self.filter.SetDeformationData(make_field(self.SHIFT))
        # With a filter downstream, VTK requests information, extents and data.
        flip = vtkImageFlip()
        flip.SetInputConnection(self.filter.GetOutputPort())
        flip.Update()
        self.expect_shift()
        output = values(self.filter.GetOutputDataObject(0))
        numpy.testing.assert_array_equal(values(flip.GetOutput())[:, :, ::-1], output)

    def test_mesh(self):
        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        self.filter.Update()
        self.expect_shift()
        # Another deformation.
        self.filter.SetDeformationData(make_mesh([0.0, 0.0, 0.0]))
        self.filter.Update()
        numpy.testing.assert_array_equal(values(self.filter.GetOutputDataObject(0)), values(self.source.GetOutput()))

    def test_hidden_cells(self):
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
        from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR
        from vtkmodules.vtkCommonDataModel import VTK_TETRA

        def add_mask(data, name, values):
            mask = numpy_to_vtk(numpy.array(values, numpy.uint8), deep=True, array_type=VTK_UNSIGNED_CHAR)
            mask.SetName(name)
            data.RemoveArray(name)
            data.AddArray(mask)

        def get_mask():
            self.filter.Update()
            return vtk_to_numpy(self.filter.GetOutput().GetPointData().GetArray("vtkValidPointMask")).copy()

        # The hexahedron, and a tetrahedron beside it with a point of its own, which reaches the volume's border.
        mesh = make_mesh([0.0, 0.0, 0.0])
        mesh.GetPoints().SetPoint(1, 5.0, -10.0, -10.0)
        mesh.GetPoints().SetPoint(2, 5.0, 10.0, -10.0)
        mesh.GetPoints().SetPoint(5, 5.0, -10.0, 10.0)
        mesh.GetPoints().SetPoint(6, 5.0, 10.0, 10.0)
        self.filter.SetDeformationData(mesh)
        hexahedron = get_mask()
        mesh.GetPoints().InsertNextPoint(10.0, 0.0, 0.0)
        mesh.InsertNextCell(VTK_TETRA, 4, [1, 2, 5, 8])
        add_vectors(mesh, numpy.zeros((9, 3)))
        both = get_mask()
        self.assertGreater(both.sum(), hexahedron.sum())
        for hidden in (32, 1):  # HIDDENCELL, DUPLICATECELL
            add_mask(mesh.GetCellData(), "vtkGhostType", [0, hidden])
            numpy.testing.assert_array_equal(get_mask(), hexahedron)
        mesh.GetCellData().Initialize()
        numpy.testing.assert_array_equal(get_mask(), both)
        # The displacement of a point that no other cell uses need not be finite.
        add_vectors(mesh, [[0.0, 0.0, 0.0]] * 8 + [[numpy.nan] * 3])
        for name, masked, other in (("vtkGhostType", 2, 1), ("vtkValidPointMask", 0, 1)):
            add_mask(mesh.GetPointData(), name, [other] * 8 + [masked])
            numpy.testing.assert_array_equal(get_mask(), hexahedron)
            mesh.GetPointData().RemoveArray(name)

    def test_polyhedra(self):
        from vtkmodules.vtkCommonCore import vtkIdList
        from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_TETRA, vtkUnstructuredGrid

        # The same box and a tetrahedron beside it, with faces in both senses.
        faces = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (4, 7, 3, 0))
        results = []
        for kind in (VTK_HEXAHEDRON, VTK_POLYHEDRON):
            mesh = vtkUnstructuredGrid()
            mesh.SetPoints(make_mesh(self.SHIFT).GetPoints())
            mesh.GetPoints().SetPoint(1, 5.0, -10.0, -10.0)
            mesh.GetPoints().InsertNextPoint(30.0, 0.0, 0.0)
            for number in range(4):
                if number % 2 == 0:
                    mesh.InsertNextCell(VTK_TETRA, 4, [1, 2, 5, 8])
                elif kind == VTK_HEXAHEDRON:
                    mesh.InsertNextCell(kind, 8, list(range(8)))
                else:
                    stream = vtkIdList()
                    for value in (6, *(value for face in faces for value in (4, *face))):
                        stream.InsertNextId(value)
                    mesh.InsertNextCell(kind, stream)
            add_vectors(mesh, numpy.arange(27).reshape(9, 3) / 9)
            ghosts = numpy.array([0, 0, 32, 32], numpy.uint8)  # HIDDENCELL
            mesh.AllocateCellGhostArray()
            for number, ghost in enumerate(ghosts.tolist()):
                mesh.GetCellGhostArray().SetValue(number, ghost)
            self.filter.SetDeformationData(mesh)
            self.filter.Update()
            results.append(values(self.filter.GetOutput()).copy())
        numpy.testing.assert_array_equal(results[1], results[0])

    def test_lagrange_cells(self):
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonDataModel import VTK_LAGRANGE_HEXAHEDRON

        # A hexahedron with a node in the middle of each edge along x.
        mesh = make_mesh(self.SHIFT)
        corners = [mesh.GetPoint(number) for number in range(8)]
        for begin, end in ((0, 1), (3, 2), (4, 5), (7, 6)):
            mesh.GetPoints().InsertNextPoint(*numpy.add(corners[begin], corners[end]) / 2)
        mesh.Allocate(1)
        mesh.InsertNextCell(VTK_LAGRANGE_HEXAHEDRON, 12, list(range(12)))
        add_vectors(mesh, numpy.tile(self.SHIFT, (12, 1)))
        degrees = numpy_to_vtk(numpy.array([[2.0, 1.0, 1.0]]), deep=True)
        degrees.SetName("degrees")
        mesh.GetCellData().SetHigherOrderDegrees(degrees)
        self.filter.SetDeformationData(mesh)
        self.filter.Update()
        self.expect_shift()
        degrees.SetTuple3(0, 1.0, 2.0, 1.0)
        degrees.Modified()
        vectors = numpy.tile(self.SHIFT, (12, 1))
        vectors[8:] = 0.0
        add_vectors(mesh, vectors)
        self.filter.Update()
        first = values(self.filter.GetOutput()).copy()
        degrees.SetTuple3(0, 2.0, 1.0, 1.0)
        degrees.Modified()
        self.filter.Update()
        self.assertFalse(numpy.array_equal(values(self.filter.GetOutput()), first))
        degrees.SetTuple3(0, 0.5, 1.0, 1.0)
        degrees.Modified()
        self.expect_error("does not fit its degree", mesh)
        degrees.SetNumberOfComponents(1)
        degrees.Modified()
        self.expect_error("degrees of the cells have 1 components", mesh)

    def test_names(self):
        from deformvolume.vtk import DeformVolume
        from vtkmodules.vtkCommonCore import vtkStringArray

        self.source.Update()
        volume = self.source.GetOutput().NewInstance()
        volume.ShallowCopy(self.source.GetOutput())
        text = vtkStringArray()
        text.SetName("patient")
        text.InsertNextValue("A")
        volume.GetFieldData().AddArray(text)
        volume.GetPointData().GetScalars().SetName(None)
        other = DeformVolume()
        other.SetInputData(volume)
        other.SetOutputBoundsMode(DeformVolume.VOLUME_BOUNDS)
        for shift in (0.0, 1.0):
            other.SetDeformationData(make_mesh([shift, 0.0, 0.0]))
            other.Update()
            for image in (volume, other.GetOutput()):
                self.assertEqual(image.GetFieldData().GetNumberOfArrays(), 1)
        numpy.testing.assert_array_equal(values(other.GetOutput())[:, :, 1:], values(volume)[:, :, :-1])
        for name in ("FieldIsInverse", "outside", "Update2"):
            with self.assertRaisesRegex(AttributeError, "has no attribute"):
                setattr(other, name, 1)
        for name, value in {"FieldIsInverse": "False", "OutsideMode": "keep", "Device": None}.items():
            with self.assertRaisesRegex(TypeError, f"{name} is "):
                getattr(other, "Set" + name)(value)
        with self.assertRaisesRegex(TypeError, "Give DeformVolume.DISCARD or .*EXTRAPOLATE or DeformVolume.KEEP"):
            other.SetOutsideMode("keep")
        with self.assertRaisesRegex(TypeError, "or DeformVolume.CUBIC_INTERPOLATION or"):
            other.SetInterpolation("cubic")

    # The volume and the mesh are sent once, and displacements in each update.
    def test_only_changes_are_sent(self):
        sent = []
        mesh = make_mesh(self.SHIFT)
        self.filter.SetDeformationData(mesh)
        self.filter.Update()
        deformer = self.filter._deformer
        for name in ("_set_volume_grid", "_set_mesh_arrays", "set_displacements"):

            def call(*arguments, name=name, before=getattr(deformer, name), **options):
                sent.append(name)
                return before(*arguments, **options)

            setattr(deformer, name, call)
        for _ in range(3):
            mesh.GetPointData().GetVectors().Modified()
            self.filter.Update()
        self.assertEqual(sent, 3 * ["set_displacements"])
        self.source.SetXFreq(50)
        self.filter.Update()
        self.assertIn("_set_volume_grid", sent)
        self.expect_shift()

    # A failed update may have passed on a part of its input.
    def test_deformation_that_is_removed_after_an_error(self):
        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        self.filter.Update()
        for wrong in (make_mesh([numpy.nan, 0.0, 0.0]), make_field([numpy.nan, 0.0, 0.0])):
            self.filter.SetDeformationData(wrong)
            with self.assertRaisesRegex(Exception, "is not finite"):
                self.filter.Update(0)
            self.filter.SetDeformationData(None)
            self.filter.Update()
            numpy.testing.assert_array_equal(values(self.filter.GetOutput()), values(self.source.GetOutput()))

    def test_arrays_that_change_in_place(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy

        mesh = make_mesh([0.0, 0.0, 0.0])
        self.filter.SetDeformationData(mesh)
        self.filter.Update()
        vtk_to_numpy(mesh.GetPointData().GetVectors())[:] = self.SHIFT
        mesh.Modified()
        self.filter.Update()
        self.expect_shift()
        vtk_to_numpy(mesh.GetPoints().GetData())[:, 0] += 100.0
        mesh.Modified()
        with self.assertRaisesRegex(Exception, "holds no voxel"):
            self.filter.Update()

    def test_nested_update(self):
        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        errors = []

        def update(*_):
            try:
                self.filter.Update()
            except Exception as error:  # pylint: disable=broad-except
                errors.append(str(error))

        observer = self.filter.AddObserver("ProgressEvent", update)
        self.filter.Update()
        self.filter.RemoveObserver(observer)
        self.expect_shift()
        self.assertIn("must not call Update()", errors[0])

    # Exceptions must not keep the filter alive.
    def test_is_destroyed(self):
        import gc
        import weakref

        from deformvolume.vtk import DeformVolume

        for shift in (self.SHIFT, [numpy.nan, 0.0, 0.0]):
            other = DeformVolume()
            other.SetInputConnection(self.source.GetOutputPort())
            other.SetDeformationData(make_mesh(shift))
            try:
                other.Update()
            except Exception:  # pylint: disable=broad-except
                pass
            reference = weakref.ref(other)
            del other
            gc.collect()
            self.assertIsNone(reference())

    # Resizing allocates other memory, but does not change the time of modification.
    def test_resized_array(self):
        from deformvolume.vtk import DeformVolume

        self.source.Update()
        volume = self.source.GetOutput().NewInstance()
        volume.DeepCopy(self.source.GetOutput())
        other = DeformVolume()
        other.SetInputData(volume)
        other.SetDeformationData(make_mesh(self.SHIFT))
        other.Update()
        volume.GetPointData().GetScalars().SetNumberOfTuples(10)
        volume.GetPointData().GetScalars().Squeeze()
        other.SetDeformationData(make_mesh([0.0, 0.0, 0.0]))
        with self.assertRaisesRegex(ValueError, "10 tuples"):
            other.Update()

    # Each update raises, and its output is empty, also if VTK finds the error or the input has one.
    def test_inputs_that_cannot_be_updated(self):
        from deformvolume.vtk import DeformVolume
        from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkRectilinearGrid

        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        broken = DeformVolume()
        broken.SetInputConnection(self.source.GetOutputPort())
        broken.SetDeformationData(make_mesh([numpy.nan, 0.0, 0.0]))

        def expect(words):
            updates = (
                self.filter.Update,
                self.filter.Update,
                self.filter.UpdateWholeExtent,
                lambda: self.filter.UpdateTimeStep(0.0),
                lambda: self.filter.UpdatePiece(0, 1, 0),
                lambda: self.filter.UpdateExtent((0, 1, 0, 1, 0, 1)),
            )
            for update in updates:
                with self.assertRaisesRegex(Exception, words):
                    update()
                self.assertEqual(self.filter.GetOutput().GetNumberOfPoints(), 0)

        def work():
            self.filter.SetInputConnection(self.source.GetOutputPort())
            self.filter.SetRestData(None)
            self.filter.Update()
            self.expect_shift()

        work()
        self.filter.SetInputData(vtkRectilinearGrid())
        expect("vtkRectilinearGrid")
        work()
        self.filter.SetInputData(None)
        expect("port 0")
        work()
        self.filter.SetRestData(vtkPolyData())
        expect("vtkPolyData")
        work()
        self.filter.SetInputConnection(broken.GetOutputPort())
        expect("cannot be updated")
        work()

    def test_abort(self):
        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        observer = self.filter.AddObserver("ProgressEvent", lambda *_: self.filter.SetAbortExecute(1))
        for _ in range(2):
            with self.assertRaises(KeyboardInterrupt):
                self.filter.Update()
            self.assertEqual(self.filter.GetOutput().GetNumberOfPoints(), 0)
        self.filter.RemoveObserver(observer)
        self.filter.SetAbortExecute(0)  # later versions of VTK do not reset it
        self.filter.Update()
        self.expect_shift()

    def test_time(self):
        from vtkmodules.vtkCommonDataModel import vtkDataObject
        from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline
        from vtkmodules.vtkImagingCore import vtkImageFlip

        moving = make_series([0.0, 1.0, 2.0], lambda time: make_mesh([time, 0.0, 0.0]))
        self.filter.SetDeformationConnection(moving.GetOutputPort())
        flip = vtkImageFlip()
        flip.SetInputConnection(self.filter.GetOutputPort())

        def expect(time, output):
            volume = values(self.source.GetOutput())
            numpy.testing.assert_array_equal(output[:, :, time:], volume[:, :, : volume.shape[2] - time])

        for time in (0, 2, 1):
            moving.UpdateTimeStep(float(time))
            self.filter.Update()
            expect(time, values(self.filter.GetOutput()))
        for time in (2, 0, 1):
            self.filter.UpdateTimeStep(float(time))
            expect(time, values(self.filter.GetOutput()))
        self.filter.UpdateTimeStep(1.7)  # the source takes the step before it
        expect(1, values(self.filter.GetOutput()))
        for time in (2, 0, 1):
            flip.UpdateTimeStep(float(time))
            expect(time, values(flip.GetOutput())[:, :, ::-1])
        # The volume has times of its own.
        for times in ([0.0], [0.0, 3.0]):
            volume = make_series(times, lambda _: self.source.GetOutput())
            self.filter.SetInputConnection(volume.GetOutputPort())
            self.filter.UpdateInformation()
            info = self.filter.GetOutputInformation(0)
            self.assertEqual(info.Get(pipeline.TIME_STEPS()), tuple(sorted({0.0, 1.0, 2.0, *times})))
            self.assertEqual(info.Get(pipeline.TIME_RANGE()), (0.0, max(2.0, *times)))
            for time in (2, 0, 1):
                self.filter.UpdateTimeStep(float(time))
                expect(time, values(self.filter.GetOutput()))
                self.assertEqual(self.filter.GetOutput().GetInformation().Get(vtkDataObject.DATA_TIME_STEP()), time)

    def test_pieces(self):
        """Pieces of the output are made from the whole inputs."""
        from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
        from vtkmodules.vtkCommonDataModel import vtkDataObject
        from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline
        from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

        class Divided(VTKPythonAlgorithmBase):
            """A mesh of one cell, which is in the first piece."""

            def __init__(self):
                VTKPythonAlgorithmBase.__init__(self, nInputPorts=0, outputType="vtkUnstructuredGrid")

            def RequestInformation(self, request, inInfo, outInfo):
                outInfo.GetInformationObject(0).Set(vtkAlgorithm.CAN_HANDLE_PIECE_REQUEST(), 1)
                return 1

            def RequestData(self, request, inInfo, outInfo):
                info = outInfo.GetInformationObject(0)
                if info.Get(pipeline.UPDATE_PIECE_NUMBER()) == 0:
                    vtkDataObject.GetData(info).ShallowCopy(make_mesh(Pipeline.SHIFT))
                return 1

        divided = Divided()
        self.filter.SetDeformationConnection(divided.GetOutputPort())
        self.filter.Update()
        self.expect_shift()
        whole = values(self.filter.GetOutput()).copy()
        for piece in range(3):
            self.filter.UpdatePiece(piece, 3, 0)
            numpy.testing.assert_array_equal(values(self.filter.GetOutput()), whole)

    def expect_error(self, words, deformation):
        self.filter.SetDeformationData(deformation)
        with self.assertRaisesRegex(Exception, words):
            self.filter.Update()

    # VTK's executive does not pass on the direction of an image.
    def test_reference_without_direction(self):
        from vtkmodules.vtkCommonDataModel import vtkImageData
        from vtkmodules.vtkFiltersCore import vtkElevationFilter

        grid = vtkImageData()
        grid.SetExtent(2, 7, -1, 4, 0, 5)
        grid.SetOrigin(1.0, 2.0, -3.0)
        grid.SetDirectionMatrix([0.6, -0.8, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, 1.0])
        heights = vtkElevationFilter()
        heights.SetInputDataObject(grid)
        self.filter.SetDeformationData(make_field(self.SHIFT))
        self.filter.SetReferenceConnection(heights.GetOutputPort())
        self.filter.Update()
        output = self.filter.GetOutputDataObject(0)
        self.assertEqual(output.GetExtent(), grid.GetExtent())
        for number in (0, 5, 215):
            numpy.testing.assert_allclose(output.GetPoint(number), grid.GetPoint(number), atol=1e-12)

    def test_grids(self):
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
        from vtkmodules.vtkCommonDataModel import vtkRectilinearGrid, vtkStructuredGrid
        from vtkmodules.vtkFiltersCore import vtkAppendFilter

        # Positions that float does not represent.
        positions = numpy.array([-10.1, -3.3, 2.7, 10.1])
        straight = vtkRectilinearGrid()
        straight.SetDimensions(4, 4, 4)
        for axis in "XYZ":
            getattr(straight, f"Set{axis}Coordinates")(numpy_to_vtk(positions, deep=True))
        append = vtkAppendFilter()
        append.SetOutputPointsPrecision(1)
        append.SetInputData(straight)
        append.Update()
        mesh = append.GetOutput()
        curved = vtkStructuredGrid()
        curved.SetDimensions(4, 4, 4)
        curved.SetPoints(mesh.GetPoints())
        moved = vtkStructuredGrid()
        moved.DeepCopy(curved)
        vectors = numpy.random.RandomState(1).normal(size=(64, 3))
        vtk_to_numpy(moved.GetPoints().GetData())[:] += vectors
        results = []
        for grid in (mesh, straight, curved):
            self.filter.SetDeformationData(add_vectors(grid, vectors))
            self.filter.Update()
            results.append(values(self.filter.GetOutput()).copy())
        self.assertTrue(results[0].any())
        numpy.testing.assert_array_equal(results[1], results[0])
        numpy.testing.assert_array_equal(results[2], results[0])
        self.filter.SetDeformationData(moved)
        for rest in (curved, straight):
            self.filter.SetRestData(rest)
            self.filter.Update()
            numpy.testing.assert_allclose(values(self.filter.GetOutput()), results[0], rtol=1e-4)
        self.filter.SetRestData(None)
        add_vectors(straight, 2 * vectors)
        self.filter.SetDeformationData(straight)
        self.filter.Update()
        self.assertTrue((values(self.filter.GetOutput()) != results[0]).any())

    # The blocks may change in place.
    def test_blocks(self):
        from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

        blocks = vtkMultiBlockDataSet()
        mesh = make_mesh([0.0, 0.0, 0.0])
        blocks.SetBlock(2, mesh)
        self.filter.SetDeformationData(blocks)
        self.filter.Update()
        add_vectors(mesh, numpy.tile(self.SHIFT, (8, 1)))
        self.filter.Update()
        self.expect_shift()

    def test_counts(self):
        self.assertEqual(self.filter.GetNumberOfCoveredVoxels(), 0)
        self.assertEqual(self.filter.GetDeviceInUse(), "")
        mesh = make_mesh([0.0, 0.0, 0.0])
        self.filter.SetDeformationData(mesh)
        self.filter.Update()
        self.assertEqual(self.filter.GetNumberOfCoveredVoxels(), 21**3)
        self.assertEqual(self.filter.GetNumberOfInvertedTetrahedra(), 0)
        self.assertEqual(self.filter.GetNumberOfFlatTetrahedra(), 0)
        self.assertNotEqual(self.filter.GetDeviceInUse(), "")
        vectors = numpy.zeros((8, 3))
        vectors[0] = 30.0
        add_vectors(mesh, vectors)
        self.filter.Update()
        self.assertGreater(self.filter.GetNumberOfInvertedTetrahedra(), 0)
        self.assertGreater(self.filter.GetNumberOfHiddenVoxels(), 0)
        self.expect_error("is not finite", make_mesh([numpy.nan, 0.0, 0.0]))
        self.assertEqual(self.filter.GetNumberOfInvertedTetrahedra(), 0)
        self.assertEqual(self.filter.GetNumberOfCoveredVoxels(), 0)
        self.filter.SetDeformationData(make_field(self.SHIFT))
        self.filter.Update()
        self.assertEqual(self.filter.GetNumberOfInvertedTetrahedra(), 0)

    # Each warning is displayed until the arrays change.
    def test_warnings(self):
        from vtkmodules.vtkCommonCore import vtkFloatArray, vtkOutputWindow, vtkStringArray, vtkStringOutputWindow

        self.source.Update()
        volume = self.source.GetOutput()
        self.filter.SetInputData(volume)
        mesh = make_mesh(self.SHIFT)
        self.filter.SetDeformationData(mesh)

        def make_array(kind, name, number):
            array = kind()
            array.SetName(name)
            array.SetNumberOfTuples(number)
            return array

        def expect(*words):
            window = vtkStringOutputWindow()
            before = vtkOutputWindow.GetInstance()
            vtkOutputWindow.SetInstance(window)
            # With pyvista, warnings are not displayed by VTK.
            with mock.patch.dict(sys.modules):
                sys.modules.pop("pyvista", None)
                self.filter.Modified()
                self.filter.Update()
            vtkOutputWindow.SetInstance(before)
            lines = [line for line in window.GetOutput().splitlines() if line]
            self.assertEqual(len(lines), len(words), lines)
            for line, word in zip(lines, words):
                self.assertIn(word, line)

        expect()
        volume.GetCellData().AddArray(make_array(vtkFloatArray, "c", volume.GetNumberOfCells()))
        volume.GetPointData().AddArray(make_array(vtkStringArray, "s", volume.GetNumberOfPoints()))
        volume.GetPointData().SetVectors(add_vectors(volume, numpy.ones((21**3, 3))).GetPointData().GetVectors())
        self.filter.AddCategoricalArray("labels")
        expect(
            'Cell arrays of the volume are not resampled: "c". ',
            'The active vectors "vectors" of the volume are interpolated',
            "no point arrays with these names of categorical arrays: labels.",
            'left out, because their types cannot be resampled: "s" (string).',
        )
        expect()
        volume.GetCellData().AddArray(make_array(vtkFloatArray, "d", volume.GetNumberOfCells()))
        expect('are not resampled: "c", "d". ')
        volume.GetCellData().Initialize()
        expect()
        self.filter.SetOutputBoundsMode(self.filter.VOLUME_BOUNDS)
        expect()
        self.filter.SetInputDataObject(3, volume)
        expect("OutputBoundsMode has no effect.")
        expect()

    # As in the C++ filter, global and pedigree ids are not interpolated.
    def test_ids(self):
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

        self.source.Update()
        volume = self.source.GetOutput()
        for name, activate in (
            ("global", volume.GetPointData().SetGlobalIds),
            ("pedigree", volume.GetPointData().SetPedigreeIds),
        ):
            ids = numpy_to_vtk(1000 * numpy.arange(volume.GetNumberOfPoints()), deep=True)
            ids.SetName(name)
            activate(ids)
        self.filter.SetInputDataObject(0, volume)
        self.filter.SetDeformationData(make_field((0.3, 0, 0)))
        self.filter.Update()
        data = self.filter.GetOutputDataObject(0).GetPointData()
        for array in (data.GetGlobalIds(), data.GetPedigreeIds()):
            values = vtk_to_numpy(array)
            self.assertTrue(numpy.any(values > 0))
            self.assertFalse(numpy.any(values % 1000))

    # As in the C++ filter, arrays of bits are left out.
    def test_bits(self):
        from vtkmodules.vtkCommonCore import vtkBitArray

        self.source.Update()
        volume = self.source.GetOutput()
        bits = vtkBitArray()
        bits.SetName("bits")
        bits.SetNumberOfTuples(volume.GetNumberOfPoints())
        volume.GetPointData().AddArray(bits)
        self.filter.SetInputDataObject(0, volume)
        self.filter.SetDeformationData(make_field(self.SHIFT))
        self.filter.Update()
        self.expect_shift()
        self.assertFalse(self.filter.GetOutputDataObject(0).GetPointData().HasArray("bits"))
        volume.GetPointData().RemoveArray("RTData")
        bits.SetName("cells")
        volume.GetCellData().AddArray(bits)
        self.expect_error('no numeric point array.* Its cell arrays: "cells".*cells_to_points', make_field(self.SHIFT))

    # VTK prints these errors, too.
    def test_misuse(self):
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonDataModel import (
            VTK_TRIANGLE_STRIP,
            vtkDataObject,
            vtkImageData,
            vtkMultiBlockDataSet,
            vtkPolyData,
            vtkUnstructuredGrid,
        )

        with self.assertRaisesRegex(AttributeError, "has no SetSamplingFactor"):
            self.filter.SetSamplingFactor(2)
        self.expect_error("no active vectors", vtkImageData())
        self.expect_error("no cells", vtkUnstructuredGrid())
        self.expect_error("vtkPolyData", vtkPolyData())
        self.filter.SetInputArrayToProcess(0, 1, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "vectors")
        self.expect_error("not chosen among the arrays of points", make_field(self.SHIFT))
        self.filter.SetInputArrayToProcess(0, 1, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "")
        self.expect_error("is not finite", make_mesh([numpy.nan, 0.0, 0.0]))
        self.expect_error("no tetrahedra, but 1 triangle strip", make_mesh(self.SHIFT, VTK_TRIANGLE_STRIP))
        field = make_field(self.SHIFT)
        field.SetDimensions(3, 2, 2)
        self.expect_error('"vectors" has 8 tuples, but its grid needs 12', field)
        mesh = make_mesh(self.SHIFT)
        mesh.GetCellData().AddArray(mesh.GetPointData().GetVectors())
        mesh.GetPointData().Initialize()
        advice = 'Its cell arrays: "vectors".*vtkCellDataToPointData.*cell_data_to_point_data'
        self.expect_error("no active vectors.*" + advice, mesh)
        self.filter.SetInputArrayToProcess(0, 1, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "vectors")
        self.expect_error('no numeric point array "vectors".*point arrays: none. ' + advice, mesh)
        self.filter.SetInputArrayToProcess(0, 1, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "")
        self.filter.AddDensityArray("dose")
        self.expect_error('no numeric point array "dose".*Its point arrays: "RTData"', make_mesh(self.SHIFT))
        self.filter.ClearDensityArrays()
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, make_field(self.SHIFT))
        self.expect_error(r"a vtkImageData, as a block of a vtkMultiBlockDataSet.*blocks\[0\]", blocks)
        self.expect_error("has no cells", vtkMultiBlockDataSet())
        # Colors and normals are not displacements, unless they are chosen.
        for name, kind, are_normals in (("rgb", numpy.uint8, False), ("N", float, True), ("Normals", float, False)):
            array = numpy_to_vtk(numpy.ones((8, 3), kind), deep=True)
            array.SetName(name)
            mesh = make_mesh(self.SHIFT)
            mesh.GetPointData().AddArray(array)
            mesh.GetPointData().SetActiveNormals(name if are_normals else None)
            mesh.GetPointData().SetActiveVectors(None)
            self.filter.SetDeformationData(mesh)
            self.filter.Update()
            self.expect_shift()
            mesh.GetPointData().RemoveArray("vectors")
            self.expect_error(f'three components are: "{name}"', mesh)
            self.filter.SetInputArrayToProcess(0, 1, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, name)
            self.filter.Update()
            self.filter.SetInputArrayToProcess(0, 1, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "")
        # An array of the volume has the name of a generated one.
        self.source.Update()
        volume = self.source.GetOutput().NewInstance()
        volume.DeepCopy(self.source.GetOutput())
        volume.GetPointData().GetScalars().SetName("Jacobian")
        self.filter.SetInputData(volume)
        self.filter.GenerateJacobianOn()
        self.expect_error('"Jacobian", which is the name', make_mesh(self.SHIFT))
        self.filter.GenerateJacobianOff()
        self.filter.Update()
        self.filter.SetInputConnection(self.source.GetOutputPort())
        # The filter works again with a valid deformation.
        self.filter.SetDeformationData(make_mesh(self.SHIFT))
        self.filter.Update()
        self.expect_shift()


if __name__ == "__main__":
    unittest.main()
