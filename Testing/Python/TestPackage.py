# SPDX-License-Identifier: BSD-3-Clause
"""Tests the package deformvolume: misuse first, then results, which equal those of vtkDeformVolumeFilter bit by bit,
with numpy arrays and in pipelines.

    TestPackage.py FOLDER

FOLDER contains the package with its library."""

import doctest
import sys
import warnings

import numpy as np

sys.path.insert(0, sys.argv[1])

import deformvolume as dv  # noqa: E402
from deformvolume.vtk import DeformVolume  # noqa: E402
import deformvolume_vtk  # noqa: E402
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkCharArray, vtkPoints, vtkUnsignedCharArray  # noqa: E402
from vtkmodules.vtkCommonDataModel import (  # noqa: E402
    vtkCellArray,
    vtkExplicitStructuredGrid,
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkRectilinearGrid,
    vtkStructuredGrid,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkAppendFilter  # noqa: E402
from vtkmodules.vtkFiltersSources import vtkPlaneSource, vtkSphereSource  # noqa: E402

from lattice import make_mesh  # noqa: E402

Filter = deformvolume_vtk.vtkDeformVolumeFilter
random = np.random.default_rng(3)
TURNED = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])


def expect(kind, text, call):
    """Checks that call() raises an exception of this type whose message contains this text."""
    try:
        call()
    except kind as error:
        assert text in str(error), f'"{text}" is not in "{error}"'
        return
    raise AssertionError(f'no {kind.__name__} with "{text}" was raised')


def make_image(first=3, size=(30, 25, 20), spacing=(1.5, 2.0, 2.5), direction=TURNED):
    image = vtkImageData()
    image.SetExtent(first, first + size[0] - 1, 0, size[1] - 1, -4, size[2] - 5)
    image.SetOrigin(-7.0, 11.0, 5.0)
    image.SetSpacing(*spacing)
    image.SetDirectionMatrix(*direction.ravel())
    # Other tests compile the kernels for arrays of these types, in this order.
    for name, values in (
        ("values", random.integers(-1000, 1000, size[::-1]).astype(np.int16)),
        ("fractions", random.normal(size=size[::-1]).astype(np.float32)),
        ("labels", random.integers(0, 5, size[::-1] + (2,)).astype(np.uint16)),
    ):
        flat = values.reshape(-1, 2) if values.ndim == 4 else values.ravel()
        made = numpy_to_vtk(flat, deep=True)
        made.SetName(name)
        made.SetComponentName(0, name + " of tissue")
        image.GetPointData().AddArray(made)
    image.GetPointData().SetActiveScalars("values")
    return image


def bend(mesh, amount=0.2):
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    low, high = points.min(axis=0), points.max(axis=0)
    s = (points - low) / (high - low)
    moved = amount * (high - low) * np.stack([np.sin(3 * s[:, 2]), s[:, 0] * s[:, 1], 0.5 * s[:, 0] ** 2], axis=1)
    made = numpy_to_vtk(moved.astype(np.float32), deep=True)
    made.SetName("displacement")
    mesh.GetPointData().SetVectors(made)
    return mesh


def make_field(image, size, amount=4.0):
    field = vtkImageData()
    field.SetDimensions(size, size, size)
    bounds = image.GetBounds()
    field.SetOrigin(*bounds[::2])
    field.SetSpacing(*[(bounds[2 * i + 1] - bounds[2 * i]) / (size - 1) for i in range(3)])
    made = numpy_to_vtk(amount * random.normal(size=(size**3, 3)), deep=True)
    made.SetName("vectors")
    field.GetPointData().SetVectors(made)
    return field


def make_reference():
    reference = vtkImageData()
    reference.SetExtent(-2, 30, 5, 29, 0, 21)
    reference.SetOrigin(20.0, 0.0, -30.0)
    reference.SetSpacing(1.7, 1.9, 2.3)
    reference.SetDirectionMatrix(-1, 0, 0, 0, 0, 1, 0, 1, 0)
    return reference


