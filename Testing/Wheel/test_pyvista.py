# SPDX-License-Identifier: BSD-3-Clause
"""Images and surfaces of pyvista. The tests are skipped without pyvista."""

import unittest
import warnings

import numpy

import deformvolume

try:
    import pyvista
except ImportError:
    pyvista = None

SHIFT = numpy.array([3.0, -2.0, 1.0])


class Images(unittest.TestCase):
    def setUp(self):
        if pyvista is None:
            self.skipTest("pyvista is not installed")
        import deformvolume.pyvista
        from deformvolume.vtk import DeformVolume

        self.module = deformvolume.pyvista
        self.DeformVolume = DeformVolume
        self.image = pyvista.ImageData(dimensions=(12, 14, 16), spacing=(1.0, 1.0, 0.5), origin=(-5.0, 6.0, 7.0))
        self.image["v"] = numpy.random.RandomState(1).rand(self.image.n_points)
        self.mesh = pyvista.ImageData(dimensions=(3, 3, 3), spacing=(6.0, 7.0, 4.0), origin=(-5.0, 6.0, 7.0))
        self.mesh = self.mesh.cast_to_unstructured_grid()
        self.mesh["U"] = numpy.tile(SHIFT, (27, 1))

    def deform(self, *arguments, **options):
        return self.module.deform(self.image, *arguments, **options)

    def expect_warning(self, words, call):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = call()
        texts = [str(one.message) for one in caught]
        self.assertEqual([one.category for one in caught], [deformvolume.DeformationWarning], texts)
        self.assertEqual(caught[0].filename, __file__)
        self.assertIn(words, texts[0])
        return result

    def test_misuse(self):
        for given in (None, numpy.zeros((3, 3))):
            with self.assertRaisesRegex(TypeError, "deformation is a "):
                self.deform(given)
            with self.assertRaisesRegex(TypeError, "deformation is a "):
                self.module.deform_points(pyvista.Sphere(), given)
            with self.assertRaisesRegex(TypeError, "image is a "):
                self.module.deform(given, self.mesh)
            with self.assertRaisesRegex(TypeError, "points is a "):
                self.module.deform_points(given, self.mesh)
        with self.assertRaisesRegex(TypeError, "points is a ImageData"):
            self.module.deform_points(self.image, self.mesh)
        words = "has no property outside.*OutsideMode=DeformVolume.KEEP.*not all properties"
        with self.assertRaisesRegex(TypeError, words):
            self.deform(self.mesh, outside="keep")
        with self.assertRaisesRegex(TypeError, "or DeformVolume.KEEP"):
            self.deform(self.mesh, OutsideMode="keep")
        self.image.cell_data["c"] = numpy.arange(self.image.n_cells)
        with self.assertRaisesRegex(ValueError, r"\['c', 'd'\].*\['c'\] are cell arrays"):
            self.deform(self.mesh, categorical=["v", "c", "d"])
        with self.assertRaisesRegex(ValueError, r"\['c'\], which density names"):
            self.deform(self.mesh, density=["v", "c"])
        with self.assertRaisesRegex(TypeError, "vtkPolyData"):
            self.module.deform_points(pyvista.Sphere(), pyvista.Sphere(), vectors="Normals")
        with self.assertRaisesRegex(ValueError, '"Normals"'):
            self.mesh.rename_array("U", "Normals")
            self.deform(self.mesh)

    # pyvista does not show warnings of VTK.
    def test_warnings(self):
        from vtkmodules.vtkFiltersCore import vtkContourFilter

        types = numpy.append(self.mesh.celltypes, pyvista.CellType.TRIANGLE)
        mixed = pyvista.UnstructuredGrid(numpy.append(self.mesh.cells, [3, 0, 1, 2]), types, self.mesh.points)
        mixed["U"] = self.mesh["U"]
        self.expect_warning("1 triangle", lambda: self.deform(mixed))
        if hasattr(self.image, "deformvolume"):
            self.expect_warning("1 triangle", lambda: self.image.deformvolume.deform(mixed))
        kept = self.DeformVolume()
        kept.SetInputData(self.image)
        kept.SetDeformationData(mixed)
        self.expect_warning("1 triangle", kept.Update)
        # VTK runs the filter.
        kept = self.DeformVolume()
        kept.SetInputData(self.image)
        kept.SetDeformationData(mixed)
        contour = vtkContourFilter()
        contour.SetInputConnection(kept.GetOutputPort())
        self.expect_warning("1 triangle", contour.Update)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaisesRegex(deformvolume.DeformationWarning, "1 triangle"):
                self.deform(mixed)
        self.image.cell_data["c"] = numpy.arange(self.image.n_cells)
        self.expect_warning('are not resampled: "c"', lambda: self.deform(self.mesh))

    def test_extent(self):
        turned = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        for direction in (numpy.eye(3), turned):
            self.image.direction_matrix = direction
            mesh = self.image.cast_to_unstructured_grid()
            mesh["U"] = numpy.tile(SHIFT, (mesh.n_points, 1))
            result = self.deform(mesh)
            self.assertEqual(result.extent[::2], (0, 0, 0))
            self.assertEqual(result.dimensions, self.image.dimensions)
            numpy.testing.assert_allclose(result.points, self.image.points + SHIFT, atol=1e-12)
            numpy.testing.assert_array_equal(result["v"], self.image["v"])
        self.assertEqual(result.extract_subset((0, 3, 0, 3, 0, 3)).n_points, 64)

    def test_grids(self):
        wanted = self.deform(self.mesh)
        axes = [numpy.unique(self.mesh.points[:, axis]) for axis in range(3)]
        grid = pyvista.RectilinearGrid(*axes)
        grid["U"] = self.mesh["U"]
        numpy.testing.assert_array_equal(self.deform(grid)["v"], wanted["v"])
        grid = grid.cast_to_structured_grid()
        numpy.testing.assert_array_equal(self.deform(grid)["v"], wanted["v"])
        self.assertIn("v", self.deform(grid.warp_by_vector("U"), rest=grid).array_names)
        blocks = pyvista.MultiBlock([None, self.mesh])
        numpy.testing.assert_array_equal(self.deform(blocks, vectors="U")["v"], wanted["v"])
        numpy.testing.assert_allclose(self.deform(self.mesh, density=["v"])["v"], wanted["v"], rtol=1e-6)

    # A surface moves as the volume does.
    def test_points(self):
        sphere = pyvista.Sphere(radius=2.0, center=(0.0, 12.0, 11.0))
        sphere["heights"] = sphere.points[:, 2].copy()
        before = sphere.points.copy()
        moved = self.module.deform_points(sphere, self.mesh, vectors="U")
        self.assertIsInstance(moved, pyvista.PolyData)
        self.assertEqual(moved.points.dtype, numpy.float32)
        numpy.testing.assert_allclose(moved.points, before + SHIFT, atol=1e-5)
        numpy.testing.assert_array_equal(sphere.points, before)
        numpy.testing.assert_array_equal(moved["heights"], sphere["heights"])
        self.assertIn("Normals", sphere.array_names)
        self.assertNotIn("Normals", moved.array_names)
        back = self.module.deform_points(moved, self.mesh, inverse=True)
        numpy.testing.assert_allclose(back.points, before, atol=1e-5)
        warped = self.mesh.warp_by_vector("U")
        numpy.testing.assert_allclose(
            self.module.deform_points(sphere, warped, rest=self.mesh).points, moved.points, atol=1e-5
        )
        field = pyvista.ImageData(dimensions=(2, 2, 2), spacing=(40.0, 40.0, 40.0), origin=(-20.0, -20.0, -20.0))
        field["U"] = numpy.tile(-SHIFT, (8, 1))
        for grid in (sphere, sphere.cast_to_unstructured_grid(), sphere.points_to_double()):
            moved = self.module.deform_points(grid, field, FieldIsInverse=True)
            self.assertIs(type(moved), type(grid))
            self.assertEqual(moved.points.dtype, grid.points.dtype)
            numpy.testing.assert_allclose(moved.points, grid.points + SHIFT, atol=1e-5)
        outside = pyvista.PolyData([[0.0, 12.0, 11.0], [0.0, 12.0, 91.0]])
        moved = self.expect_warning("1 of 2 points", lambda: self.module.deform_points(outside, self.mesh))
        numpy.testing.assert_allclose(moved.points - outside.points, [SHIFT, 0 * SHIFT], atol=1e-5)
        moved = self.module.deform_points(outside, self.mesh, outside="keep", fade_distance=100.0)
        self.assertTrue((moved.points[1] != outside.points[1]).any())
        with self.assertRaisesRegex(ValueError, "no effect"):
            self.module.deform_points(outside, self.mesh, fade_distance=100.0)
        self.assertEqual(self.module.deform_points(pyvista.PolyData(), self.mesh).n_points, 0)


if __name__ == "__main__":
    unittest.main()
