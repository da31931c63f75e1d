# SPDX-License-Identifier: BSD-3-Clause
"""Run by a Python that has itk: writes a volume and inverse displacement fields with ITK's own writers,
and what its WarpImageFilter makes of them. Usage: ItkFields.py FOLDER"""
import os
import sys

import itk
import numpy

folder = sys.argv[1]
Vectors = itk.Image[itk.Vector[itk.F, 3], 3]
Values = itk.Image[itk.F, 3]


def turn(axis, degrees):
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    i, j = [other for other in range(3) if other != axis]
    matrix = numpy.eye(3)
    matrix[[i, j, i, j], [i, j, j, i]] = c, c, -s, s
    return matrix


def make(array, kind, origin, spacing, direction):
    image = itk.image_from_array(array, ttype=(kind,))
    image.SetOrigin([float(number) for number in origin])
    image.SetSpacing([float(number) for number in spacing])
    image.SetDirection(itk.matrix_from_array(direction))
    return image


def get_points(size, origin, spacing, direction):
    index = numpy.stack(numpy.meshgrid(*(numpy.arange(n) for n in reversed(size)), indexing="ij"),
                        axis=-1)[..., ::-1]
    return index @ (direction * numpy.array(spacing)).T + origin


random = numpy.random.default_rng(3)
size, spacing, direction = (20, 18, 16), (1.0, 1.3, 1.7), turn(2, 25) @ turn(0, -15)
origin = numpy.array([-12.0, 8.0, 3.0])
middle = get_points(size, origin, spacing, direction).reshape(-1, 3).mean(axis=0)
moving = make(random.normal(size=size[::-1]).astype(numpy.float32), Values, origin, spacing,
              direction)
itk.imwrite(moving, os.path.join(folder, "moving.nii.gz"))
itk.imwrite(moving, os.path.join(folder, "moving.mha"))

# On the voxels of the volume, as registration writes it, and on a lattice of its own.
coarse_direction = turn(1, 40)
coarse = [(11, 10, 9), numpy.zeros(3), (3.0, 3.5, 4.0), coarse_direction]
coarse[1] = middle - get_points(*coarse).reshape(-1, 3).mean(axis=0)
for name, (field_size, field_origin, field_spacing, field_direction) in (
        ("fine", (size, origin, spacing, direction)), ("coarse", coarse)):
    p = (get_points(field_size, field_origin, field_spacing, field_direction) - middle) / 8
    vectors = 1.5 * numpy.stack([numpy.sin(p[..., 1]) + 0.5, numpy.cos(p[..., 2] + p[..., 0]),
                                 numpy.sin(p[..., 0] - p[..., 1]) - 0.3], axis=-1)
    field = make(vectors.astype(numpy.float32), Vectors, field_origin, field_spacing, field_direction)
    for suffix in ("nii.gz", "nii", "mha", "mhd", "nrrd", "nhdr"):
        itk.imwrite(field, os.path.join(folder, f"{name}.{suffix}"))
    itk.imwrite(field, os.path.join(folder, f"{name}-zip.nrrd"), compression=True)
    itk.imwrite(field, os.path.join(folder, f"{name}-zip.mha"), compression=True)
    field["intent_code"] = "1006"
    itk.imwrite(field, os.path.join(folder, f"{name}-1006.nii.gz"))

    # The field is evaluated at the voxels of the output, here those of the volume.
    resampler = itk.WarpImageFilter[Values, Values, Vectors].New()
    resampler.SetInput(moving)
    resampler.SetDisplacementField(field)
    resampler.SetOutputParametersFromImage(moving)
    resampler.SetEdgePaddingValue(-100.0)
    resampler.Update()
    numpy.save(os.path.join(folder, f"{name}.npy"), itk.array_from_image(resampler.GetOutput()))
