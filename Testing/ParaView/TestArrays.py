# SPDX-License-Identifier: BSD-3-Clause
"""Compares results of the proxies with those of the classes without ParaView's server manager: for the MRI of a head,
and for ParaView's wavelet with several arrays and all types of deformations."""

import os

import deformvolume_vtk
import numpy
from paraview import simple
from vtkmodules.util import numpy_support
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from PluginTesting import (
    OUTPUT,
    arrays_of,
    bent_lattice,
    check,
    check_equal_images,
    check_one_message,
    check_silent,
    deformed,
    fetch,
    head_file,
    load_plugin,
    messages,
    wavelet,
)

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS


def plain_filter(volume, deformation, array, rest=None):
    filter_ = deformvolume_vtk.vtkDeformVolumeFilter()
    filter_.SetInputData(volume)
    filter_.SetDeformationData(deformation)
    if rest is not None:
        filter_.SetRestData(rest)
    if array:
        filter_.SetInputArrayToProcess(0, 1, 0, POINTS, array)
    filter_.Update()
    return filter_


def plain_mesh(volume, nodes, displace):
    """Returns a lattice over a volume, with displacements that numpy computes."""
    lattice = deformvolume_vtk.vtkLatticeTetrahedraSource()
    lattice.SetInputData(volume)
    lattice.SetNumberOfNodes(nodes, nodes, nodes)
    lattice.EqualSpacingOff()
    lattice.Update()
    mesh = lattice.GetOutput()
    points = numpy_support.vtk_to_numpy(mesh.GetPoints().GetData())
    vectors = numpy_support.numpy_to_vtk(displace(points), deep=1)
    vectors.SetName("Displacement")
    mesh.GetPointData().AddArray(vectors)
    return mesh


def test_mri():
    """Tests a head that is pushed in: 7 million voxels of bytes."""
    reader = simple.OpenDataFile(head_file())
    reader.UpdatePipeline()
    head = fetch(reader)

    mesh = bent_lattice(
        reader, nodes=9, function="-15*exp(-((coordsX-90)^2+(coordsZ-60)^2)/1000)*jHat"
    )
    filter_ = deformed(reader, mesh)
    plain = plain_filter(head, fetch(mesh), "Displacement")
    check_equal_images(fetch(filter_), plain.GetOutput(), "MRI")
    check(
        filter_.CoveredVoxels == plain.GetNumberOfCoveredVoxels() > 7e6,
        f"CoveredVoxels is {filter_.CoveredVoxels}, not {plain.GetNumberOfCoveredVoxels()}",
    )
    name = list(arrays_of(head))[0]
    check(fetch(filter_).GetPointData().GetScalars().GetName() == name, f"The active scalars are not {name}")
    check(plain.GetOutput().GetExtent() != head.GetExtent(), "The extent has not changed")


def test_wavelet():
    volume = wavelet(10)
    more = simple.Calculator(Input=volume)
    more.ResultArrayName = "Label"
    more.Function = "floor(RTData/50)"
    more.UpdatePipeline()
    image = fetch(more)

    # The expected output does not use proxies, except for the volume: numpy computes the displacements.
    mesh = bent_lattice(more)
    filter_ = deformed(more, mesh, CategoricalArrays=["Label"], Padding=2, BackgroundValue=-1.0)
    displaced = plain_mesh(
        image, 6, lambda points: numpy.outer(0.05 * points[:, 1] * points[:, 1], [1.0, 0.0, 0.0])
    )
    plain = plain_filter(image, displaced, "Displacement")
    plain.AddCategoricalArray("Label")
    plain.SetPadding(2)
    plain.SetBackgroundValue(-1.0)
    plain.Update()
    check_equal_images(fetch(filter_), plain.GetOutput(), "wavelet")
    labels = set(numpy.unique(arrays_of(image)["Label"])) | {-1.0}
    mixed = set(numpy.unique(arrays_of(fetch(filter_))["Label"])) - labels
    check(not mixed, f"Labels are mixed: {mixed}")

    # The same deformation as two meshes, and without any displacement.
    warp = simple.WarpByVector(Input=mesh, Vectors=["POINTS", "Displacement"])
    rest = simple.TetrahedralLatticeOfVolume(Volume=more, NumberOfNodes=[6, 6, 6])
    two = deformed(more, warp, RestMesh=rest)
    plain = plain_filter(image, fetch(warp), None, fetch(rest))
    check_equal_images(fetch(two), plain.GetOutput(), "two meshes")
    scaled = deformed(more, mesh, DisplacementScale=0.0)
    output = fetch(scaled)
    for name, values in arrays_of(image).items():
        check(numpy.array_equal(arrays_of(output)[name], values), f"At rest {name} differs")

    # A displacement field with another resolution than the volume.
    field = simple.Calculator(Input=wavelet(12))
    field.ResultArrayName = "Field"
    field.Function = "0.1*coordsX*jHat+2*kHat"
    field.UpdatePipeline()
    by_field = deformed(more, field)
    check(list(by_field.DisplacementArray) == ["POINTS", "Field"], f"{by_field.DisplacementArray}")
    plain = plain_filter(image, fetch(field), "Field")
    check_equal_images(fetch(by_field), plain.GetOutput(), "field")

    # A composite dataset, as Exodus readers output it.
    group = simple.GroupDatasets(Input=[mesh])
    group.UpdatePipeline()
    by_group = deformed(more, group)
    check_equal_images(
        fetch(by_group), plain_filter(image, fetch(mesh), "Displacement").GetOutput(), "composite"
    )

    # A mesh of TetGen.
    mesher = simple.TetGenMesher(Input=volume)
    mesher.UpdatePipeline()
    mesher.UpdatePipelineInformation()
    plain = deformvolume_vtk.vtkTetGenMesher()
    plain.SetInputData(fetch(volume))
    plain.Update()
    check(
        mesher.UsedIsovalue == plain.GetUsedIsovalue() != 0.0,
        f"UsedIsovalue is {mesher.UsedIsovalue}, not {plain.GetUsedIsovalue()}",
    )
    check(
        fetch(mesher).GetNumberOfCells() == plain.GetOutput().GetNumberOfCells() > 100,
        "The proxy and the VTK class have other numbers of tetrahedra",
    )


