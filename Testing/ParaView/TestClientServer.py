# SPDX-License-Identifier: BSD-3-Clause
"""Tests a server and a client: the plugin is loaded on both, data and properties are passed in both directions, and the
list of devices is that of the server. The client of this test has no device."""

import os
import re
import subprocess
import sys

import deformvolume_vtk
from paraview import simple

from PluginTesting import (
    OUTPUT,
    arrays_of,
    bent_lattice,
    check,
    check_equal_images,
    check_one_message,
    deformed,
    fetch,
    load_plugin,
    messages,
    wavelet,
)
from ServerTesting import Server

LOG = os.path.join(OUTPUT, "TestClientServer.log")


def check_session():
    load_plugin(remote=True)
    load_plugin()
    here = deformvolume_vtk.vtkDeformVolumeFilter.GetDeviceNames()
    check(
        here.GetNumberOfValues() == 0,
        "The client has OpenCL devices, so the test cannot show that the server computes",
    )

    volume = wavelet(9)
    mesh = bent_lattice(volume)
    filter_ = simple.DeformVolume(Volume=volume, Deformation=mesh)
    check(
        list(filter_.DisplacementArray) == ["POINTS", "Displacement"],
        f"DisplacementArray is {list(filter_.DisplacementArray)}",
    )
    least = volume.PointData["RTData"].GetRange()[0]
    check(filter_.BackgroundValue == least, f"BackgroundValue is {filter_.BackgroundValue}, not {least}")
    filter_.Device = "cpu"
    filter_.Padding = 1
    filter_.CategoricalArrays = ["RTData"]
    filter_.UpdatePipeline()
    shown = filter_.SMProxy.GetProperty("NumberOfCoveredVoxels").GetElement(0)
    check(shown > 1000.0, f"Before a request for information, {shown} covered voxels are shown")
    filter_.UpdatePipelineInformation()
    check(filter_.DeviceInUse, "DeviceInUse is empty")
    check(
        filter_.CoveredVoxels > 1000.0 and "Device" in filter_.Summary,
        f"CoveredVoxels is {filter_.CoveredVoxels}, Summary is {filter_.Summary}",
    )
    check(filter_.GetClientSideObject() is None, "The filter is an object of the client")

    # The client gets the voxels that the server computes: without a displacement, those of the volume.
    filter_.DisplacementScale = 0.0
    filter_.Padding = 0
    filter_.UpdatePipeline()
    at_rest = arrays_of(fetch(filter_))["RTData"]
    check(
        (at_rest == arrays_of(fetch(volume))["RTData"]).all(),
        "Without a displacement, RTData differs from that of the volume",
    )
    filter_.DisplacementScale = 1.0
    first = fetch(deformed(volume, mesh, CategoricalArrays=["RTData"]))
    filter_.UpdatePipeline()
    check_equal_images(fetch(filter_), first, "two filters on the server")

    # The server reports an error. Neither process ends, and the filter works again with a valid device.
    filter_.Device = "no such device"
    with messages() as texts:
        filter_.UpdatePipeline()
    check_one_message(texts, ['no OpenCL device "no such device"'])
    check(filter_.GetDataInformation().GetNumberOfPoints() == 0, "The output is not empty after an error")
    filter_.Device = "best"
    filter_.UpdatePipeline()
    check(filter_.GetDataInformation().GetNumberOfPoints() > 0, "With a valid device the output is still empty")


def client(port):
    # This client loads the plugin before it connects.
    load_plugin()
    simple.Connect("localhost", port)
    check_session()


def main():
    if len(sys.argv) > 1:
        client(int(sys.argv[1]))
        return
    # The server has OpenCL devices, unlike the client.
    environment = dict(os.environ)
    del environment["OCL_ICD_VENDORS"]
    with Server([os.environ["DEFORMVOLUME_PVSERVER"]], LOG, environment) as server:
        # The client is a separate process. When it ends, the server ends.
        subprocess.run(
            [os.environ["DEFORMVOLUME_PVPYTHON"], __file__, str(server.port)],
            timeout=200,
            check=True,
        )
        server.wait()
    errors = re.findall(r"ERR\|.*", server.log())
    own = [error for error in errors if "returned failure for request" not in error]
    check(
        len(own) == 1 and 'no OpenCL device "no such device"' in own[0],
        f"The server does not report the error once: {server.log()}",
    )


main()
