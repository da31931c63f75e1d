# SPDX-License-Identifier: BSD-3-Clause
"""Makes registration.png beside this file. SimpleITK registers the head ch2 of the package mricron-data with a fixed
image: the same head, turned and bent, on a grid of its own. deform-volume applies the transforms to ch2.

Usage: build/readers/bin/python Documents/images/registration.py DEFORM_VOLUME

Testing/packages.sh readers installs SimpleITK in build/readers."""
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy
import SimpleITK as sitk

MOVING = "/usr/share/mricron/templates/ch2.nii.gz"
# Coordinates of SimpleITK: x to the left, y to the back, z to the head.
TURN = math.radians(14.0)
PUSHES = (  # where, by how much, and within which distance, in mm
    ((0.0, -80.0, -30.0), (0.0, -16.0, 0.0), 40.0),
    ((0.0, 50.0, 60.0), (0.0, -8.0, -14.0), 40.0),
    ((0.0, 60.0, -40.0), (0.0, -12.0, 4.0), 35.0),
)
PIXEL = 0.75  # mm in the picture


def make_fixed(moving):
    middle = numpy.array(moving.TransformContinuousIndexToPhysicalPoint([0.5 * n for n in moving.GetSize()]))
    places = sitk.GetArrayFromImage(
        sitk.PhysicalPointSource(sitk.sitkVectorFloat64, moving.GetSize(), moving.GetOrigin(),
                                 moving.GetSpacing(), moving.GetDirection()))
    vectors = numpy.zeros_like(places)
    for place, vector, radius in PUSHES:
        distance = numpy.linalg.norm(places - place, axis=-1, keepdims=True)
        vectors += numpy.exp(-((distance / radius) ** 2)) * vector
    bend = sitk.GetImageFromArray(vectors, isVector=True)
    bend.CopyInformation(moving)
    turn = sitk.Euler3DTransform(middle.tolist(), TURN, 0.0, 0.0, (0.0, 6.0, 4.0))
    grid = sitk.Image([165, 230, 185], moving.GetPixelID())
    grid.SetSpacing((1.1, 1.1, 1.1))
    grid.SetOrigin((middle - 0.55 * numpy.array(grid.GetSize())).tolist())
    way = sitk.CompositeTransform([turn, sitk.DisplacementFieldTransform(bend)])
    return sitk.Resample(moving, grid, way, sitk.sitkLinear, 0.0)


def resample_field(field, grid):
    return sitk.Resample(field, grid, useNearestNeighborExtrapolator=True)  # so that it does not jump to 0 at the border


def register(fixed, moving):
    """A rigid transform, and a displacement field for what it leaves. Both lead from the fixed to the moving image."""
    method = sitk.ImageRegistrationMethod()
    method.SetMetricAsMeanSquares()
    method.SetMetricSamplingStrategy(method.REGULAR)
    method.SetMetricSamplingPercentage(0.1)
    method.SetOptimizerAsRegularStepGradientDescent(1.0, 0.001, 200)
    method.SetOptimizerScalesFromPhysicalShift()
    method.SetShrinkFactorsPerLevel([4, 2])
    method.SetSmoothingSigmasPerLevel([2.0, 1.0])
    method.SetInterpolator(sitk.sitkLinear)
    method.SetInitialTransform(sitk.CenteredTransformInitializer(fixed, moving, sitk.Euler3DTransform()))
    rigid = method.Execute(fixed, moving)
    field = None
    for shrink, iterations in ((4, 100), (2, 60)):
        target, source = (sitk.SmoothingRecursiveGaussian(image, 0.5 * shrink) for image in (fixed, moving))
        target = sitk.Shrink(target, [shrink] * 3)
        source = sitk.Resample(source, target, rigid)
        demons = sitk.DiffeomorphicDemonsRegistrationFilter()
        demons.SetNumberOfIterations(iterations)
        demons.SetStandardDeviations(2.0)
        field = demons.Execute(target, source, *([] if field is None else [resample_field(field, target)]))
    field = resample_field(field, fixed)
    return rigid, sitk.DisplacementFieldTransform(sitk.Cast(field, sitk.sitkVectorFloat64))


def make_slice(image, threshold=None):
    """The middle slice from left to right, the face at the left; or the edges of what is above a threshold."""
    image = image[image.GetSize()[0] // 2, :, :]
    size = [int(n * of / PIXEL) for n, of in zip(image.GetSize(), image.GetSpacing())]
    image = sitk.Resample(image, size, sitk.Transform(), sitk.sitkLinear, image.GetOrigin(), [PIXEL] * 2)
    if threshold:
        return sitk.GetArrayFromImage(sitk.LabelContour(sitk.SmoothingRecursiveGaussian(image, 1.5) > threshold))[::-1]
    return sitk.GetArrayFromImage(sitk.Clamp(1.7 * image, sitk.sitkUInt8, 0, 255))[::-1]


def main(program):
    moving = sitk.ReadImage(MOVING, sitk.sitkFloat32)
    fixed = make_fixed(moving)
    rigid, bend = register(fixed, moving)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        sitk.WriteImage(fixed, folder / "fixed.nii.gz")
        sitk.WriteTransform(rigid, folder / "rigid.tfm")
        sitk.WriteTransform(bend, folder / "bend.h5")
        subprocess.run(
            [program, MOVING, "--transform", folder / "rigid.tfm", "--transform", folder / "bend.h5",
             "--reference", folder / "fixed.nii.gz", "--output", folder / "warped.nii.gz"], check=True)
        warped = sitk.ReadImage(folder / "warped.nii.gz", sitk.sitkFloat32)
    edges = make_slice(fixed, threshold=30.0)[..., None]
    panels = []
    for image, has_edges in ((sitk.Resample(moving, fixed), True), (fixed, False), (warped, True)):
        difference = numpy.abs(sitk.GetArrayFromImage(image - fixed)).mean()
        print(f"Mean difference from the fixed image: {difference:.1f}")
        panels.append(numpy.where(edges * has_edges, numpy.uint8((255, 140, 0)), make_slice(image)[..., None]))
    picture = sitk.GetImageFromArray(numpy.hstack(panels), isVector=True)
    sitk.WriteImage(picture, pathlib.Path(__file__).with_name("registration.png"), useCompression=True,
                    compressionLevel=9)


if __name__ == "__main__":
    main(sys.argv[1])