def test_geometry():
    """Tests surfaces that are moved with the wavelet, and back to rest."""
    volume = wavelet(6)
    mesh = bent_lattice(volume)
    ball = simple.Sphere(Radius=4)
    moved = simple.DeformGeometry(Input=ball, Deformation=mesh)
    back = simple.DeformGeometry(Input=moved, Deformation=mesh, Inverse=True)
    plain = deformvolume_vtk.vtkDeformGeometryFilter()
    plain.SetInputData(fetch(ball))
    plain.SetDeformationData(fetch(mesh))
    plain.Update()

    def points_of(data):
        return numpy_support.vtk_to_numpy(data.GetPoints().GetData())

    at_rest, expected = points_of(fetch(ball)), points_of(plain.GetOutput())
    check(numpy.abs(expected - at_rest).max() > 0.5, "The VTK class moves points by at most 0.5")
    check(
        numpy.array_equal(points_of(fetch(moved)), expected),
        "The proxy and the VTK class move points to other positions",
    )
    check(
        numpy.abs(points_of(fetch(back)) - at_rest).max() < 1e-5,
        "With Inverse, points differ from those at rest by 1e-5 or more",
    )
    normals = arrays_of(fetch(moved))["Normals"]
    check(numpy.abs(normals - arrays_of(fetch(ball))["Normals"]).max() > 0.1, "Normals change by at most 0.1")
    # A composite dataset, one block of which is outside the mesh.
    beside = simple.Sphere(Radius=1, Center=[30, 0, 0])
    group = simple.GroupDatasets(Input=[ball, beside])
    with messages() as texts:
        blocks = fetch(simple.DeformGeometry(Input=group, Deformation=mesh))
    count = fetch(beside).GetNumberOfPoints()
    check_one_message(texts, [f"{count} of {count + len(at_rest)} points lie outside"])
    check(
        numpy.array_equal(points_of(blocks.GetBlock(0)), expected),
        "A block moves to other positions than a single surface",
    )
    check(not arrays_of(blocks.GetBlock(1))["vtkValidPointMask"].any(), "Points outside the mesh are marked as valid")


def test_direction():
    """Tests an oblique image of a reader, as the volume and as the reference image. ParaView does not pass on the
    direction that a reader announces."""
    image = vtkImageData()
    image.SetDimensions(12, 11, 10)
    image.SetOrigin(3.0, -2.0, -5.0)
    image.SetSpacing(1.0, 1.5, -2.0)
    image.SetDirectionMatrix([0.6, -0.8, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, -1.0])
    values = numpy_support.numpy_to_vtk(numpy.arange(12 * 11 * 10, dtype=numpy.int16), deep=1)
    values.SetName("Values")
    image.GetPointData().SetScalars(values)
    path = os.path.join(OUTPUT, "oblique.vti")
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.SetDataModeToAscii()
    writer.Write()

    reader = simple.OpenDataFile(path)
    reader.UpdatePipeline()
    with messages() as texts:
        at_rest = fetch(simple.DeformVolume(Volume=reader))
        edited = fetch(simple.DeformVolume(Volume=simple.CarveVolume(Volume=reader, Body="None")))
    check_silent(texts)
    for output in (at_rest, edited):
        check_equal_grids(output, image)
        check(numpy.array_equal(arrays_of(output)["Values"], arrays_of(image)["Values"]), "Values have changed")
    # The volume moves by two voxels on the first axis of the image.
    mesh = bent_lattice(reader, function="1.2*iHat+1.6*jHat")
    with messages() as texts:
        moved = fetch(deformed(reader, mesh, ReferenceImage=reader))
    check_silent(texts)
    check_equal_grids(moved, image)
    values = arrays_of(image)["Values"].reshape(10, 11, 12)
    expected = numpy.zeros_like(values)
    expected[:, :, 2:] = values[:, :, :-2]
    difference = numpy.abs(arrays_of(moved)["Values"].reshape(values.shape) - expected)
    check(difference.max() <= 1, f"Values differ by {difference.max()} from those moved by two voxels")
    # Another volume on this grid.
    with messages() as texts:
        other = fetch(simple.DeformVolume(Volume=wavelet(6), ReferenceImage=reader))
    check_silent(texts)
    check_equal_grids(other, image)


def check_equal_grids(output, image):
    check(
        output.GetExtent() == image.GetExtent()
        and numpy.allclose(output.GetOrigin(), image.GetOrigin())
        and numpy.allclose(output.GetSpacing(), image.GetSpacing())
        and numpy.allclose(output.GetPoint(1234), image.GetPoint(1234)),
        f"The grid of the output is {output}, not that of {image}",
    )


def main():
    load_plugin()
    check(isinstance(fetch(wavelet(2)), vtkImageData), "The wavelet is not a vtkImageData")
    test_wavelet()
    test_geometry()
    test_direction()
    test_mri()


main()
