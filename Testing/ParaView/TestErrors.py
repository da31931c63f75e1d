# SPDX-License-Identifier: BSD-3-Clause
"""Tests misuse through the proxies: each update reports one readable message, the process does not end, and the filter
works again when its input is right."""

from paraview import simple

from PluginTesting import (
    bent_lattice,
    check,
    check_messages,
    check_one_message,
    check_silent,
    load_plugin,
    messages,
    wavelet,
)


def update(filter_):
    with messages() as texts:
        filter_.UpdatePipeline()
    return texts


def check_works(filter_):
    check_silent(update(filter_))
    check(filter_.GetDataInformation().GetNumberOfPoints() > 0, "The output is empty")


def main():
    load_plugin()
    volume = wavelet(6)
    mesh = bent_lattice(volume)
    bare = simple.TetrahedralLatticeOfVolume(Volume=volume)

    # The volume is missing.
    simple.SetActiveSource(None)
    with messages():
        filter_ = simple.DeformVolume(Deformation=mesh)
    check_messages(update(filter_), ["Input port 0", "is not optional"])
    check(filter_.GetDataInformation().GetNumberOfPoints() == 0, "The output is not empty after an error")
    filter_.Volume = volume
    check_works(filter_)

    # Without a deformation the output is the volume itself.
    simple.SetActiveSource(None)
    filter_ = simple.DeformVolume(Volume=volume)
    texts = update(filter_)
    check(not texts, f"Messages without a deformation: {texts}")
    points = volume.GetDataInformation().GetNumberOfPoints()
    check(
        filter_.GetDataInformation().GetNumberOfPoints() == points,
        "Without a deformation the output has other points than the volume",
    )
    filter_.Deformation = mesh
    check_works(filter_)

    # A mesh without arrays, and an array that does not exist. There is no message before an update, because the user may
    # choose another array before.
    bare.UpdatePipeline()
    with messages() as texts:
        filter_ = simple.DeformVolume(Volume=volume, Deformation=bare)
    check_silent(texts)
    check_one_message(update(filter_), ["has no active Vectors of its points"])
    filter_.Deformation = mesh
    check_works(filter_)
    filter_.DisplacementArray = ["POINTS", "no such array"]
    check_one_message(update(filter_), ['no point array "no such array"'])
    filter_.DisplacementArray = ["POINTS", "Displacement"]
    check_works(filter_)

    # A mesh at rest with another number of points.
    other = bent_lattice(volume, nodes=5)
    filter_.RestMesh = other
    check_one_message(update(filter_), ["points"])
    filter_.RestMesh = None
    check_works(filter_)

    # A surface as volume, and a surface as deformation.
    surface = simple.Sphere()
    surface.UpdatePipeline()
    filter_.Deformation = surface
    texts = update(filter_)
    check(len(texts) >= 1 and "vtkPolyData" in texts[0], f"A surface as the deformation must be an error: {texts}")
    filter_.Deformation = mesh
    check_works(filter_)

    # A device that does not exist, and too little memory.
    filter_.Device = "no such device"
    check_one_message(update(filter_), ['no OpenCL device "no such device"', "Ask for"])
    filter_.Device = "cpu"
    filter_.MemoryLimit = 1000
    check_one_message(update(filter_), ["memory"])
    filter_.MemoryLimit = 0
    check_works(filter_)



main()
