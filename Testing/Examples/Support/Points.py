# SPDX-License-Identifier: BSD-3-Clause
"""Usage, with a Python that has SimpleITK:
Points.py make FOLDER writes transforms for the volumes of Maps.py.
Points.py check FOLDER TRANSFORM BEFORE AFTER checks that TRANSFORM maps the points AFTER to BEFORE.
Points.py field FOLDER FIELD BEFORE AFTER LIMIT checks the same for a displacement field.
Points are LPS, in files of numpy."""
import os
import sys

import numpy
import SimpleITK as sitk
from Rotation import turn


def make(folder):
    def read(name):
        return sitk.ReadImage(os.path.join(folder, name))

    moving, fixed = read("moving.mha"), read("fixed.mha")
    middle = moving.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in moving.GetSize()])
    affine = sitk.AffineTransform(3)
    affine.SetMatrix((turn(1, 8) @ numpy.diag([1.05, 0.96, 1.02])).ravel().tolist())
    affine.SetCenter(middle)
    affine.SetTranslation((1.5, -2.0, 0.7))
    sitk.WriteTransform(affine, os.path.join(folder, "affine.tfm"))
    # This field is trilinear on the grid of the fixed image, where the program samples it. So is its composition with a
    # matrix.
    x, y, z = numpy.meshgrid(*(numpy.arange(n) for n in fixed.GetSize()), indexing="ij")
    vectors = numpy.stack([1.5 * numpy.sin(0.3 * y), numpy.cos(0.25 * x), 1.2 * numpy.sin(0.2 * (x + z))], axis=-1)
    field = sitk.GetImageFromArray(vectors.transpose(2, 1, 0, 3), isVector=True)
    field.CopyInformation(fixed)
    both = sitk.CompositeTransform([affine, sitk.DisplacementFieldTransform(field)])
    sitk.WriteTransform(both, os.path.join(folder, "both.h5"))
    # A forward field, which is linear.
    x, y, z = numpy.meshgrid(*(numpy.arange(n) for n in moving.GetSize()), indexing="ij")
    vectors = numpy.stack([0.1 * x - 0.05 * z, 0.03 * x + 0.08 * y - 1, 2 - 0.07 * y], axis=-1)
    linear = sitk.GetImageFromArray(vectors.transpose(2, 1, 0, 3), isVector=True)
    linear.CopyInformation(moving)
    sitk.WriteImage(linear, os.path.join(folder, "linear.mha"))
    # A grid that is fine enough to sample a spline.
    fine = sitk.Image([128, 128, 128], sitk.sitkUInt8)
    fine.SetSpacing((0.25, 0.25, 0.25))
    fine.SetOrigin([m - 0.125 * 127 for m in middle])
    sitk.WriteImage(fine, os.path.join(folder, "fine.nii.gz"), True)
    spline = sitk.BSplineTransformInitializer(fine, (2, 2, 2), 3)
    random = numpy.random.default_rng(6)
    spline.SetParameters(random.normal(scale=1.5, size=len(spline.GetParameters())).tolist())
    sitk.WriteTransform(spline, os.path.join(folder, "spline.h5"))


def check(folder, transform, before, after, limit):
    before, after = (numpy.load(os.path.join(folder, name)) for name in (before, after))
    assert len(before) == len(after) > 30, (before.shape, after.shape)
    moved = numpy.linalg.norm(after - before, axis=1).max()
    assert moved > 1, f"expected a point that moves by more than 1, but the largest movement is {moved}"
    back = numpy.array([transform.TransformPoint(point.tolist()) for point in after])
    wrong = numpy.linalg.norm(back - before, axis=1).max()
    print(f"largest error {wrong}, allowed is {limit}")
    assert wrong < limit, wrong


if sys.argv[1] == "make":
    make(sys.argv[2])
elif sys.argv[1] == "check":
    check(sys.argv[2], sitk.ReadTransform(os.path.join(*sys.argv[2:4])), *sys.argv[4:], 1e-3)
else:
    image = sitk.Cast(sitk.ReadImage(os.path.join(*sys.argv[2:4])), sitk.sitkVectorFloat64)
    check(sys.argv[2], sitk.DisplacementFieldTransform(image), *sys.argv[4:6], float(sys.argv[6]))
