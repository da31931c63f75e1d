# SPDX-License-Identifier: BSD-3-Clause
"""Loads the library libdeformvolume.so from the folder of this file, and declares functions of deformvolume.h."""

import ctypes
import os

ABI_VERSION = 1

OK, ERROR, ABORTED = 0, 1, 2

DEVICE_PROCESSOR, DEVICE_EMULATED, DEVICE_DOUBLE = 1, 2, 4


class Error(RuntimeError):
    """An error of DeformVolume. The message says what is wrong and what to do."""


_SIGNATURES = {
    "dv_abi_version": (ctypes.c_int32, []),
    "dv_version": (ctypes.c_char_p, []),
    "dv_last_error": (ctypes.c_char_p, []),
    "dv_add_driver": (ctypes.c_int32, [ctypes.c_char_p]),
    "dv_set_linker": (ctypes.c_int32, [ctypes.c_char_p]),
    "dv_device_count": (ctypes.c_int32, []),
    "dv_device_name": (ctypes.c_char_p, [ctypes.c_int32]),
    "dv_device_flags": (ctypes.c_int32, [ctypes.c_int32]),
}


def declare(signatures):
    """Declares functions of the library: {name: (type of the result, types of the arguments)}."""
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype = result
        function.argtypes = arguments


def _load():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "libdeformvolume.so")
    try:
        loaded = ctypes.CDLL(path)
    except OSError as error:
        raise ImportError(f"The library of deformvolume cannot be loaded: {error}") from error
    found = loaded.dv_abi_version()
    if found != ABI_VERSION:
        raise ImportError(
            f"{path} has the ABI version {found}, but this package needs the ABI version {ABI_VERSION}. "
            "Install the package again."
        )
    return loaded


library = _load()
declare(_SIGNATURES)


def last_error():
    """Returns the message of the last error in this thread."""
    return library.dv_last_error().decode("utf-8", "replace")


def check(status):
    """Raises Error for the status ERROR, and KeyboardInterrupt for ABORTED."""
    if status == ERROR:
        raise Error(last_error())
    if status == ABORTED:
        raise KeyboardInterrupt


def version():
    """Returns the version of the library, such as "0.2.0"."""
    return library.dv_version().decode()
