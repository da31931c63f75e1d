# SPDX-License-Identifier: BSD-3-Clause
"""Writes a volume, inverse displacement fields, and the volume resampled by these fields, with SimpleITK.
Usage, with the Python that "Testing/packages.sh readers" installs: ItkFields.py FOLDER"""
import os
import sys

import nibabel
import numpy
import SimpleITK
from Rotation import turn

folder = sys.argv[1]


def path(name):
    return os.path.join(folder, name)


def make(array, origin, spacing, direction):
    image = SimpleITK.GetImageFromArray(array, isVector=array.ndim == 4)
    image.SetOrigin([float(number) for number in origin])
    image.SetSpacing([float(number) for number in spacing])
    image.SetDirection(direction.ravel())
    return image


def get_points(size, origin, spacing, direction):
    index = numpy.stack(numpy.meshgrid(*(numpy.arange(n) for n in reversed(size)), indexing="ij"),
                        axis=-1)[..., ::-1]
    return index @ (direction * numpy.array(spacing)).T + origin


random = numpy.random.default_rng(3)
size, spacing, direction = (20, 18, 16), (1.0, 1.3, 1.7), turn(2, 25) @ turn(0, -15)
origin = numpy.array([-12.0, 8.0, 3.0])
middle = get_points(size, origin, spacing, direction).reshape(-1, 3).mean(axis=0)
moving = make(random.normal(size=size[::-1]).astype(numpy.float32), origin, spacing, direction)
SimpleITK.WriteImage(moving, path("moving.nii.gz"))
SimpleITK.WriteImage(moving, path("moving.mha"))

# One field has a vector for each voxel of the volume, as registration programs write it, and one has another grid.
coarse_direction = turn(1, 40)
coarse = [(11, 10, 9), numpy.zeros(3), (3.0, 3.5, 4.0), coarse_direction]
coarse[1] = middle - get_points(*coarse).reshape(-1, 3).mean(axis=0)
for name, (field_size, field_origin, field_spacing, field_direction) in (
        ("fine", (size, origin, spacing, direction)), ("coarse", coarse)):
    p = (get_points(field_size, field_origin, field_spacing, field_direction) - middle) / 8
    vectors = 1.5 * numpy.stack([numpy.sin(p[..., 1]) + 0.5, numpy.cos(p[..., 2] + p[..., 0]),
                                 numpy.sin(p[..., 0] - p[..., 1]) - 0.3], axis=-1)
    field = make(vectors.astype(numpy.float32), field_origin, field_spacing, field_direction)
    for suffix in ("nii.gz", "nii", "mha", "mhd", "nrrd", "nhdr"):
        SimpleITK.WriteImage(field, path(f"{name}.{suffix}"))
    SimpleITK.WriteImage(field, path(f"{name}-zip.nrrd"), useCompression=True)
    SimpleITK.WriteImage(field, path(f"{name}-zip.mha"), useCompression=True)
    # A third form has the world RAS, as fMRIPrep and other programs write fields.
    lps = nibabel.load(path(f"{name}.nii"))
    ras = nibabel.Nifti1Image(lps.get_fdata(dtype=numpy.float32) * numpy.float32([-1, -1, 1]), lps.affine)
    ras.header.set_intent(1006)
    nibabel.save(ras, path(f"{name}-1006.nii.gz"))

    # SimpleITK evaluates the field at the voxels of the output, whose grid is here that of the volume.
    transform = SimpleITK.DisplacementFieldTransform(SimpleITK.Cast(field, SimpleITK.sitkVectorFloat64))
    resampled = SimpleITK.Resample(moving, moving, transform, SimpleITK.sitkLinear, -100.0)
    warp = SimpleITK.WarpImageFilter()
    warp.SetOutputParameteresFromImage(moving)
    warp.SetEdgePaddingValue(-100.0)
    warped = SimpleITK.GetArrayFromImage(warp.Execute(moving, field))
    resampled = SimpleITK.GetArrayFromImage(resampled)
    # Outside the field, DisplacementFieldTransform has no displacement, and WarpImageFilter has the nearest one.
    index = (get_points(size, origin, spacing, direction) - field_origin) @ numpy.linalg.inv(
        field_direction * numpy.array(field_spacing)).T
    inside = ((index > -1e-3) & (index < numpy.array(field_size) - 0.999)).all(axis=-1)
    assert numpy.abs(warped - resampled)[inside & (resampled != -100) & (warped != -100)].max() < 1e-4
    numpy.save(path(f"{name}.npy"), numpy.where(inside, resampled, -100))