def compare(name, image, deformation, rest=None, reference=None, densities=(), **properties):
    """Checks that the filter of the package has the same output as the C++ filter."""
    outputs = []
    for kind in (DeformVolume, Filter):
        made = kind()
        made.SetInputDataObject(0, image)
        if deformation is not None:
            made.SetDeformationData(deformation)
        made.AddCategoricalArray("labels")
        for density in densities:
            made.AddDensityArray(density)
        made.SetBackgroundValue(-3.0)
        if rest is not None:
            made.SetRestData(rest)
        if reference is not None:
            made.SetReferenceData(reference)
        for key, value in properties.items():
            getattr(made, "Set" + key)(value)
        made.Update()
        outputs.append(made.GetOutputDataObject(0))
    ours, theirs = outputs
    assert ours.GetExtent() == theirs.GetExtent(), (name, ours.GetExtent(), theirs.GetExtent())
    assert ours.GetOrigin() == theirs.GetOrigin() and ours.GetSpacing() == theirs.GetSpacing(), name
    names = [ours.GetPointData().GetArrayName(i) for i in range(ours.GetPointData().GetNumberOfArrays())]
    wanted = [theirs.GetPointData().GetArrayName(i) for i in range(theirs.GetPointData().GetNumberOfArrays())]
    assert sorted(names) == sorted(wanted), (name, names, wanted)
    for array in names:
        a = vtk_to_numpy(ours.GetPointData().GetArray(array))
        b = vtk_to_numpy(theirs.GetPointData().GetArray(array))
        assert a.dtype == b.dtype and a.tobytes() == b.tobytes(), f"{name}: {array} differs"
        described = [one.GetPointData().GetArray(array).GetComponentName(0) for one in outputs]
        assert described[0] == described[1], (name, described)
    mask = vtk_to_numpy(ours.GetPointData().GetArray("vtkValidPointMask"))
    assert 0 < mask.sum(), name
    assert ours.GetPointData().GetScalars().GetName() == "values", ours.GetPointData().GetScalars().GetName()
    return ours


# Testing/Wheel/test_misuse.py has more cases.
def test_misuse():
    volume, affine = np.zeros((5, 6, 7), np.float32), np.eye(4)
    mesh = dv.Mesh(np.eye(4, 3), np.array([[0, 1, 2, 3]]), np.zeros((4, 3)))
    for kind, text, call in (
        (dv.Error, "spacing", lambda: dv.deform(volume, mesh, np.diag([1.0, 1.0, 0.0, 1.0]))),
        (dv.Error, "no displacements", lambda: dv.deform(volume, dv.Mesh(mesh.points, mesh.cells))),
        (ValueError, "2 components", lambda: dv.deform(volume, dv.Field(np.zeros((2, 2, 2, 2)), affine))),
        (ValueError, "outside", lambda: dv.deform(volume, mesh, outside="drop")),
        (ValueError, "interpolation", lambda: dv.deform(volume, mesh, interpolation="spline")),
        (ValueError, "bounds", lambda: dv.deform(volume, mesh, bounds="all")),
        (dv.Error, "ade", lambda: dv.deform(volume, mesh, outside="keep", fade_distance=float("nan"))),
        (ValueError, "background", lambda: dv.deform([volume, volume], mesh, background=[0.0])),
        (ValueError, "voxels", lambda: dv.deform([volume, volume[1:]], mesh)),
        (ValueError, "reference", lambda: dv.deform(volume, mesh, reference=dv.Grid((2, 2, 2), affine), padding=1)),
        (dv.Error, "", lambda: dv.deform(volume, mesh, device="no such device")),
        (ValueError, "no volume", lambda: DeformVolume()._prepare()),
        (AttributeError, "vtkDeformVolumeFilter", lambda: DeformVolume().SetSamplingFactor(2)),
    ):
        expect(kind, text, call)
    # The package works after errors.
    assert dv.deform(volume, mesh, bounds="volume").array.shape == (5, 6, 7)


