# SPDX-License-Identifier: BSD-3-Clause
"""Lists OpenCL devices, and adds the driver from PyPI on systems without a driver for CPUs.

Python/README.md describes which drivers are used, and the environment variables that change this.
"""

import importlib.metadata
import os
import re
import threading
from typing import List, NamedTuple, Optional

from . import _native

_PACKAGE = "pocl-binary-distribution"
_lock = threading.Lock()
_ready = False
_process: Optional[int] = None  # ID of the process that has loaded the drivers


class Device(NamedTuple):
    """An OpenCL device."""

    name: str
    """ "device (platform)", a value for the argument `device` of functions"""
    is_processor: bool
    """whether it is a CPU"""
    is_emulated: bool
    """whether a software renderer or an interpreter emulates it; such devices are slow"""
    double_precision: bool
    """whether it supports double precision"""


def find_pypi_driver() -> Optional[str]:
    """Returns the absolute path of PoCL's library from PyPI; None if that package is not installed."""
    try:
        files = importlib.metadata.files(_PACKAGE) or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        # The package installs files into the folder of pyopencl, even if pyopencl is not installed.
        if re.fullmatch(r"libpocl[^/]*\.so[^/]*", file.name):
            path = os.path.abspath(str(file.locate()))
            if os.path.isfile(path):
                return path
    return None


def _list() -> List[Device]:
    found = []
    for index in range(_native.library.dv_device_count()):
        name = _native.library.dv_device_name(index)
        flags = _native.library.dv_device_flags(index)
        if name is None or flags < 0:
            raise _native.Error(_native.last_error())
        found.append(
            Device(
                name.decode("utf-8", "replace"),
                bool(flags & _native.DEVICE_PROCESSOR),
                bool(flags & _native.DEVICE_EMULATED),
                bool(flags & _native.DEVICE_DOUBLE),
            )
        )
    return found


def _add(path: str) -> None:
    # PoCL needs a linker, and exits the process if it finds no linker that works.
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "linker")
    if os.path.isfile(os.path.join(folder, "ld")):
        _native.check(_native.library.dv_set_linker(os.fsencode(folder)))
    _native.check(_native.library.dv_add_driver(os.fsencode(path)))


def _add_driver() -> None:
    choice = os.environ.get("DEFORMVOLUME_DRIVER", "") or "auto"
    if choice == "system":
        return
    if os.path.isabs(choice):
        _add(choice)
        return
    if choice not in ("auto", "pypi"):
        raise _native.Error(
            f'The environment variable DEFORMVOLUME_DRIVER is "{choice}". Set it to auto, system, pypi or the '
            "absolute path of an OpenCL driver."
        )
    if choice == "auto":
        if os.environ.get("OCL_ICD_VENDORS") or os.environ.get("OCL_ICD_FILENAMES"):
            return
        if any(device.is_processor and not device.is_emulated for device in _list()):
            return
    path = find_pypi_driver()
    if path is not None:
        _add(path)
    elif choice == "pypi":
        raise _native.Error(
            f'DEFORMVOLUME_DRIVER is "pypi", but the package {_PACKAGE} is not installed. '
            f'Install it with "pip install {_PACKAGE}".'
        )


def prepare() -> None:
    """Adds the driver from PyPI if it is needed. All functions that use a device call this first."""
    global _process, _ready
    # Check this before the lock is taken: another thread may have held it when the process was forked.
    if _process is not None and os.getpid() != _process:
        raise _native.Error(
            "This process was forked from a process that had used OpenCL. OpenCL does not work after a fork: calls "
            'would wait forever. Start processes with the start method "spawn" or "forkserver" '
            "(multiprocessing.set_start_method), or fork before the first use of deformvolume."
        )
    with _lock:
        if not _ready:
            _process = os.getpid()
            _add_driver()
            _ready = True


def devices() -> List[Device]:
    """Returns the OpenCL devices of this machine, the best first. The list is empty if there is none.

    Raises:
        Error: if the environment variable DEFORMVOLUME_DRIVER names a driver that cannot be used, or if this process
            was forked from one that has used OpenCL.
    """
    prepare()
    return _list()
