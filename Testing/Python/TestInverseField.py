# SPDX-License-Identifier: BSD-3-Clause
"""Tests FieldIsInverse: misuse first, then numbers, which are compared with an interpolation in numpy.
Cxx.TestReferenceImage and Cxx.TestExtraArrays compare affine fields with closed forms."""

import numpy as np

import deformvolume_vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkImageData

from reported import reported

Filter = deformvolume_vtk.vtkDeformVolumeFilter
random = np.random.default_rng(1)


def turn(axis, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = [other for other in range(3) if other != axis]
    matrix = np.eye(3)
    matrix[[i, j, i, j], [i, j, j, i]] = c, c, -s, s
    return matrix


class Grid:
    """The grid of the points of an image."""

    def __init__(self, extent, origin=(0, 0, 0), spacing=(1, 1, 1), direction=np.eye(3)):
        self.extent, self.origin = extent, np.array(origin, dtype=float)
        self.spacing, self.direction = spacing, direction
        self.matrix = direction * np.array(spacing)
        self.size = tuple(extent[2 * i + 1] - extent[2 * i] + 1 for i in range(3))

    def make_image(self, **arrays):
        image = vtkImageData()
        image.SetExtent(*self.extent)
        image.SetOrigin(*self.origin)
        image.SetSpacing(*self.spacing)
        image.SetDirectionMatrix(*self.direction.ravel())
        for name, values in arrays.items():
            flat = values.reshape(-1, 3) if values.ndim == 4 else values.ravel()
            made = numpy_to_vtk(flat, deep=True)
            made.SetName(name)
            image.GetPointData().AddArray(made)
        return image

    def get_points(self):
        """Returns the world coordinates of the points, as an array [z, y, x, axis]."""
        ranges = (np.arange(self.extent[2 * i], self.extent[2 * i + 1] + 1.0) for i in (2, 1, 0))
        index = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1)[..., ::-1]
        return index @ self.matrix.T + self.origin

    def to_index(self, points):
        """Returns continuous indices of points, counted from the first point of the grid."""
        first = np.array(self.extent[::2])
        return np.linalg.solve(self.matrix, (points - self.origin).reshape(-1, 3).T).T.reshape(
            points.shape) - first


def interpolate(values, index):
    """Returns trilinear interpolations of values. index: continuous indices, x first, which are clamped to the
    array."""
    size = np.array(values.shape[2::-1])
    inside = np.clip(index, 0, size - 1)
    low = np.minimum(np.floor(inside).astype(int), np.maximum(size - 2, 0))
    high = np.minimum(low + 1, size - 1)
    part = inside - low
    total = 0.0
    for corner in range(8):
        upper = [corner >> axis & 1 for axis in range(3)]
        at = [np.where(u, high[..., a], low[..., a]) for a, u in enumerate(upper)]
        weight = np.prod([part[..., a] if u else 1 - part[..., a] for a, u in enumerate(upper)],
                         axis=0)
        here = values[at[2], at[1], at[0]].astype(float)
        total = total + (weight[..., None] if here.ndim == 4 else weight) * here
    return total


def look_up(grid, values, field_grid, vectors, output, scale=1.0, extrapolate=False):
    """Returns for the points of the output's grid: values, the distance from the nearest border of the covered part
    in voxels (negative outside), and the index in the volume."""
    points = output.get_points()
    in_field = field_grid.to_index(points)
    index = grid.to_index(points + scale * interpolate(vectors, in_field))
    margin = np.minimum(index, np.array(grid.size) - 1 - index).min(axis=-1)
    if not extrapolate:
        margin = np.minimum(margin, np.minimum(
            in_field, np.array(field_grid.size) - 1 - in_field).min(axis=-1))
    return interpolate(values, index), margin, index


def get(image, name):
    array = vtk_to_numpy(image.GetPointData().GetArray(name))
    return array.reshape((*image.GetDimensions()[::-1], *array.shape[1:]))


def grid_of(image):
    direction = image.GetDirectionMatrix()
    matrix = [[direction.GetElement(i, j) for j in range(3)] for i in range(3)]
    return Grid(image.GetExtent(), image.GetOrigin(), image.GetSpacing(), np.array(matrix))


