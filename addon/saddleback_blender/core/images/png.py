# SPDX-License-Identifier: GPL-3.0-or-later
"""PNG files of 8 or 16 bits. After ISO/IEC 15948:2004."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

ROWS = 64  # between two looks at whether to stop
LEVEL = 1  # of compression: more takes twice as long for a tenth less
SIGNATURE = b"\x89PNG\r\n\x1a\n"
COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}  # gray, gray and alpha, RGB, RGBA


def png_bytes(
    rows: Callable[[slice], NDArray[np.unsignedinteger]], height: int, check: Callable[[], None]
) -> Iterator[bytes]:
    """Yields the file of an image whose `rows(part)` are (k, width, channels) uint8 or uint16, the lowest row first.

    `check` is called between parts and may raise.
    """
    first = rows(slice(0, 1))
    _, width, channels = first.shape
    yield SIGNATURE
    yield _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8 * first.itemsize, COLOR_TYPES[channels], 0, 0, 0))
    packer = zlib.compressobj(LEVEL)
    for top in range(height, 0, -ROWS):
        check()
        part = rows(slice(max(0, top - ROWS), top))[::-1]
        plain = np.ascontiguousarray(part.astype(part.dtype.newbyteorder(">"))).view(np.uint8).reshape(len(part), -1)
        # Each row as it differs from the one above, the first of a part as it is: smooth pictures become small.
        lines = np.empty((len(part), plain.shape[1] + 1), np.uint8)
        lines[:, 0] = 2
        lines[0, 0] = 0
        lines[0, 1:] = plain[0]
        lines[1:, 1:] = plain[1:] - plain[:-1]
        packed = packer.compress(lines.tobytes())
        if packed:
            yield _chunk(b"IDAT", packed)
    yield _chunk(b"IDAT", packer.flush())
    yield _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
