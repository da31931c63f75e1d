# SPDX-License-Identifier: BSD-3-Clause
"""Writes volumes, transforms, and the volumes resampled by these transforms with SimpleITK.
Usage, with a Python that has SimpleITK: Transforms.py FOLDER"""
import os
import sys

import numpy
import SimpleITK as sitk
from Rotation import turn

folder = sys.argv[1]


def path(name):
    return os.path.join(folder, name)


# A rotated volume of random values, with which a test notices any exchange of axes.
random = numpy.random.default_rng(5)
size, spacing = (26, 22, 18), (1.0, 1.3, 1.7)
direction = turn(2, 25) @ turn(0, -15)
moving = sitk.GetImageFromArray(random.normal(size=size[::-1]).astype(numpy.float32))
moving.SetSpacing(spacing)
moving.SetOrigin((-12.0, 8.0, 3.0))
moving.SetDirection(direction.ravel().tolist())
values = sitk.GetArrayViewFromImage(moving)
assert max(numpy.abs(numpy.diff(values, axis=axis)).max() for axis in range(3)) < 7
for name in ("moving.nii.gz", "moving.mha", "moving.nrrd"):
    sitk.WriteImage(moving, path(name))
# Each voxel has a label of its own.
labels = sitk.GetImageFromArray(random.permutation(values.size).astype(numpy.int32).reshape(values.shape) + 1)
labels.CopyInformation(moving)
for name in ("labels.nii.gz", "labels.mha"):
    sitk.WriteImage(labels, path(name))
middle = moving.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in size])


def make_fixed(turned, spacing):
    """Returns an image of another size with the same center."""
    image = sitk.Image([20, 24, 19], sitk.sitkInt16)
    image.SetSpacing(spacing)
    image.SetDirection(turned.ravel().tolist())
    half = image.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in image.GetSize()])
    image.SetOrigin([m - h + 1.25 for m, h in zip(middle, half)])
    return image


fixed = {"fixed": make_fixed(turn(0, 35) @ turn(1, -20), (1.2, 0.9, 1.5)),
         "mirrored": make_fixed(turn(2, 65) @ numpy.diag([1.0, -1.0, 1.0]), (1.1, 1.4, 0.8))}
for name, image in fixed.items():
    sitk.WriteImage(image, path(name + ".nii.gz"))
    sitk.WriteImage(image, path(name + ".mha"))

affine = sitk.AffineTransform(3)
affine.SetMatrix((turn(1, 8) @ numpy.diag([1.05, 0.96, 1.02])).ravel().tolist())
affine.SetCenter(middle)
affine.SetTranslation((1.5, -2.0, 0.7))

# ITK reads the center of a versor, but does not apply it.
versor = sitk.VersorTransform((1.0, 2.0, 3.0), 0.3, middle)

euler = sitk.Euler3DTransform(middle, 0.1, -0.05, 0.2, (0.5, 1.0, -1.5))

spline = sitk.BSplineTransformInitializer(moving, (5, 4, 4), 3)
parameters = random.normal(scale=1.5, size=len(spline.GetParameters()))
spline.SetParameters(parameters.tolist())
quadratic = sitk.BSplineTransformInitializer(moving, (5, 4, 4), 2)
quadratic.SetParameters(random.normal(scale=1.5, size=len(quadratic.GetParameters())).tolist())


def make_field():
    """Returns a displacement field on a coarse grid that does not cover the whole volume."""
    image = sitk.Image([9, 8, 7], sitk.sitkVectorFloat64, 3)
    image.SetSpacing((3.0, 3.2, 3.5))
    image.SetDirection(turn(1, 30).ravel().tolist())
    image.SetOrigin((0.0, 0.0, 0.0))
    half = image.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in image.GetSize()])
    image.SetOrigin([m - h for m, h in zip(middle, half)])
    vectors = random.normal(size=(7, 8, 9, 3))
    assert max(numpy.abs(numpy.diff(vectors, axis=axis)).max() for axis in range(3)) < 7
    values = sitk.GetImageFromArray(vectors, isVector=True)
    values.CopyInformation(image)
    return values


field = make_field()
sitk.WriteImage(sitk.Cast(field, sitk.sitkVectorFloat32), path("warp.nii.gz"))
sitk.WriteImage(field, path("warp.mha"))
displacement = sitk.DisplacementFieldTransform(sitk.Image(field))

composite = sitk.CompositeTransform([affine, displacement])
nested = sitk.CompositeTransform([euler, spline])

rotations = sitk.CompositeTransform([versor, euler])

transforms = {"affine": affine, "versor": versor, "euler": euler, "spline": spline, "quadratic": quadratic,
              "displacement": displacement, "composite": composite, "nested": nested, "rotations": rotations}
for name, transform in transforms.items():
    for suffix in ("h5", "tfm", "txt", "mat"):
        try:
            sitk.WriteTransform(transform, path(f"{name}.{suffix}"))
            sitk.ReadTransform(path(f"{name}.{suffix}"))
        except RuntimeError:
            # This format cannot store the transform, or ITK cannot read the file.
            if os.path.exists(path(f"{name}.{suffix}")):
                os.remove(path(f"{name}.{suffix}"))
# The type that c3d_affine_tool writes.
with open(path("affine.tfm"), encoding="ascii") as file:
    text = file.read()
with open(path("c3d.txt"), "w", encoding="ascii") as file:
    file.write(text.replace("AffineTransform_", "MatrixOffsetTransformBase_"))
planar = sitk.AffineTransform(2)
sitk.WriteTransform(planar, path("planar.tfm"))

expected = dict(transforms)
expected["affine,invert"] = affine.GetInverse()
# A composite transform applies its last transform first.
expected["euler+affine"] = sitk.CompositeTransform([euler, affine])
expected["affine,invert+warp"] = sitk.CompositeTransform([affine.GetInverse(), displacement])
expected["warp+affine"] = sitk.CompositeTransform([displacement, affine])
nothing = -1000.0


def add(key, transform, grid):
    resampled = sitk.Resample(moving, grid, transform, sitk.sitkLinear, nothing)
    results[key] = sitk.GetArrayFromImage(resampled)
    # Depth of each transformed voxel inside the volume, in voxels. Where it is negative, ITK repeats the border.
    index = numpy.stack(numpy.meshgrid(*(numpy.arange(n) for n in grid.GetSize()), indexing="ij"),
                        axis=-1)
    reached = numpy.array([moving.TransformPhysicalPointToContinuousIndex(transform.TransformPoint(
        grid.TransformIndexToPhysicalPoint(voxel))) for voxel in index.reshape(-1, 3).tolist()])
    depth = numpy.minimum(reached, numpy.array(size) - 1 - reached).min(axis=-1)
    results["depth of " + key] = depth.reshape(grid.GetSize()).T
    resampled = sitk.Resample(labels, grid, transform, sitk.sitkNearestNeighbor, 0)
    results["labels of " + key] = sitk.GetArrayFromImage(resampled)
    # Distance of each point from the next point with another nearest voxel.
    margin = numpy.abs(reached - numpy.floor(reached) - 0.5).min(axis=-1)
    results["margin of " + key] = margin.reshape(grid.GetSize()).T


results = {}
for name, transform in expected.items():
    add(name, transform, moving)
for grid_name, grid in fixed.items():
    for name in ("affine", "spline", "warp+affine"):
        add(f"{name} on {grid_name}", expected[name], grid)
    results["origin of " + grid_name] = numpy.array(grid.GetOrigin())
numpy.savez(path("expected.npz"), **results)