def make_filter(volume, field):
    deform = Filter()
    deform.SetInputData(volume)
    deform.SetDeformationData(field)
    deform.SetInputArrayToProcess(0, 1, 0, 0, "b")
    deform.FieldIsInverseOn()
    return deform


# A volume and a field with different grids.
grid = Grid((-4, 15, 3, 20, -1, 14), (5, -7, 11), (1.0, 1.4, 1.9), turn(2, 30) @ turn(0, -20))
middle = grid.get_points().reshape(-1, 3).mean(axis=0)
shape = grid.size[::-1]
arrays = {
    "single": random.normal(size=shape).astype(np.float32),
    "short": random.integers(-1000, 1000, size=shape, dtype=np.int16),
    "wide": random.integers(-10**6, 10**6, size=shape).astype(np.int32),
    "vectors": random.normal(size=(*shape, 3)),
    "label": random.integers(2**60, 2**62, size=shape, dtype=np.int64)}
volume = grid.make_image(**arrays)

field_grid = Grid((2, 12, 0, 9, -3, 8), (0, 0, 0), (3.5, 4.5, 4.0), turn(1, 50))
field_grid.origin += middle - field_grid.get_points().reshape(-1, 3).mean(axis=0)


def make_vectors(points, strength):
    p = (points - middle) / 10.0
    return strength * np.stack([np.sin(p[..., 1]) + 0.2 * p[..., 0], np.cos(p[..., 2] + p[..., 0]),
                                np.sin(p[..., 0] - p[..., 1]) - 0.3], axis=-1)


vectors = make_vectors(field_grid.get_points(), 2.0).astype(np.float32)
field = field_grid.make_image(b=vectors)

# Misuse: there is one error that says what to do. After that the same filter works.
deform = make_filter(volume, field)
messages = []


def observe(caller, event, text):
    messages.append(text)


observe.CallDataType = "string0"
deform.AddObserver(vtkCommand.ErrorEvent, observe)
deform.GetExecutive().AddObserver(vtkCommand.ErrorEvent, lambda caller, event: None)


def fails(expected):
    messages.clear()
    deform.Update()
    assert len(messages) == 1 and expected in messages[0], messages
    assert deform.GetOutput().GetNumberOfPoints() == 0, deform.GetOutput().GetNumberOfPoints()


deform.SetResampler(Filter.EXACT)
fails("Set Resampler to AUTOMATIC or MESH_RASTERIZATION")
deform.SetResampler(Filter.AUTOMATIC)
far = vtkImageData()
far.ShallowCopy(field)
far.SetOrigin(1e4, 0, 0)
deform.SetDeformationData(far)
fails("holds no voxel of the volume")
deform.SetDeformationData(field)
deform.SetDisplacementScale(1e6)
fails("16,383")
deform.SetDisplacementScale(1.0)


# Numbers. Rest coordinates are rounded to 2^-24 voxel, vectors and their products to single precision.
def compare(deform, vectors, scale=1.0, extrapolate=False, background=0.0):
    deform.Update()
    output = deform.GetOutput()
    assert deform.GetResamplerInUse() == Filter.MESH_RASTERIZATION
    covered = get(output, "vtkValidPointMask") != 0
    assert covered.sum() == deform.GetNumberOfCoveredVoxels(), (covered.sum(), deform.GetNumberOfCoveredVoxels())
    for name in ("single", "short", "wide", "vectors"):
        expected, margin, index = look_up(grid, arrays[name], field_grid, vectors, grid_of(output),
                                          scale, extrapolate)
        # Points up to 1/256 voxel outside the volume are covered.
        assert covered[margin > 1e-5].all() and not covered[margin < -1 / 128].any(), name
        values = get(output, name)
        assert (values[~covered] == background).all()
        largest = np.abs(arrays[name]).max()
        bound = 2e-5 * largest + (0 if arrays[name].dtype.kind == "f" else 0.5)
        inside = covered & (margin >= 0)
        assert np.abs(values - expected)[inside].max() <= bound, (
            name, np.abs(values - expected)[inside].max(), bound)
    nearest = np.rint(index).astype(int)
    clear = covered & (margin >= 0) & (np.abs(index - nearest) < 0.499).all(axis=-1)
    expected = arrays["label"][nearest[clear][:, 2], nearest[clear][:, 1], nearest[clear][:, 0]]
    assert np.array_equal(get(output, "label")[clear], expected)
    return output, covered


