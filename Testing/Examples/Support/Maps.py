# SPDX-License-Identifier: BSD-3-Clause
"""Usage, with a Python that has SimpleITK:
Maps.py make FOLDER writes volumes.
Maps.py check FOLDER VOLUME RESULT FIELD JACOBIAN BACKGROUND compares VOLUME, resampled by FIELD, with RESULT, and the
Jacobian determinant of FIELD with JACOBIAN."""
import os
import sys

import numpy
import SimpleITK as sitk
from Rotation import turn


def make(folder):
    size = (40, 36, 32)
    x, y, z = numpy.meshgrid(*(numpy.arange(n) for n in size), indexing="ij")
    values = (0.7 * x - 0.4 * y + 1.1 * z + 60).T
    image = sitk.GetImageFromArray(values.astype(numpy.float32))
    image.SetSpacing((1.0, 1.3, 1.7))
    image.SetOrigin((-12.0, 8.0, 3.0))
    image.SetDirection((turn(2, 25) @ turn(0, -15)).ravel().tolist())
    for name in ("moving.nii.gz", "moving.mha", "moving.nrrd"):
        sitk.WriteImage(image, os.path.join(folder, name))
    # A forward field, which is smooth, and zero at the border of the volume.
    bump = (numpy.sin(numpy.pi * x / 39) * numpy.sin(numpy.pi * y / 35) * numpy.sin(numpy.pi * z / 31)) ** 2
    vectors = numpy.stack([4 * bump * numpy.sin(0.2 * y), -3 * bump * numpy.cos(0.15 * x), 3 * bump], axis=-1)
    field = sitk.GetImageFromArray(vectors.transpose(2, 1, 0, 3).astype(numpy.float32), isVector=True)
    field.CopyInformation(image)
    sitk.WriteImage(field, os.path.join(folder, "forward.mha"))
    fixed = sitk.Image([30, 34, 29], sitk.sitkInt16)
    fixed.SetSpacing((1.2, 0.9, 1.5))
    fixed.SetDirection((turn(0, 35) @ turn(1, -20) @ numpy.diag([1.0, -1.0, 1.0])).ravel().tolist())
    half = fixed.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in fixed.GetSize()])
    middle = image.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in size])
    fixed.SetOrigin([m - h for m, h in zip(middle, half)])
    sitk.WriteImage(fixed, os.path.join(folder, "fixed.mha"))


def check(folder, volume, result, field, jacobian, background):
    def read(name):
        return sitk.ReadImage(os.path.join(folder, name))

    moving, result, field, jacobian = read(volume), read(result), read(field), read(jacobian)
    assert field.GetSize() == result.GetSize() == jacobian.GetSize()
    for image in (result, jacobian):
        assert numpy.allclose(image.GetOrigin(), field.GetOrigin(), atol=1e-4), (image.GetOrigin(), field.GetOrigin())
        directions = image.GetDirection(), field.GetDirection()
        assert numpy.allclose(*directions, atol=1e-6), directions
    field = sitk.Cast(field, sitk.sitkVectorFloat64)
    # The Jacobian determinant of the position at rest with respect to the index. SimpleITK's filter cannot be used,
    # because it ignores the direction of the image.
    vectors = sitk.GetArrayFromImage(field)
    steps = numpy.array(field.GetDirection()).reshape(3, 3) * numpy.array(field.GetSpacing())
    changes = numpy.stack([numpy.gradient(vectors, axis=axis) for axis in (2, 1, 0)], axis=-1)
    expected = numpy.linalg.det(steps + changes) / numpy.linalg.det(steps)
    transform = sitk.DisplacementFieldTransform(sitk.Image(field))
    resampled = sitk.GetArrayFromImage(
        sitk.Resample(moving, result, transform, sitk.sitkLinear, float(background)))
    values = sitk.GetArrayFromImage(result)
    covered = values != float(background)
    assert covered.sum() > 10000, covered.sum()
    # Voxels whose derivatives need no difference beyond the border.
    inner = numpy.zeros_like(covered)
    inner[1:-1, 1:-1, 1:-1] = covered[1:-1, 1:-1, 1:-1]
    for axis in range(3):
        for step in (-1, 1):
            inner &= numpy.roll(covered, step, axis)
    # The volume is linear, so both programs interpolate it without an error, apart from the single precision of
    # positions.
    wrong = numpy.abs(values - resampled)[inner].max()
    assert wrong < 1e-3, wrong
    # Positions are rounded, with an error of at most 1/512 voxel, and derivatives are differences of these positions.
    ratio = (expected * sitk.GetArrayFromImage(jacobian))[inner]
    assert numpy.abs(ratio - 1).max() < 0.03 and abs(ratio.mean() - 1) < 0.002, (ratio.min(), ratio.max())
    jacobians = sitk.GetArrayFromImage(jacobian)[inner]
    assert jacobians.min() < 0.9 and jacobians.max() > 1.1, (jacobians.min(), jacobians.max())
    assert (vectors[~covered] == 0).all(), "vectors of voxels that are not covered must be 0"


if sys.argv[1] == "make":
    make(sys.argv[2])
else:
    check(*sys.argv[2:])
