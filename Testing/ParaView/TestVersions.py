# SPDX-License-Identifier: BSD-3-Clause
"""Tests that a plugin for another version of ParaView gives one message, and the process does not end, and that the
plugin for this version gives no message."""

import contextlib
import sys

from paraview import simple

from PluginTesting import check_one_message, check_silent, load_plugin, messages, wavelet


def load(path):
    with messages() as texts:
        with contextlib.suppress(RuntimeError):
            simple.LoadPlugin(path, remote=False, ns={})
    return texts


def main(other_major, other_minor, other_patch, not_loadable):
    major, minor, patch = (
        str(getattr(simple.servermanager.vtkSMProxyManager, f"GetVersion{part}")())
        for part in ("Major", "Minor", "Patch")
    )
    running = f"this is ParaView {major}.{minor}.{patch}"
    texts = load(other_major)
    check_one_message(texts, ["ERROR", f"ParaView 4.{minor}.{patch}", running, "Build"])
    texts = load(other_minor)
    check_one_message(texts, ["ERROR", f"ParaView {major}.99.{patch}", running, "Build"])
    texts = load(other_patch)
    check_one_message(texts, ["Warning", f"ParaView {major}.{minor}.99", running])
    texts = load(not_loadable)
    check_one_message(texts, ["vtkRemotingCore-pv4.9", "DeformVolumeNotLoadable.so"])
    with messages() as texts:
        load_plugin()
    check_silent(texts)
    wavelet(4).UpdatePipeline()


main(*sys.argv[1:])
