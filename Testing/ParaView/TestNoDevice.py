# SPDX-License-Identifier: BSD-3-Clause
"""Tests that without an OpenCL device there is one message that says what to install, and the process does not end."""

from PluginTesting import bent_lattice, check, check_one_message, load_plugin, messages, simple, wavelet


def main():
    load_plugin()
    volume = wavelet(6)
    mesh = bent_lattice(volume)
    with messages() as texts:
        filter_ = simple.DeformVolume(Volume=volume, Deformation=mesh)
    check(not texts, f"A message before the first update: {texts}")
    with messages() as texts:
        filter_.UpdatePipeline()
    check_one_message(texts, ["no OpenCL", "pocl-opencl-icd"])
    check(mesh.GetDataInformation().GetNumberOfPoints() == 216, "After the error the lattice does not have 216 points")


main()
