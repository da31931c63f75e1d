# SPDX-License-Identifier: BSD-3-Clause
"""`image.deformvolume.deform(mesh)` for pyvista's images, which this module registers, and deform_points()."""

from collections.abc import Iterable

import numpy
import pyvista
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPointSet

from .vtk import DeformVolume


@pyvista.register_dataset_accessor("deformvolume", pyvista.ImageData) if hasattr(
    pyvista, "register_dataset_accessor"
) else (lambda accessor: accessor)
class DeformVolumeAccessor:
    """Deforms the image: see deform()."""

    def __init__(self, image):
        self._image = image

    def deform(self, deformation, *, vectors=None, rest=None, reference=None, categorical=(), density=(), **properties):
        """Deforms the image by a mesh or a displacement field.

        Args:
            deformation: a mesh (pyvista.UnstructuredGrid, StructuredGrid, ExplicitStructuredGrid, RectilinearGrid or a
                MultiBlock of these) with displacements of its points, or pyvista.ImageData with vectors.
            vectors: the name of the array; None: the active vectors, or the only array of three components that is
                neither normals nor of unsigned char.
            rest: the mesh at rest. The points of the deformation are then deformed positions.
            reference: an image with the grid of the output.
            categorical: names of arrays of labels, which are not interpolated.
            density: names of arrays of amounts per unit of volume, see DeformVolume.AddDensityArray().
            properties: properties of DeformVolume, such as OutsideMode=DeformVolume.KEEP.

        Returns:
            pyvista.ImageData: its extent begins at 0. Point arrays are deformed; those of bool become uint8, as VTK
            has no bool. Cell arrays are left out, with a warning.

        Warns:
            deformvolume.DeformationWarning: as deformvolume.deform(), and if arrays are left out. Folds cause no
                warning: use a filter DeformVolume, and see its GetNumberOfInvertedTetrahedra().
        """
        return deform(
            self._image,
            deformation,
            vectors=vectors,
            rest=rest,
            reference=reference,
            categorical=categorical,
            density=density,
            **properties,
        )


def _check(**data):
    """Raises a TypeError if an argument is not a data set."""
    for what, given in data.items():
        if not isinstance(given, vtkDataObject):
            raise TypeError(f"{what} is a {type(given).__name__}. Give a data set of pyvista or VTK.")


def _take_names(image, what, names):
    """Returns names of point arrays of the image, which an argument lists."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise TypeError(f"{what} is {names!r}. Give a list of names of arrays.")
    names = list(names)
    unknown = [name for name in names if name not in image.point_data]
    if unknown:
        of_cells = [name for name in unknown if name in image.cell_data]
        advice = f" {of_cells} are cell arrays: image.cells_to_points() makes them point arrays." if of_cells else ""
        raise ValueError(f"The image has no point arrays {unknown}, which {what} names.{advice}")
    return names


def _make_filter(deformation, vectors, rest):
    """Returns a filter with this deformation."""
    _check(deformation=deformation)
    deformer = DeformVolume()
    deformer.SetDeformationData(deformation)
    if vectors is not None:
        deformer.SetInputArrayToProcess(0, 1, 0, 0, vectors)
    if rest is not None:
        _check(rest=rest)
        deformer.SetRestData(rest)
    return deformer


def deform(image, deformation, *, vectors=None, rest=None, reference=None, categorical=(), density=(), **properties):
    """Does the same as DeformVolumeAccessor.deform(), for versions of pyvista without accessors."""
    _check(image=image)
    categorical = _take_names(image, "categorical", categorical)
    density = _take_names(image, "density", density)
    deformer = _make_filter(deformation, vectors, rest)
    deformer.SetInputDataObject(0, image)
    if reference is not None:
        _check(reference=reference)
        deformer.SetReferenceData(reference)
    for name in categorical:
        deformer.AddCategoricalArray(name)
    for name in density:
        deformer.AddDensityArray(name)
    for name, value in properties.items():
        if not hasattr(deformer, f"Set{name}"):
            raise TypeError(
                f"deformvolume.vtk.DeformVolume has no property {name}. help(deformvolume.vtk.DeformVolume) lists its "
                "properties, such as OutsideMode=DeformVolume.KEEP. It has not all properties of the C++ class "
                "vtkDeformVolumeFilter, which is in the Python package deformvolume_vtk."
            )
        getattr(deformer, f"Set{name}")(value)
    deformer.Update()
    result = pyvista.wrap(deformer.GetOutputDataObject(0))
    # Many functions of pyvista, and files of other formats, have no extent.
    result.SetOrigin(result.GetPoint(0))
    result.SetDimensions(result.GetDimensions())
    return result


def deform_points(
    points,
    deformation,
    *,
    vectors=None,
    rest=None,
    FieldIsInverse=False,
    inverse=False,
    outside="discard",
    fade_distance=0.0,
):
    """Moves the points of a surface or another data set as deform() moves a volume, or back to rest.

    Args:
        points: pyvista.PolyData or another data set with points.
        deformation, vectors, rest: see DeformVolumeAccessor.deform().
        FieldIsInverse: the property of DeformVolume.
        inverse, outside, fade_distance: see deformvolume.deform_points(). OutsideMode=DeformVolume.KEEP of deform() is
            outside="keep" here.

    Returns:
        A copy of the data set with moved points. Active normals, which would no longer fit, are removed.

    Warns:
        deformvolume.DeformationWarning: points lie outside the deformation, and do not move.
    """
    if not isinstance(points, vtkPointSet):
        raise TypeError(f"points is a {type(points).__name__}. Give a data set with points, such as pyvista.PolyData.")
    deformer = _make_filter(deformation, vectors, rest)
    deformer.SetFieldIsInverse(FieldIsInverse)
    result = pyvista.wrap(points).copy()
    moved = deformer._deform_points(result.points, inverse, outside, fade_distance).points
    result.points = moved.astype(numpy.float32) if result.points.dtype == numpy.float32 else moved
    for data in (result.GetPointData(), result.GetCellData()):
        if data.GetNormals() is not None:
            data.RemoveArray(data.GetNormals().GetName())
    return result
