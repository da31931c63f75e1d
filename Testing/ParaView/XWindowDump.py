# SPDX-License-Identifier: BSD-3-Clause
"""Reads the screen of an Xvfb that was started with -fbdir as an array, and writes arrays as PNG files."""

import struct
import zlib

import numpy


def read_window_dump(path):
    """Returns the rows of the screen from the top. Each pixel is red, green and blue."""
    with open(path, "rb") as file:
        data = file.read()
    header = struct.unpack(">25I", data[:100])
    size, width, height, bytes_per_line, colors = (header[i] for i in (0, 4, 5, 12, 19))
    if header[11] != 32:
        raise ValueError(f"{path} has {header[11]} bits per pixel, not 32")
    # A table of colors, 12 bytes each, is between header and pixels.
    pixels = numpy.frombuffer(
        data, numpy.uint8, count=bytes_per_line * height, offset=size + 12 * colors
    )
    return pixels.reshape(height, -1, 4)[:, :width, 2::-1].copy()


def write_png(pixels, path):
    height, width, _ = pixels.shape

    def chunk(kind, content):
        check = zlib.crc32(kind + content)
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", check)

    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)))
        file.write(chunk(b"IEND", b""))
