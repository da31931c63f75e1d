# SPDX-License-Identifier: BSD-3-Clause
"""Volumes and displacement fields of SimpleITK."""

import numpy
import SimpleITK

from . import _arrays, _deformer


def _check_image(image, what: str) -> None:
    if not isinstance(image, SimpleITK.Image):
        raise TypeError(f"{what} is a {type(image).__name__}. Give a SimpleITK.Image.")
    # SimpleITK ends the process if numpy reads a label map.
    if "label" in image.GetPixelIDTypeAsString():
        raise TypeError(f"{what} is a label map. Convert it with SimpleITK.LabelMapToLabel().")


def _grid_of(image, what: str) -> "_deformer._structs.Grid":
    _check_image(image, what)
    size = image.GetSize()
    if len(size) != 3:
        raise ValueError(f"{what} has {len(size)} dimensions. It must have 3.")
    extent = [0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1]
    return _deformer.make_grid(extent, image.GetOrigin(), image.GetSpacing(), image.GetDirection())


def _read_field(field):
    """Returns an image of displacements, and its vectors with the axes z, y, x and an axis of components."""
    if isinstance(field, SimpleITK.Transform):
        try:
            field = SimpleITK.DisplacementFieldTransform(field).GetDisplacementField()
        except RuntimeError as error:
            raise TypeError(
                f"The transform is of the type {field.GetName()}. Give a DisplacementFieldTransform, "
                "or the image that SimpleITK.TransformToDisplacementField() makes of the transform."
            ) from error
    _check_image(field, "The displacement field")
    vectors = numpy.ascontiguousarray(SimpleITK.GetArrayViewFromImage(field))
    if vectors.ndim != 4 or vectors.shape[3] != 3:
        raise ValueError(
            f"The displacement field has {field.GetDimension()} dimensions and pixels of "
            f"{field.GetNumberOfComponentsPerPixel()} components. It must have three dimensions and "
            "vectors of three components."
        )
    if vectors.dtype not in (numpy.float32, numpy.float64):
        vectors = vectors.astype(numpy.float64)
    return field, vectors


def make_field(field, inverse: bool = True) -> "_deformer.Field":
    """Returns a displacement field of SimpleITK as a deformvolume.Field, for instance for deform_points().

    Args:
        field: an image of vectors of three components, in mm, or a DisplacementFieldTransform.
        inverse: see deform().

    Landmarks of SimpleITK and the result are in the same world coordinates (LPS).
    """
    image, vectors = _read_field(field)
    affine = _arrays.join_affine(image.GetOrigin(), image.GetSpacing(), image.GetDirection())
    # The vectors are in the memory of the image, which the Field does not keep.
    return _deformer.Field(_arrays.from_image(vectors.copy()), affine, inverse)


def deform(
    image: "SimpleITK.Image",
    deformation,
    *,
    reference: "SimpleITK.Image" = None,
    categorical: bool = False,
    background: float = 0.0,
    density: bool = False,
    outside: str = "discard",
    fade_distance: float = 0.0,
    interpolation: str = "linear",
    device: str = "",
    inverse: bool = True,
) -> "SimpleITK.Image":
    """Deforms an image of SimpleITK.

    Args:
        image: three dimensions, pixels of any number type, scalars or vectors.
        deformation: a SimpleITK image of vectors of three components, in mm; a DisplacementFieldTransform, whose
            vectors are interpolated linearly, also if it has another interpolator; or a deformvolume.Mesh or Field, in
            the world coordinates of the image (LPS).
        inverse: the direction of a field of SimpleITK. True (default): from the output to the image, as in
            registrations and SimpleITK.Resample. False: from the image to the deformed image. Outside the field,
            outside="keep" keeps the image as it is; SimpleITK.Resample does so from half a voxel outside the field.
        reference: an image with the grid of the output; None: the grid of the image with an inverse field, otherwise a
            grid that holds the deformed image.
        categorical, background, density, outside, fade_distance, interpolation, device: see deformvolume.deform().

    Returns:
        SimpleITK.Image: the deformed image, of the same pixel type, or of floats for a density, without the metadata of
            the image.
    """
    _check_image(image, "The image")
    with _deformer.Deformer(device) as deformer:
        pixels = numpy.ascontiguousarray(_arrays.native(SimpleITK.GetArrayViewFromImage(image), "The image"))
        deformer._set_volume_grid(_grid_of(image, "The image"), [pixels], categorical, background, density)
        if isinstance(deformation, (SimpleITK.Image, SimpleITK.Transform)):
            field, vectors = _read_field(deformation)
            is_inverse = inverse
            deformer._set_field_grid(_grid_of(field, "The displacement field"), vectors, is_inverse)
        else:
            is_inverse = isinstance(deformation, _deformer.Field) and deformation.inverse
            deformer.set_deformation(deformation)
        deformer.set_outside(outside, fade_distance)
        if reference is not None:
            deformer._set_reference_grid(_grid_of(reference, "The reference"))
        elif is_inverse:
            deformer._set_reference_grid(_grid_of(image, "The image"))
        deformed = deformer.deform(interpolation=interpolation)
        grid = deformer._find_output_grid()
    array = deformed.array.transpose((2, 1, 0, 3)[: deformed.array.ndim])
    is_vector = "vector" in image.GetPixelIDTypeAsString()
    if is_vector and array.ndim == 3:  # SimpleITK gives no axis to a single component
        array = array[..., numpy.newaxis]
    result = SimpleITK.GetImageFromArray(array, isVector=is_vector)
    result.SetOrigin(deformed.affine[:3, 3].tolist())
    result.SetSpacing(grid.spacing[:])
    result.SetDirection(grid.direction[:])
    return result