def check_bounds(deform, vectors, covered, **options):
    """Checks that the extent is that of the covered voxels: no plane at its border is background only, and a larger
    output covers no more voxels."""
    for axis in range(3):
        for plane in (0, -1):
            assert covered.take(plane, axis=axis).any(), (axis, plane)
    deform.SetPadding(20)
    _, padded = compare(deform, vectors, **options)
    assert padded.sum() == covered.sum(), (padded.sum(), covered.sum())
    deform.SetPadding(0)


deform.AddCategoricalArray("label")
output, covered = compare(deform, vectors)
assert covered.sum() > 2000 and not covered.all()
assert reported(deform, "Static mappings made") == 0, reported(deform, "Static mappings made")
assert deform.GetNumberOfInvertedTetrahedra() == 0, deform.GetNumberOfInvertedTetrahedra()
whole = vtkImageData()
whole.DeepCopy(output)
check_bounds(deform, vectors, covered)

# Another background, scale, spacing, mode of bounds.
deform.SetBackgroundValue(-7)
deform.SetDisplacementScale(0.5)
_, covered = compare(deform, vectors, scale=0.5, background=-7)
check_bounds(deform, vectors, covered, scale=0.5, background=-7)
deform.SetOutputSpacingModeToCustomSpacing()
deform.SetCustomSpacing(1.3, 0.9, 2.5)
_, covered = compare(deform, vectors, scale=0.5, background=-7)
check_bounds(deform, vectors, covered, scale=0.5, background=-7)
deform.SetOutputSpacingModeToVolumeSpacing()
deform.SetOutputBoundsModeToVolumeBounds()
output, _ = compare(deform, vectors, scale=0.5, background=-7)
assert output.GetExtent() == volume.GetExtent(), (output.GetExtent(), volume.GetExtent())
deform.SetOutputBoundsModeToCustomBounds()
deform.SetCustomBounds(*np.stack([middle - 4, middle + 5], axis=-1).ravel())
compare(deform, vectors, scale=0.5, background=-7)
deform.SetOutputBoundsModeToDeformedBounds()
deform.SetDisplacementScale(1.0)
deform.SetBackgroundValue(0)

# Voxels outside the field are discarded, or have the vector of its border.
deform.SetOutsideModeToExtrapolate()
_, covered = compare(deform, vectors, extrapolate=True)
check_bounds(deform, vectors, covered, extrapolate=True)
deform.SetOutsideModeToDiscard()

# A field that folds. Then the same object gets a field that does not.
strong = make_vectors(field_grid.get_points(), 25.0).astype(np.float32)
vtk_to_numpy(field.GetPointData().GetArray("b"))[:] = strong.reshape(-1, 3)
field.GetPointData().GetArray("b").Modified()
field.Modified()
_, covered = compare(deform, strong)
check_bounds(deform, strong, covered)
assert 0 < deform.GetNumberOfInvertedTetrahedra() < 5 * 10 * 9 * 11
vtk_to_numpy(field.GetPointData().GetArray("b"))[:] = vectors.reshape(-1, 3)
field.GetPointData().GetArray("b").Modified()
field.Modified()
output, _ = compare(deform, vectors)
for name in arrays:
    assert np.array_equal(get(output, name), get(whole, name)), name

