# SPDX-License-Identifier: BSD-3-Clause
"""Which OpenCL devices there are, and the driver from PyPI for systems that have none.

The kernels run on the OpenCL drivers that the system lists. Where none of these is for processors, the
driver PoCL of the package pocl-binary-distribution is added, in this process and for this package only: no
environment variable is set, and nothing changes for other users of OpenCL.

DEFORMVOLUME_DRIVER, an environment variable that is read when devices are first needed, changes that:
    auto            as above; the same as no value
    system          only drivers that the system lists
    pypi            the one from PyPI is added in any case
    /path/lib.so    this driver is added in any case, and the one from PyPI is not

PoCL of the versions before 7.2 runs the program ld to link what it has compiled. Where that does not work, as
without a C compiler, the program linker/ld of this package does it, for the driver that was added only.
DEFORMVOLUME_LINKER changes that: system never takes it, own always does. While kernels are compiled, and
at no other time, its folder is in the environment variable COMPILER_PATH of the process.

PoCL 3.0 of the package pocl-binary-distribution compiles its built-in functions and kernels for processors that do not
fit together, and no option changes that: a member of its own structure, which says what kernels are compiled for, is
set in memory before anything is compiled. That is done for this build of the driver only (its version and the build
ID of its library are compared), where it was added by this package. DEFORMVOLUME_KERNEL_PROCESSOR changes that: auto
is the same as no value, driver leaves the driver alone. Kernels are then slower, or an error says that the driver cannot
compile them for this processor.

OCL_ICD_VENDORS and OCL_ICD_FILENAMES say, as for other programs, which drivers the system lists. Whoever
sets one of them has chosen: unless DEFORMVOLUME_DRIVER says otherwise, no driver is added then.
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
_process: Optional[int] = None  # that has started the drivers


class Device(NamedTuple):
    """An OpenCL device."""

    name: str
    """ "device (platform)", as functions take it that have an argument `device`"""
    is_processor: bool
    """whether it is a processor, by a driver for processors"""
    is_emulated: bool
    """whether a renderer in software or an interpreter emulates it: such devices are slow"""
    double_precision: bool
    """whether it has double precision"""


def find_pypi_driver() -> Optional[str]:
    """The absolute path of PoCL's library from PyPI; None where that package is not installed."""
    try:
        files = importlib.metadata.files(_PACKAGE) or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        # The package installs into the folder of another one, pyopencl, which need not be there.
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
    # PoCL needs a linker, and ends the process where it finds none that works.
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
            f'DEFORMVOLUME_DRIVER is "pypi", but the package {_PACKAGE} is not installed: '
            f"pip install {_PACKAGE}"
        )


def prepare() -> None:
    """Adds the driver from PyPI where it is needed. All functions that use a device call this first."""
    global _process, _ready
    # Before the lock, which another thread may have held when the process was forked.
    if _process is not None and os.getpid() != _process:
        raise _native.Error(
            "This process was forked from one that had used OpenCL, which does not survive that: its calls would wait "
            'forever. Start processes by "spawn" or "forkserver" (multiprocessing.set_start_method), or before the '
            "first use of deformvolume."
        )
    with _lock:
        if not _ready:
            _process = os.getpid()
            _add_driver()
            _ready = True


def devices() -> List[Device]:
    """The OpenCL devices of this machine, the best first; the list is empty where there is none.

    Raises:
        Error: where the environment variable DEFORMVOLUME_DRIVER names a driver that cannot be used, and in a process
            that was forked from one that has used OpenCL.
    """
    prepare()
    return _list()