def test_pipelines():
    image = make_image()
    mesh = bend(make_mesh(image, 5))
    compare("mesh", image, mesh)
    compare("cubic", image, mesh, Interpolation=1)
    compare("nearest", image, mesh, Interpolation=2)
    compare("bounds", image, mesh, OutputBoundsMode=1)
    compare("reference", image, mesh, reference=make_reference())
    # A mesh that folds.
    folded = vtkUnstructuredGrid()
    folded.DeepCopy(mesh)
    bend(folded, 3.0)
    extras = compare("extras", image, folded, GenerateRestPositions=True, GenerateJacobian=True, GenerateFoldCount=True)
    assert vtk_to_numpy(extras.GetPointData().GetArray("FoldCount")).max() > 1
    # A mesh in the middle of the volume.
    small = vtkUnstructuredGrid()
    small.DeepCopy(mesh)
    points = vtk_to_numpy(small.GetPoints().GetData())
    points[:] = points.mean(axis=0) + 0.5 * (points - points.mean(axis=0))
    for mode in range(3):
        compare(f"outside {mode}", image, small, OutsideMode=mode, FadeDistance=6.0)
        reference = make_reference()
        compare(f"outside {mode}, reference", image, small, reference=reference, OutsideMode=mode, FadeDistance=9.0)
    moved = vtkUnstructuredGrid()
    moved.DeepCopy(mesh)
    places = vtk_to_numpy(moved.GetPoints().GetData())
    places += vtk_to_numpy(mesh.GetPointData().GetVectors())
    compare("rest", image, moved, rest=mesh)
    straight = vtkRectilinearGrid()
    straight.SetDimensions(4, 5, 6)
    for axis, number in zip(range(3), straight.GetDimensions()):
        low, high = mesh.GetBounds()[2 * axis : 2 * axis + 2]
        positions = numpy_to_vtk(np.linspace(low, high, number), deep=True)
        getattr(straight, f"Set{'XYZ'[axis]}Coordinates")(positions)
    vectors = numpy_to_vtk(random.normal(size=(straight.GetNumberOfPoints(), 3)), deep=True)
    straight.GetPointData().SetVectors(vectors)
    compare("rectilinear grid", image, straight)
    curved = vtkStructuredGrid()
    curved.SetDimensions(straight.GetDimensions())
    points = np.array([straight.GetPoint(i) for i in range(straight.GetNumberOfPoints())], np.float32)
    made = vtkPoints()
    made.SetData(numpy_to_vtk(points + 0.1 * np.sin(points), deep=True))
    curved.SetPoints(made)
    curved.GetPointData().SetVectors(vectors)
    compare("structured grid", image, curved)
    curved.BlankCell(7)
    curved.BlankPoint(3)
    compare("structured grid with hidden cells", image, curved)
    explicit = vtkExplicitStructuredGrid()
    explicit.SetDimensions(straight.GetDimensions())
    explicit.SetPoints(made)
    append = vtkAppendFilter()
    append.SetInputData(straight)
    append.Update()
    # The nodes of hexahedra have another order than those of voxels.
    hexahedra = vtkCellArray()
    for cell in vtk_to_numpy(append.GetOutput().GetCells().GetConnectivityArray()).reshape(-1, 8):
        hexahedra.InsertNextCell(8, cell[[0, 1, 3, 2, 4, 5, 7, 6]].tolist())
    explicit.SetCells(hexahedra)
    explicit.GetPointData().SetVectors(vectors)
    compare("explicit structured grid", image, explicit)
    blocks = vtkMultiBlockDataSet()
    beside = vtkUnstructuredGrid()
    beside.DeepCopy(append.GetOutput())
    vtk_to_numpy(beside.GetPoints().GetData())[:] += (100.0, 0.0, 0.0)
    for number, block in enumerate((explicit, None, beside)):
        blocks.SetBlock(number, block)
    compare("blocks", image, blocks)
    compare("field", image, make_field(image, 6))
    compare("field, keep", image, make_field(image, 6), OutsideMode=2, FadeDistance=8.0)
    extras = {"GenerateRestPositions": True, "GenerateJacobian": True}
    compare("field, extras", image, make_field(image, 6), GenerateFoldCount=True, **extras)
    gaps = make_field(image, 6)
    ghosts = vtkUnsignedCharArray()
    ghosts.SetName("vtkGhostType")
    for number in range(216):
        ghosts.InsertNextValue(2 if number == 86 else 0)  # HIDDENPOINT
    gaps.GetPointData().AddArray(ghosts)
    gaps.GetPointData().GetVectors().SetTuple3(86, np.nan, 0.0, np.inf)
    valid = numpy_to_vtk((np.arange(216) != 7).astype(np.int8), deep=True)
    valid.SetName("vtkValidPointMask")
    gaps.GetPointData().AddArray(valid)
    hidden = vtkImageData()
    hidden.DeepCopy(image)
    hidden.AllocatePointGhostArray()
    hidden.GetPointGhostArray().SetValue(5000, 2)
    for mode in range(3):
        compare(f"field with gaps, {mode}", hidden, gaps, OutsideMode=mode, FadeDistance=9.0, **extras)
    compare("inverse field with gaps", hidden, gaps, FieldIsInverse=True, **extras)
    densities = ["values", "fractions"]
    for deformation in (mesh, gaps):
        compare("densities", image, deformation, densities=densities)
    compare("densities, inverse", image, gaps, densities=densities, FieldIsInverse=True, **extras)
    compare("inverse", image, make_field(image, 6), reference=make_reference(), FieldIsInverse=True, **extras)
    body = deformvolume_vtk.vtkFiniteElementDeformation()
    fixed = numpy_to_vtk((vtk_to_numpy(mesh.GetPoints().GetData())[:, 2] < 0).astype(np.uint8), deep=True)
    fixed.SetName("Fixed")
    mesh.GetPointData().AddArray(fixed)
    body.SetInputData(mesh)
    body.SetGravity(0.5, 0.0, 0.0)
    body.Update()
    compare("quadratic tetrahedra", image, body.GetOutput())

    # Masks of cuts and carvings.
    tool = vtkSphereSource()
    tool.SetRadius(9.0)
    tool.SetCenter(*image.GetCenter())
    for smooth in (False, True):
        carve = deformvolume_vtk.vtkCarveVolume()
        carve.SetInputData(image)
        carve.SetSurfaceConnection(tool.GetOutputPort())
        carve.BlankCellsOn()
        carve.SetSmoothBoundary(smooth)
        sheet = vtkPlaneSource()
        sheet.SetOrigin(-100.0, -100.0, image.GetCenter()[2])
        sheet.SetPoint1(100.0, -100.0, image.GetCenter()[2] + 3)
        sheet.SetPoint2(-100.0, image.GetCenter()[1], image.GetCenter()[2])
        cut = deformvolume_vtk.vtkCutVolume()
        cut.SetInputConnection(carve.GetOutputPort())
        cut.SetSheetConnection(sheet.GetOutputPort())
        cut.SetSmoothCut(smooth)
        cut.Update()
        edited = cut.GetOutput()
        assert cut.GetOutput().GetCellData().HasArray("ActiveTetrahedra")
        compare(f"edits {smooth}", edited, mesh)
    ghosts = vtkImageData()
    ghosts.DeepCopy(image)
    ghosts.AllocatePointGhostArray()
    ghosts.GetPointGhostArray().SetValue(5000, 2)
    ghosts.AllocateCellGhostArray()
    ghosts.GetCellGhostArray().SetValue(7000, 32)
    compare("ghosts", ghosts, mesh)
    valid = vtkCharArray()
    valid.SetName("vtkValidPointMask")
    valid.SetNumberOfValues(image.GetNumberOfPoints())
    valid.FillComponent(0, 1)
    valid.SetValue(6000, "\0")
    ghosts.GetPointData().AddArray(valid)
    compare("ghosts and invalid points", ghosts, mesh)
    compare("nothing", image, None)
    compare("nothing, reference", image, None, reference=make_reference())
    compare("nothing, reference, cubic", image, None, reference=make_reference(), Interpolation=1)

    # Several updates of the same filters.
    both = [DeformVolume(), Filter()]
    for one in both:
        one.SetInputDataObject(0, image)
        one.SetDeformationData(mesh)
    for amount in (0.1, 0.3, 0.3, 0.0):
        bend(mesh, amount)
        bits = []
        for one in both:
            one.Update()
            bits.append(vtk_to_numpy(one.GetOutputDataObject(0).GetPointData().GetArray("labels")).tobytes())
        assert bits[0] == bits[1], amount


