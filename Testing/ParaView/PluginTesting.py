# SPDX-License-Identifier: BSD-3-Clause
"""Functions for the tests of the ParaView plugin: the path of the plugin, messages, pipelines, checks."""

import contextlib
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

import numpy
from paraview import simple
from vtkmodules.util import numpy_support
from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkIOImage import vtkNIFTIImageReader
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

PLUGIN = os.environ["DEFORMVOLUME_PLUGIN"]
PLUGIN_SOURCE = os.path.join(os.path.dirname(__file__), "..", "..", "Plugin")
OUTPUT = os.environ["DEFORMVOLUME_TEST_OUTPUT"]
MRI = "/usr/share/mricron/templates/ch2.nii.gz"  # 181 x 217 x 181 bytes, a head


def load_plugin(remote=False):
    """Loads the plugin. Its proxies become functions of paraview.simple."""
    simple.LoadPlugin(PLUGIN, remote=remote, ns=vars(simple))


def plugin_proxies():
    """Returns the XML elements of the proxies that users see, each with all proxies that it is based on."""
    elements = {}
    for name in sorted(os.listdir(PLUGIN_SOURCE)):
        if name.endswith(".xml"):
            root = ElementTree.parse(os.path.join(PLUGIN_SOURCE, name)).getroot()
            for group in root.iter("ProxyGroup"):
                elements.update({(group.get("name"), proxy.get("name")): proxy for proxy in group})
    result = []
    for (group, _), proxy in elements.items():
        if group.startswith("internal_"):
            continue
        base = proxy
        while base.get("base_proxyname"):
            base = elements[base.get("base_proxygroup"), base.get("base_proxyname")]
            proxy.extend(list(base))
        result.append(proxy)
    return result


def check(condition, text):
    """Fails the test with a text if a condition is false."""
    if not condition:
        raise AssertionError(text)


@contextlib.contextmanager
def messages():
    """Collects the messages that the user sees, in a list of texts. Messages in which the executive repeats that a
    request has failed are left out."""
    window = vtkOutputWindow.GetInstance()
    collecting = vtkStringOutputWindow()
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    vtkOutputWindow.SetInstance(collecting)
    texts = []
    try:
        yield texts
    finally:
        vtkOutputWindow.SetInstance(window)
        vtkLogger.SetStderrVerbosity(verbosity)
        text = collecting.GetOutput()
        starts = r"(?=ERROR: In |Generic Warning: In |(?<!Generic )Warning: In )"
        texts.extend(
            part.strip()
            for part in re.split(starts, text)
            if part.strip() and "returned failure for request" not in part
        )


def check_one_message(texts, words):
    check(len(texts) == 1, f"Expected one message, not {len(texts)}:\n" + "\n".join(texts))
    for word in words:
        check(word in texts[0], f'"{word}" is missing in: {texts[0]}')


def check_messages(texts, words):
    """Checks messages that views display at each of their updates: all must contain the words."""
    check(texts, f"Expected messages with {words}, but there are none")
    for text in texts:
        check_one_message([text], words)


def check_silent(texts):
    check(not texts, "Expected no messages, but there are: " + "\n".join(texts))


def arrays_of(data):
    """Returns the point arrays of a dataset by name."""
    point_data = data.GetPointData()
    return {
        point_data.GetArrayName(i): numpy_support.vtk_to_numpy(point_data.GetArray(i))
        for i in range(point_data.GetNumberOfArrays())
    }


def fetch(proxy):
    return simple.servermanager.Fetch(proxy)


def check_equal_images(first, second, what):
    """Checks that two images have the same geometry, and the same point arrays to the last bit."""
    for method in ("GetExtent", "GetOrigin", "GetSpacing"):
        one, other = getattr(first, method)(), getattr(second, method)()
        check(one == other, f"{what}: {method} gives {one} and {other}")
    directions = [
        [image.GetDirectionMatrix().GetElement(i, j) for i in range(3) for j in range(3)]
        for image in (first, second)
    ]
    check(directions[0] == directions[1], f"{what}: the directions {directions} differ")
    one, other = arrays_of(first), arrays_of(second)
    check(one and list(one) == list(other), f"{what}: the arrays {list(one)} and {list(other)} differ")
    for name, values in one.items():
        check(
            values.dtype == other[name].dtype,
            f"{what}: the types of {name} are {values.dtype} and {other[name].dtype}",
        )
        check(
            numpy.array_equal(values, other[name]),
            f"{what}: {numpy.sum(values != other[name])} of {values.size} values of {name} differ",
        )


def wavelet(half=10):
    return simple.Wavelet(WholeExtent=[-half, half] * 3)


def head_file():
    """Returns the name of a file with the MRI that ParaView can open. Skips the test if the MRI is not installed."""
    if not os.path.exists(MRI):
        print(f"{MRI} of the package mricron-data is missing")
        sys.exit(125)
    reader = vtkNIFTIImageReader()
    reader.SetFileName(MRI)
    writer = vtkXMLImageDataWriter()
    # Several tests may run at once.
    path = os.path.join(OUTPUT, f"head-{os.path.basename(sys.argv[0])}.vti")
    writer.SetFileName(path)
    writer.SetInputConnection(reader.GetOutputPort())
    writer.SetCompressorTypeToNone()
    writer.SetDataModeToBinary()  # ParaView 5.11 cannot read VTK's appended data
    writer.Write()
    return path


def bent_lattice(volume, nodes=6, array="Displacement", function="0.05*coordsY*coordsY*iHat"):
    """Returns a lattice over a volume, with displacements."""
    volume.UpdatePipeline()
    lattice = simple.TetrahedralLatticeOfVolume(Volume=volume)
    lattice.NumberOfNodes = [nodes] * 3
    lattice.EqualSpacing = False
    bent = simple.Calculator(Input=lattice)
    bent.ResultArrayName = array
    bent.Function = function
    bent.UpdatePipeline()
    return bent


def deformed(volume, deformation, **properties):
    """Returns a Deform Volume filter after an update, with current information properties."""
    filter_ = simple.DeformVolume(Volume=volume, Deformation=deformation, **properties)
    filter_.UpdatePipeline()
    filter_.UpdatePipelineInformation()
    return filter_