# A field of zero gives the volume bit for bit, with linear and with cubic interpolation.
still = grid.make_image(b=np.zeros((*shape, 3)))
deform.SetDeformationData(still)
for interpolation in (Filter.LINEAR_INTERPOLATION, Filter.CUBIC_INTERPOLATION):
    deform.SetInterpolation(interpolation)
    deform.UpdateWholeExtent()
    assert deform.GetOutput().GetExtent() == volume.GetExtent(), (deform.GetOutput().GetExtent(), volume.GetExtent())
    for name, values in arrays.items():
        assert np.array_equal(get(deform.GetOutput(), name), values), name
    assert get(deform.GetOutput(), "vtkValidPointMask").all()

# A reflection inverts all tetrahedra of the field's grid, five for each cell. The fold count does not show that.
away = field_grid.get_points() - middle
mirror = field_grid.make_image(b=(-2.0 * away[..., :1]) * np.array([1.0, 0.0, 0.0]))
mirrored = make_filter(grid.make_image(single=arrays["single"]), mirror)
mirrored.GenerateJacobianOn()
mirrored.GenerateFoldCountOn()
mirrored.Update()
assert mirrored.GetNumberOfInvertedTetrahedra() == 5 * np.prod(np.array(field_grid.size) - 1)
covered = get(mirrored.GetOutput(), "vtkValidPointMask") != 0
assert np.array_equal(get(mirrored.GetOutput(), "FoldCount"), covered)
assert (get(mirrored.GetOutput(), "Jacobian")[covered] < 0.0).all()

# Hidden points have no value.
hidden = grid.make_image(single=arrays["single"])
ghosts = np.zeros(shape, dtype=np.uint8)
ghosts[8, 9, 10] = vtkDataSetAttributes.HIDDENPOINT
made = numpy_to_vtk(ghosts.ravel(), deep=True)
made.SetName("vtkGhostType")
hidden.GetPointData().AddArray(made)
masked = make_filter(hidden, field)
masked.Update()
_, margin, index = look_up(grid, arrays["single"], field_grid, vectors, grid_of(masked.GetOutput()))
covered = get(masked.GetOutput(), "vtkValidPointMask") != 0
near = (np.abs(index - (10, 9, 8)) < 0.999).all(axis=-1)
assert near.sum() > 2 and not covered[near].any()
assert covered[(margin > 1e-5) & (np.abs(index - (10, 9, 8)) > 1.001).any(axis=-1)].all()

# Tetrahedra that are switched off contain no sample.
def find_tetrahedra(index):
    """Returns for points of the volume which of the five tetrahedra of the cell contains it, and the distance from the
    nearest other tetrahedron."""
    cell = np.floor(index).astype(int)
    part = index - cell
    odd = (cell + np.array(grid.extent[::2])) % 2 == 1
    x, y, z = np.moveaxis(np.where(odd, 1 - part, part), -1, 0)
    # Distances behind the faces of the central tetrahedron.
    behind = np.stack([1 - (x + y + (1 - z)), 1 - ((1 - x) + (1 - y) + (1 - z)),
                       1 - ((1 - x) + y + z), 1 - (x + (1 - y) + z)], axis=-1)
    found = np.where(behind.max(axis=-1) > 0, behind.argmax(axis=-1), 4)
    clear = np.minimum(np.abs(behind).min(axis=-1), np.minimum(part, 1 - part).min(axis=-1))
    return cell, found, clear


switched = grid.make_image(single=arrays["single"])
active = random.integers(0, 32, size=[n - 1 for n in shape], dtype=np.uint8)
made = numpy_to_vtk(active.ravel(), deep=True)
made.SetName("ActiveTetrahedra")
switched.GetCellData().AddArray(made)
cut_open = make_filter(switched, field)
cut_open.SetOutputBoundsModeToVolumeBounds()
_, margin, index = look_up(grid, arrays["single"], field_grid, vectors, grid)
cell, found, clear = find_tetrahedra(index)
sure = (margin > 1e-5) & (clear > 0.01)
cut_open.Update()
covered = get(cut_open.GetOutput(), "vtkValidPointMask") != 0
at = cell[sure]
expected = active[at[:, 2], at[:, 1], at[:, 0]] >> found[sure] & 1
assert sure.sum() > 1000 and 0.3 < expected.mean() < 0.7
assert np.array_equal(covered[sure], expected == 1), (covered[sure] != expected).mean()