def test_arrays():
    # The split of cells into tetrahedra depends on the parity of structured indices, here of an image that begins at an
    # odd index.
    image = make_image()
    first_index = image.GetExtent()[::2]
    mesh = bend(make_mesh(image, 5))
    deformer = Filter()
    deformer.SetInputData(image)
    deformer.SetDeformationData(mesh)
    deformer.AddCategoricalArray("labels")
    deformer.GenerateJacobianOn()
    deformer.Update()
    wanted = deformer.GetOutput()

    shape = image.GetDimensions()
    arrays = []
    for name in ("values", "fractions", "labels"):
        array = vtk_to_numpy(image.GetPointData().GetArray(name))
        arrays.append(array.reshape(shape[::-1] + array.shape[1:]).transpose((2, 1, 0, 3)[: array.ndim + 2]))
    affine = np.eye(4)
    affine[:3, :3] = TURNED * image.GetSpacing()
    affine[:3, 3] = image.GetOrigin()
    deformation = dv.Mesh(
        vtk_to_numpy(mesh.GetPoints().GetData()),
        vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 4),
        vtk_to_numpy(mesh.GetPointData().GetVectors()),
    )
    result = dv.deform(
        arrays, deformation, affine, categorical=[False, False, True], jacobian=True, first_index=first_index
    )
    assert result.array.shape == wanted.GetDimensions(), (result.array.shape, wanted.GetDimensions())
    assert result.counts["number_of_covered_voxels"] == result.coverage.sum() > 1000 and result.device
    origin = np.array(wanted.GetOrigin()) + TURNED @ (np.array(wanted.GetSpacing()) * wanted.GetExtent()[::2])
    assert np.allclose(result.affine[:3, 3], origin, rtol=0, atol=1e-10)
    for name, array in zip(("values", "fractions", "labels"), result.arrays):
        theirs = vtk_to_numpy(wanted.GetPointData().GetArray(name))
        ours = array.transpose((2, 1, 0, 3)[: array.ndim]).reshape(theirs.shape)
        # Values differ in a few voxels, because the origin in the affine is rounded.
        assert (ours == theirs).mean() > 0.99 and ours.dtype == theirs.dtype, (name, (ours == theirs).mean())

    # The result does not depend on the memory layout of an array. Arrays that can be used in place are not copied.
    first = arrays[0]
    assert np.shares_memory(dv._arrays.image(first, ""), first)
    for other in (
        np.ascontiguousarray(first),
        np.asfortranarray(first),
        np.ascontiguousarray(first[::-1])[::-1],
        first.astype(first.dtype.newbyteorder()),
    ):
        other.flags.writeable = False
        again = dv.deform(other, deformation, affine, first_index=first_index)
        assert again.array.tobytes() == result.arrays[0].tobytes()
    mask = arrays[0] > 2
    assert dv.deform(mask, deformation, affine, categorical=True).array.dtype == bool
    # Points and cells of other types.
    for points, cells in ((deformation.points.astype(float), deformation.cells.astype(np.int32)),):
        mesh = dv.Mesh(points, cells, deformation.displacements.astype(float))
        again = dv.deform(first, mesh, affine, first_index=first_index)
        assert again.array.tobytes() == result.arrays[0].tobytes()
    # Cells other than tetrahedra: a hexahedron that does not move.
    corners = np.array([[x, y, z] for z in (0, 1) for y, x in ((0, 0), (0, 1), (1, 1), (1, 0))], float)
    box = corners * [9.0, 9.0, 9.0]
    cube = random.normal(size=(10, 10, 10))
    still = dv.deform(cube, dv.Mesh(box, ([12], [list(range(8))]), np.zeros((8, 3))))
    assert np.array_equal(still.array, cube)


