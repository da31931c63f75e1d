# SPDX-License-Identifier: BSD-3-Clause
"""`image.deformvolume.deform(mesh)` for pyvista's images. Importing this module registers it."""

from collections.abc import Iterable

import pyvista
from vtkmodules.vtkCommonDataModel import vtkDataObject

from .vtk import DeformVolume


@pyvista.register_dataset_accessor("deformvolume", pyvista.ImageData) if hasattr(
    pyvista, "register_dataset_accessor"
) else (lambda accessor: accessor)
class DeformVolumeAccessor:
    """Deforms the image: see deform()."""

    def __init__(self, image):
        self._image = image

    def deform(self, deformation, *, vectors=None, rest=None, reference=None, categorical=(), **properties):
        """Deforms the image by a mesh or a displacement field.

        Args:
            deformation: pyvista.UnstructuredGrid with displacements of its points, or pyvista.ImageData with vectors.
            vectors: the name of the array; None: the active vectors, or the only array of three components.
            rest: the mesh at rest. The points of the deformation are then deformed positions.
            reference: an image with the grid of the output.
            categorical: names of arrays of labels, which are not interpolated.
            properties: properties of DeformVolume, such as OutsideMode=DeformVolume.KEEP.

        Returns:
            pyvista.ImageData.
        """
        return deform(
            self._image,
            deformation,
            vectors=vectors,
            rest=rest,
            reference=reference,
            categorical=categorical,
            **properties,
        )


def deform(image, deformation, *, vectors=None, rest=None, reference=None, categorical=(), **properties):
    """Does the same as DeformVolumeAccessor.deform(), for versions of pyvista without accessors."""
    for what, given in (("image", image), ("deformation", deformation), ("rest", rest), ("reference", reference)):
        if given is not None and not isinstance(given, vtkDataObject):
            raise TypeError(f"{what} is a {type(given).__name__}. Give a data set of pyvista or VTK.")
    if isinstance(categorical, str) or not isinstance(categorical, Iterable):
        raise TypeError(f"categorical is {categorical!r}. Give a list of names of arrays.")
    categorical = list(categorical)
    unknown = [name for name in categorical if name not in image.point_data]
    if unknown:
        raise ValueError(f"The image has no point arrays {unknown}, which categorical names.")
    deformer = DeformVolume()
    deformer.SetInputDataObject(0, image)
    deformer.SetDeformationData(deformation)
    if vectors is not None:
        deformer.SetInputArrayToProcess(0, 1, 0, 0, vectors)
    if rest is not None:
        deformer.SetRestData(rest)
    if reference is not None:
        deformer.SetReferenceData(reference)
    for name in categorical:
        deformer.AddCategoricalArray(name)
    for name, value in properties.items():
        getattr(deformer, f"Set{name}")(value)
    deformer.Update()
    return pyvista.wrap(deformer.GetOutputDataObject(0))
