# SPDX-License-Identifier: BSD-3-Clause
"""Misuse: an exception says what is wrong, the process does not end, and the next call works."""

import copy
import gc
import os
import signal
import subprocess
import sys
import threading
import unittest
import warnings
import weakref
from unittest import mock

import numpy

import deformvolume
from moving_cube import deform
from own_process import OwnProcess

AFFINE = numpy.diag([2.0, 2.0, 2.0, 1.0])
POINTS = 18.0 * numpy.eye(4, 3, k=-1)
CELLS = numpy.array([[0, 1, 2, 3]])
MOVED = numpy.ones((4, 3))
Mesh = deformvolume.Mesh


def make_volume(order="F"):
    values = numpy.random.RandomState(2).rand(10, 11, 12)
    return numpy.array(values.astype(numpy.float32), order=order)


class Misuse(unittest.TestCase):
    def refuse(self, kind, words, volume=None, mesh=None, affine=AFFINE, **options):
        volume = make_volume() if volume is None else volume
        mesh = Mesh(POINTS, CELLS, MOVED) if mesh is None else mesh
        with self.assertRaisesRegex(kind, words):
            deformvolume.deform(volume, mesh, affine, **options)

    def tearDown(self):
        result = deformvolume.deform(make_volume(), Mesh(POINTS, CELLS, MOVED), AFFINE, bounds="volume")
        self.assertTrue(result.coverage.any())

    def test_shapes(self):
        self.refuse(ValueError, r"shape \(10, 11\)", make_volume()[:, :, 0])
        self.refuse(ValueError, "empty", make_volume()[:, :0])
        self.refuse(deformvolume.Error, "", make_volume()[:1])
        self.refuse(ValueError, "4 x 4", affine=numpy.eye(3))
        self.refuse(ValueError, r"\(n, 3\)", mesh=Mesh(POINTS[:, :2], CELLS, MOVED))
        self.refuse(ValueError, r"\(4, 3\)", mesh=Mesh(POINTS, CELLS, MOVED[:3]))
        self.refuse(ValueError, r"\(m, 4\)", mesh=Mesh(POINTS, CELLS[:, :3], MOVED))
        self.refuse(ValueError, r"\(m, 4\)", mesh=Mesh(POINTS, CELLS[0], MOVED))

    def test_types(self):
        for kind in (complex, object, "U3", "datetime64[s]", numpy.float16):
            self.refuse(TypeError, "Give integers", numpy.zeros((3, 3, 3), kind))

        class Image:  # as of nibabel
            dataobj = numpy.zeros((3, 3, 3))

        self.refuse(TypeError, r"is a Image. Give its values, numpy.asarray\(image.dataobj\)", Image())

        class ItkImage:  # as of the package itk
            def __array__(self, *_, **__):
                return numpy.zeros((3, 3, 3))

            def GetSpacing(self):  # pylint: disable=invalid-name
                return 1, 1, 1

        self.refuse(TypeError, "is a ItkImage. Give an array with the axes x, y, z", ItkImage())
        of_nifti = deformvolume.Field(numpy.zeros((3, 3, 3, 1, 3)), AFFINE)
        self.refuse(ValueError, "Remove axis 3", mesh=of_nifti)
        self.refuse(TypeError, "Give integers", mesh=Mesh(POINTS.astype(complex), CELLS, MOVED))
        self.refuse(ValueError, "float64", mesh=Mesh(POINTS, CELLS.astype(float), MOVED))
        with self.assertRaisesRegex(TypeError, "Give a Mesh or a Field"):
            deformvolume.deform(make_volume(), POINTS)

    def test_numbers(self):
        self.refuse(deformvolume.Error, "finite", mesh=Mesh(POINTS, CELLS, MOVED * numpy.nan))
        self.refuse(deformvolume.Error, "", affine=numpy.diag([1.0, numpy.nan, 1.0, 1.0]))
        field = deformvolume.Field(numpy.full((2, 2, 2, 3), numpy.nan), AFFINE)
        self.refuse(deformvolume.Error, "finite", mesh=field)
        # NaN is a valid value of a volume.
        volume = make_volume()
        volume[4] = numpy.nan
        field = deformvolume.Field(numpy.zeros((2, 2, 2, 3)), numpy.diag([30.0, 30.0, 30.0, 1.0]))
        result = deformvolume.deform(volume, field, AFFINE, bounds="volume", interpolation="nearest")
        numpy.testing.assert_array_equal(result.array, volume)

    def test_cells(self):
        def refuse(words, *cells):
            self.refuse((ValueError, deformvolume.Error), words, mesh=Mesh(POINTS, cells, MOVED))

        self.refuse(deformvolume.Error, "4", mesh=Mesh(POINTS, CELLS + 1, MOVED))
        self.refuse(deformvolume.Error, "", mesh=Mesh(POINTS, numpy.zeros((0, 4), int), MOVED))
        self.refuse(deformvolume.Error, "", mesh=Mesh(numpy.zeros((0, 3)), CELLS, numpy.zeros((0, 3))))
        refuse("no tetrahedra", [0], [[]])
        refuse("", [10], [[0, 1, 2]])  # a tetrahedron of three points
        refuse("Cell 1 is a polyhedron .* whose faces a Mesh does not have", [10, 42], [[0, 1, 2, 3]] * 2)
        refuse("one type for each cell", [10, 10], [[0, 1, 2, 3]])
        refuse("from 0 to 255", numpy.array([266]), [[0, 1, 2, 3]])
        refuse("from 0 to 255", [10.0], [[0, 1, 2, 3]])
        refuse("Cell 1 is", [10, 10], [[0, 1, 2, 3], [0.0, 1.0, 2.0, 3.5]])
        refuse("Cell 0 is", [10], [[[0, 1], [2, 3]]])

    def test_orders(self):
        mesh = Mesh(POINTS, CELLS, MOVED)
        fortran = make_volume()
        wanted = deformvolume.deform(fortran, mesh, AFFINE).array
        backwards = numpy.ascontiguousarray(fortran[::-1, ::-1])[::-1, ::-1]
        strided = numpy.zeros((20, 11, 24), numpy.float32)
        strided[::2, :, ::2] = fortran
        other = fortran.astype(fortran.dtype.newbyteorder())
        arrays = [fortran, make_volume("C"), backwards, strided[::2, :, ::2], other]
        for array in arrays:
            before = array.copy()
            array.flags.writeable = False
            numpy.testing.assert_array_equal(deformvolume.deform(array, mesh, AFFINE).array, wanted)
            numpy.testing.assert_array_equal(array, before)
        # Views with other strides, and read-only points and cells, are valid.
        for array in (POINTS, CELLS, MOVED):
            array.flags.writeable = False
        turned = Mesh(numpy.asfortranarray(POINTS), CELLS[:, ::-1][:, ::-1], MOVED[::-1][::-1])
        numpy.testing.assert_array_equal(deformvolume.deform(fortran, turned, AFFINE).array, wanted)

    def test_blanked_integers(self):
        deformer = deformvolume.Deformer()
        with self.assertRaisesRegex(ValueError, "There is no volume"):
            deformer.set_blanked(numpy.zeros((10, 11, 12), bool))
        with self.assertRaisesRegex(deformvolume.Error, "no deformation mesh"):
            deformer.set_displacements(MOVED)
        deformer.set_volume(make_volume(), AFFINE)
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        with self.assertRaisesRegex(ValueError, r"must have the shape \(10, 11, 12\)"):
            deformer.set_blanked(numpy.zeros((10, 11, 11), bool))
        blanked = numpy.zeros((10, 11, 12), int)
        blanked[2:4] = 256
        deformer.set_blanked(blanked)
        some = deformer.deform().coverage.sum()
        deformer.set_blanked(blanked != 0)
        self.assertEqual(some, deformer.deform().coverage.sum())
        deformer.set_blanked(None)
        self.assertLess(some, deformer.deform().coverage.sum())

    # The deformer reads a Fortran array in place.
    def test_borrowed_memory(self):
        deformer = deformvolume.Deformer()
        volume = make_volume()
        deformer.set_volume(volume, AFFINE)
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        wanted = deformer.deform().array
        for check in (True, False):
            with self.assertRaisesRegex(ValueError, "resize"):
                volume.resize((100, 100, 100), refcheck=check)
        vectors = numpy.zeros((2, 2, 2, 3)).transpose((2, 1, 0, 3))
        deformer.set_deformation(deformvolume.Field(vectors, AFFINE))
        with self.assertRaisesRegex(ValueError, "resize"):
            vectors.base.resize((9, 9, 9, 9), refcheck=False)
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        # After values change in place, set_volume() must be called again.
        volume *= 2
        deformer.deform()
        deformer.set_volume(volume, AFFINE)
        numpy.testing.assert_array_equal(deformer.deform().array, 2 * wanted)
        # The deformer keeps the array alive.
        del volume
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        numpy.testing.assert_array_equal(deformer.deform().array, 2 * wanted)
        deformer.set_volume(make_volume(), AFFINE)
        numpy.testing.assert_array_equal(deformer.deform().array, wanted)

    def test_flags_and_options(self):
        self.refuse(TypeError, "categorical is 'False'", categorical="False")
        self.refuse(TypeError, "The device is None", device=None)
        self.refuse(TypeError, "The reference is a ndarray", reference=AFFINE)
        self.refuse(ValueError, "The spacing is 1.0", spacing=1.0)
        for spacing in ((0, 0, 0), (1, 0, 1), (1, -1, 1), (1, numpy.nan, 1)):
            self.refuse(ValueError, "three numbers greater than 0", spacing=spacing)
        bounds = numpy.array([0.0, 1.0, 0.0, 1.0, 0.0, 1.0])
        self.refuse(ValueError, "with a reference", reference=((5, 5, 5), AFFINE), bounds=bounds)
        self.refuse(ValueError, "with a reference", reference=((5, 5, 5), AFFINE), bounds="volume")
        self.refuse(ValueError, "padding is", padding=2**40)
        self.refuse(TypeError, "masked array", numpy.ma.masked_less(make_volume(), 0.5))
        self.refuse(TypeError, "The padding is 1.5. Give an integer", padding=1.5)
        self.refuse(TypeError, "shape of the reference is 5.5. Give an integer", reference=((5.5, 5, 5), AFFINE))
        words = r"first element of the reference is an array of the shape \(4, 4\)"
        self.refuse(ValueError, words, reference=(AFFINE, (5, 5, 5)))
        mesh = Mesh(POINTS, CELLS, MOVED)
        self.refuse(TypeError, "affine matrix of the volume is Mesh", mesh=AFFINE, affine=mesh)
        self.refuse(TypeError, "Array 0 of the volume is a Mesh. Give an array", mesh, make_volume())
        self.refuse(TypeError, "The background is None", background=None)
        self.refuse(TypeError, "The fade distance is 'far'", outside="keep", fade_distance="far")
        self.refuse(TypeError, "extra_background is None", extra_background=None)
        self.refuse(TypeError, "A number of bounds is None", bounds=[None] * 6)
        self.refuse(ValueError, "bounds has the shape", bounds=None)
        self.refuse(ValueError, "outside is", outside=["keep"])
        self.refuse(ValueError, "first_index is 5", first_index=5)
        with self.assertWarnsRegex(deformvolume.DeformationWarning, "moveaxis"):
            deformvolume.Deformer().set_volume(numpy.zeros((3, 10, 11, 12)), AFFINE)
        self.refuse(TypeError, "jacobian is 'no'", jacobian="no")
        self.refuse(ValueError, "no effect", fade_distance=3.0)
        self.refuse(ValueError, "int16 cannot hold", make_volume().astype("int16"), background=numpy.nan)
        field = deformvolume.Field(numpy.zeros((2, 2, 2, 3)), AFFINE, inverse="False")
        self.refuse(TypeError, "inverse is 'False'", mesh=field)

    def test_background(self):
        mesh = Mesh(POINTS, CELLS, MOVED)
        wanted = deformvolume.deform(make_volume(), mesh, AFFINE, background=7.0).array
        for background in (numpy.array(7.0), numpy.float32(7.0), numpy.array([7.0]), [7.0]):
            result = deformvolume.deform(make_volume(), mesh, AFFINE, background=background).array
            numpy.testing.assert_array_equal(result, wanted)

    def test_two_tetrahedra(self):
        cells = ((0, 1, 2, 3), (0, 1, 2, 3))
        mesh = Mesh(POINTS, cells, MOVED)
        wanted = deformvolume.deform(make_volume(), Mesh(POINTS, numpy.array(cells), MOVED), AFFINE)
        numpy.testing.assert_array_equal(deformvolume.deform(make_volume(), mesh, AFFINE).array, wanted.array)
        self.assertNotEqual(mesh, Mesh(POINTS, cells, MOVED))
        # Four cells of different types.
        lists = [[0, 1, 2, 3], [0, 1, 2], [0, 1, 2, 3], [0]]
        with self.assertWarns(deformvolume.DeformationWarning):
            result = deformvolume.deform(make_volume(), Mesh(POINTS, ([10, 5, 10, 1], lists), MOVED), AFFINE)
        numpy.testing.assert_array_equal(result.array, wanted.array)

    # Warnings name the line of the user, so that Python shows each once.
    def test_place_of_warnings(self):
        deformer = deformvolume.Deformer()
        deformer.set_volume(make_volume(), AFFINE)
        deformer.set_blanked(numpy.ones((10, 11, 12), bool))
        with self.assertWarns(deformvolume.DeformationWarning) as caught:
            deformer.deform()
        self.assertEqual(caught.filename, __file__)

    # The origin of the world is a voxel of many scans, so that a mesh in meters holds a voxel.
    def test_points(self):
        field = deformvolume.Field(numpy.tile([5.0, 0.0, 0.0], (2, 2, 2, 1)), numpy.diag([10.0, 10.0, 10.0, 1.0]))
        for kind, words, points in (
            (ValueError, r"shape \(3,\)", [1, 2, 3]),
            (TypeError, "Give integers", [["a", "b", "c"]]),
            (deformvolume.Error, "Point 1 is not finite", [[1, 2, 3], [1, numpy.nan, 3]]),
        ):
            with self.assertRaisesRegex(kind, words):
                deformvolume.deform_points(points, field)
        with self.assertRaisesRegex(TypeError, "inverse"):
            deformvolume.deform_points([[1, 2, 3]], field, inverse="False")
        with self.assertRaises(ZeroDivisionError):
            deformvolume.deform_points([[1, 2, 3]], field, progress=lambda _: 1 / 0)
        with self.assertRaisesRegex(deformvolume.Error, "no displacements"):
            deformvolume.deform_points([[1, 2, 3]], Mesh(POINTS, CELLS))
        points = numpy.array([[1, 2, 3], [-1, 2, 3]], "i2")
        with self.assertWarnsRegex(deformvolume.DeformationWarning, "1 of 2 points lie outside"):
            moved, valid = deformvolume.deform_points(points, field)
        numpy.testing.assert_array_equal(moved, [[6, 2, 3], [-1, 2, 3]])
        numpy.testing.assert_array_equal(valid, [True, False])
        field.inverse = True
        moved, valid = deformvolume.deform_points(points, field, outside="extrapolate")
        numpy.testing.assert_allclose(moved, points - [5, 0, 0], atol=1e-9)
        self.assertTrue(valid.all())
        self.assertEqual(deformvolume.deform_points(numpy.zeros((0, 3)), field).points.shape, (0, 3))

    def test_units(self):
        affine = numpy.eye(4)
        affine[:3, 3] = -4.0
        corners = numpy.array([[-0.1, -0.1, -0.1], [0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]])
        field = deformvolume.Field(numpy.zeros((2, 2, 2, 3)), numpy.diag([0.5, 0.5, 0.5, 1.0]))
        for deformation, outside in ((Mesh(corners, CELLS[:1], 0.01 * corners), "keep"), (field, "discard")):
            with self.assertWarnsRegex(deformvolume.DeformationWarning, "meters"):
                deformvolume.deform(make_volume(), deformation, affine, outside=outside)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            deformvolume.deform(make_volume(), Mesh(corners, CELLS[:1], 0.01 * corners), affine, outside="extrapolate")
            deformvolume.deform(make_volume(), Mesh(9 * corners, CELLS[:1], 0.01 * corners), affine, outside="keep")
            deformvolume.deform(make_volume(), field, affine, outside="extrapolate")  # its vectors are equal
        field.vectors[0, 0, 0, 0] = 0.001
        with self.assertWarnsRegex(deformvolume.DeformationWarning, "smaller than two voxels"):
            deformvolume.deform(make_volume(), field, affine, outside="extrapolate")
        field.affine = numpy.diag([4000.0, 4000.0, 4000.0, 1.0])
        with self.assertWarnsRegex(deformvolume.DeformationWarning, "a hundred times as long"):
            deformvolume.deform(make_volume(), field, AFFINE)
        # An output that cannot be allocated.
        vectors = 25000.0 * numpy.indices((2, 2, 2)).transpose((1, 2, 3, 0))
        field = deformvolume.Field(vectors, numpy.diag([18.0, 20.0, 22.0, 1.0]))
        self.refuse(MemoryError, r"voxels, and the volume \(10, 11, 12\).*same unit", mesh=field)

    def test_mask_keeps_other_masks(self):
        deformer = deformvolume.Deformer()
        deformer.set_volume(make_volume(), AFFINE)
        active = numpy.full((11, 10, 9), 31, numpy.uint8)
        active[:, :5] = 0
        deformer._set_masks(active=active)
        some = deformer.deform().coverage.sum()
        deformer.set_blanked(numpy.zeros((10, 11, 12), bool))
        self.assertEqual(some, deformer.deform().coverage.sum())
        deformer._set_masks()
        self.assertLess(some, deformer.deform().coverage.sum())

    # The result of bool can be an index, also with cubic interpolation, which overshoots, and any background.
    def test_bool(self):
        mask = numpy.random.RandomState(3).rand(10, 11, 12) > 0.5
        field = deformvolume.Field(numpy.full((2, 2, 2, 3), 0.7), numpy.diag([30.0, 30.0, 30.0, 1.0]))
        for options in ({}, {"categorical": True}, {"interpolation": "cubic", "background": 7.0}):
            result = deformvolume.deform([mask, mask.view(numpy.uint8)], field, AFFINE, bounds="volume", **options)
            self.assertEqual([array.dtype for array in result.arrays], [bool, numpy.uint8])
            self.assertTrue(result.array.any() and not result.array.all())
            numpy.testing.assert_array_equal(result.array.view(numpy.uint8), result.arrays[1] != 0)
        self.assertEqual(result.arrays[1].max(), 7)
        self.refuse(ValueError, "bool cannot hold", mask, background=numpy.nan)

    def test_repr(self):
        text = repr(deformvolume.deform(make_volume(), Mesh(POINTS, CELLS, MOVED), AFFINE, bounds="volume"))
        self.assertIn("float32 (10, 11, 12)", text)
        self.assertIn("'number_of_inverted_tetrahedra': 0", text)
        self.assertLess(len(text), 500)

    # Any value other than 0 blanks a voxel.
    def test_blanked(self):
        deformer = deformvolume.Deformer()
        deformer.set_volume(make_volume(), AFFINE)
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        for value in (0.5, 256, True):
            deformer.set_blanked(numpy.full((10, 11, 12), value))
            with self.assertWarns(deformvolume.DeformationWarning):
                self.assertFalse(deformer.deform().coverage.any())

    # Python loses exceptions of signal handlers that run when the library calls Python.
    def test_interrupt(self):
        deformer = deformvolume.Deformer()
        deformer.set_volume(make_volume(), AFFINE)
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        # The shell lets background processes ignore this signal.
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, before)
        for _ in range(20):
            with self.assertRaises(KeyboardInterrupt):
                deformer.deform(progress=lambda _: os.kill(os.getpid(), signal.SIGINT))
            self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)
        # A handler of the program is called, and does not end the call.
        numbers = []
        signal.signal(signal.SIGINT, lambda number, _: numbers.append(number))
        self.assertTrue(deformer.deform(progress=lambda _: os.kill(os.getpid(), signal.SIGINT)).coverage.any())
        self.assertEqual(set(numbers), {signal.SIGINT})
        # A handler of another signal raises its own exception.
        def raise_timeout(*_):
            raise TimeoutError

        signal.signal(signal.SIGUSR1, raise_timeout)
        self.addCleanup(signal.signal, signal.SIGUSR1, signal.SIG_DFL)
        for _ in range(20):
            with self.assertRaises(TimeoutError):
                deformer.deform(progress=lambda _: os.kill(os.getpid(), signal.SIGUSR1))
        for stop in (False, numpy.bool_(False)):
            with self.assertRaises(KeyboardInterrupt):
                deformer.deform(progress=lambda _, stop=stop: stop)

    # A handler that raises an exception while the other handlers are restored.
    def test_interrupted_interrupts(self):
        numbers = []
        for number in (signal.SIGUSR1, signal.SIGUSR2):
            self.addCleanup(signal.signal, number, signal.signal(number, lambda number, _: numbers.append(number)))
        before = signal.getsignal(signal.SIGUSR1)
        interrupts = deformvolume._deformer._Interrupts()
        patch = mock.patch("signal.signal", side_effect=TimeoutError)
        with self.assertRaises(TimeoutError), interrupts:
            patch.start()
        patch.stop()
        for number in (signal.SIGUSR1, signal.SIGUSR2):
            os.kill(os.getpid(), number)
        self.assertEqual(numbers, [signal.SIGUSR1, signal.SIGUSR2])
        # The next call restores the handlers.
        with deformvolume._deformer._Interrupts():
            pass
        self.assertIs(signal.getsignal(signal.SIGUSR1), before)

    # Neither the exception nor its traceback keeps the arrays of a call that has failed. Python 3.9.2 keeps them until
    # the garbage collection.
    @unittest.skipIf(sys.version_info < (3, 10), "the first versions of Python 3.9 keep the arrays")
    def test_failed_calls_free_their_arrays(self):
        deformer = deformvolume.Deformer()
        deformer.set_volume(make_volume(), AFFINE)
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        made = []

        def make(*arguments, make=numpy.empty):
            array = make(*arguments)
            made.append(weakref.ref(array))
            return array

        gc.disable()
        self.addCleanup(gc.enable)
        with mock.patch("numpy.empty", make):
            try:
                deformer.deform(jacobian=True, progress=lambda _: 1 / 0)
            except ZeroDivisionError:
                pass
        self.assertGreaterEqual(len(made), 3)
        self.assertTrue(all(array() is None for array in made))

    def test_callbacks_and_copies(self):
        deformer = deformvolume.Deformer()
        deformer.set_volume(make_volume(), AFFINE)
        deformer.set_deformation(Mesh(POINTS, CELLS, MOVED))
        wanted = deformer.deform().array
        for call in (deformer.deform, lambda: deformer.set_volume(make_volume(), AFFINE), deformer.release_memory):
            with self.assertRaisesRegex(deformvolume.Error, "is running"):
                deformer.deform(progress=lambda _, call=call: call())
        for copied in (copy.copy, copy.deepcopy):
            with self.assertRaisesRegex(TypeError, "cannot be copied"):
                copied(deformer)
        with deformer:
            numpy.testing.assert_array_equal(deformer.deform().array, wanted)
        deformer.__exit__()
        for call in (deformer.deform, deformer.release_memory):
            with self.assertRaisesRegex(deformvolume.Error, "is closed"):
                call()

    def test_threads(self):
        shared = deformvolume.Deformer()
        shared.set_volume(make_volume(), AFFINE)
        shared.set_deformation(Mesh(POINTS, CELLS, MOVED))
        wanted = shared.deform().array
        equal = []

        def work():
            for _ in range(3):
                alone = deformvolume.deform(make_volume(), Mesh(POINTS, CELLS, MOVED), AFFINE).array
                equal.append(numpy.array_equal(alone, wanted) and numpy.array_equal(shared.deform().array, wanted))

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(equal, 12 * [True])

    # A forked process has no threads of the driver, so its calls would wait forever. They raise an error instead.
    def test_fork(self):
        shared = deformvolume.Deformer()
        shared.set_volume(make_volume(), AFFINE)
        for call in (deformvolume.devices, deform, shared.deform):
            child = os.fork()
            if child == 0:
                signal.alarm(60)
                status = 1
                try:
                    call()
                except deformvolume.Error as error:
                    status = 0 if "spawn" in str(error) else 2
                finally:
                    os._exit(status)
            self.assertEqual(os.waitpid(child, 0)[1], 0, call)


    # The lock of a deformer that another thread uses stays locked in the forked process.
    def test_fork_during_a_call(self):
        shared = deformvolume.Deformer()
        shared.set_volume(make_volume(), AFFINE)
        begun, go_on = threading.Event(), threading.Event()

        def wait(_):
            begun.set()
            go_on.wait()

        thread = threading.Thread(target=shared.deform, kwargs={"progress": wait})
        thread.start()
        begun.wait()
        child = os.fork()
        if child == 0:
            signal.alarm(60)
            status = 1
            try:
                shared.release_memory()
            except deformvolume.Error as error:
                status = 0 if "spawn" in str(error) else 2
            finally:
                os._exit(status)
        go_on.set()
        thread.join()
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    # A daemon thread deforms until the process has ended, and a function that is called at exit deforms, too.
    def test_exit(self):
        program = """
import atexit, sys, threading
atexit.register(lambda: print(deformer.deform().array.sum()))
sys.path.insert(0, {folder!r})
import deformvolume, numpy
from test_misuse import AFFINE, CELLS, MOVED, POINTS, Mesh, make_volume
deformer, other = deformvolume.Deformer(), deformvolume.Deformer()
for one in deformer, other:
    one.set_volume(make_volume(), AFFINE)
    one.set_deformation(Mesh(POINTS, CELLS, MOVED))
begun = threading.Event()
def work():
    while True:
        other.deform()
        deformer.deform()
        deformvolume.deform(make_volume(), Mesh(POINTS, CELLS, MOVED), AFFINE)
        begun.set()
threading.Thread(target=work, daemon=True).start()
begun.wait()
print(deformer.deform().array.sum())
"""
        folder = os.path.dirname(os.path.abspath(__file__))
        for _ in range(5):
            done = subprocess.run(
                [sys.executable, "-c", program.format(folder=folder)],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                universal_newlines=True,
                check=False,
                timeout=100,
            )
            lines = done.stdout.splitlines()
            self.assertEqual((done.returncode, len(lines), len(set(lines))), (0, 2, 1), done.stdout)


class Drivers(OwnProcess):
    def test_none(self):
        self.assertRegex(
            self.run_program(DEFORMVOLUME_DRIVER="system", OPENCL_VENDOR_PATH=self.folder),
            'Error: There is no OpenCL device.*"pip install pocl-binary-distribution"',
        )


if __name__ == "__main__":
    unittest.main()