# A volume that becomes eight times as large, and a field with a gap.
def test_densities_and_gaps():
    grid = np.moveaxis(np.indices((3, 3, 3)), 0, 3)
    vectors = 4.0 * grid
    field = dv.Field(vectors, np.diag([4.0, 4.0, 4.0, 1.0]))
    for dtype, made in ((np.int16, np.float32), (bool, np.float32), (np.float64, np.float64)):
        dose = np.ones((9, 9, 9), dtype)
        options = {"bounds": (-1, 16, -1, 16, -1, 16), "background": 7.0}
        result = dv.deform([dose, dose], field, density=[True, False], **options)
        assert [array.dtype for array in result.arrays] == [made, dose.dtype]
        assert np.allclose(result.array, 0.125 * result.coverage) and 0 < result.coverage.mean() < 1
    assert np.allclose(result.arrays[1], np.where(result.coverage, 1.0, 7.0))
    expect(dv.Error, "categorical", lambda: dv.deform(dose, field, density=True, categorical=True))
    expect(TypeError, "density", lambda: dv.deform(dose, field, density="no"))
    vectors[1, 2, 2] = np.nan
    expect(dv.Error, "mark its point as undefined", lambda: dv.deform(dose, field))
    field.undefined = np.isnan(vectors).any(axis=3)
    # Voxels at rest are every second voxel of the output. Without a displacement they are not covered.
    gap, whole = dv.deform(dose, field, **options).coverage, result.coverage
    assert whole[3:16:2, 11::2, 11::2].all() and not gap[3:16:2, 11::2, 11::2].any()
    assert np.array_equal(gap[:, :10], whole[:, :10]) and np.array_equal(gap[:, :, :10], whole[:, :, :10])
    assert not dv.deform_points([[4.0, 8.0, 8.0]], field).valid[0]
    # Which voxels outside the field depend on an undefined point of its border changes with the outside mode.
    border = np.zeros((3, 3, 3), bool)
    border[2, 2, 2] = True
    edge = dv.Field(np.zeros((3, 3, 3, 3)), np.diag([4.0, 4.0, 4.0, 1.0]), undefined=border)
    kept, counts = dv.Deformer(), []
    kept.set_volume(np.ones((13, 13, 13)), np.eye(4))
    kept.set_deformation(edge)
    kept.set_output("volume")
    for outside in (("extrapolate",), ("keep", 1.0), ("discard",), ("extrapolate",)):
        kept.set_outside(*outside)
        counts.append(int(kept.deform().coverage.sum()))
    again = dv.deform(np.ones((13, 13, 13)), edge, bounds="volume", outside="keep", fade_distance=1.0)
    assert counts[1] == again.coverage.sum() > counts[0] == counts[3] > counts[2], counts
    field.undefined = field.undefined[:2]
    expect(ValueError, "must have the shape (3, 3, 3)", lambda: dv.deform(dose, field))


def test_progress_and_warnings():
    big = np.zeros((120, 120, 120), np.float32)
    field = dv.Field(random.normal(size=(4, 4, 4, 3)), np.diag([40.0, 40.0, 40.0, 1.0]))
    folding = dv.Field(30.0 * random.normal(size=(4, 4, 4, 3)), np.diag([40.0, 40.0, 40.0, 1.0]))
    for deformation in (field, folding):
        fractions = []
        deformed = dv.deform(big, deformation, progress=fractions.append)
        assert (deformed.counts["number_of_inverted_tetrahedra"] > 0) == (deformation is folding)
        assert fractions == sorted(fractions) and 0 < fractions[0] <= fractions[-2] < fractions[-1] == 1, fractions
    expect(KeyboardInterrupt, "", lambda: dv.deform(big, field, progress=lambda fraction: False))

    def fail(fraction):
        raise OverflowError("in the callback")

    expect(OverflowError, "in the callback", lambda: dv.deform(big, field, progress=fail))
    # A reference that the volume does not reach.
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        far = np.eye(4)
        far[:3, 3] = 1e4
        result = dv.deform(big, field, reference=dv.Grid((5, 5, 5), far), background=7.0)
    assert (result.array == 7.0).all() and not result.coverage.any()
    assert any(issubclass(one.category, dv.DeformationWarning) for one in caught)


def test_examples():
    for module in (dv, dv._deformer):
        failed, tried = doctest.testmod(module)
        assert failed == 0, failed
    assert tried > 0, tried


test_misuse()
test_pipelines()
test_arrays()
test_densities_and_gaps()
test_progress_and_warnings()
test_examples()
print("all tests passed")
