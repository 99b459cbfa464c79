# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenEXR files of 32-bit floats, packed by ZIP. After "OpenEXR File Layout", openexr.com."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

ROWS = 16  # that the format packs together
LEVEL = 1  # of compression
# A block is packed as does well enough on one of its rows: by runs alone, three times as fast, where they make it at
# most so much longer than deflate does; not at all where less than the rest would be saved.
AS_SHORT, WORTH = 1.1, 0.9
ZIP, FLOAT = 3, 2
# The names that say what a picture is, in the file's order, with their places among the channels.
CHANNELS = {1: (("Y", 0),), 3: (("B", 2), ("G", 1), ("R", 0)), 4: (("A", 3), ("B", 2), ("G", 1), ("R", 0))}


def exr_bytes(rows: Callable[[slice], NDArray[np.floating]], height: int, check: Callable[[], None]) -> Iterator[bytes]:
    """Yields the file of an image whose `rows(part)` are (k, width, channels) reals, the lowest row first; 1, 3 or 4
    channels. `check` is called between parts and may raise.
    """
    _, width, count = rows(slice(0, 1)).shape
    channels = CHANNELS[count]
    head = _head(width, height, channels)
    blocks = []
    for y in range(0, height, ROWS):
        check()
        # The file's first row is the uppermost one.
        part = rows(slice(max(0, height - y - ROWS), height - y))[::-1].astype("<f4")
        planes = np.stack([part[:, :, place] for _, place in channels], axis=1)
        packed = _packed(planes.tobytes(), planes[0].nbytes)
        blocks.append(struct.pack("<ii", y, len(packed)) + packed)
    begin = len(head) + 8 * len(blocks)
    places = begin + np.cumsum([0, *(len(block) for block in blocks[:-1])])
    yield head + places.astype("<u8").tobytes()
    yield from blocks


def _head(width: int, height: int, channels: tuple[tuple[str, int], ...]) -> bytes:
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", FLOAT, 0, 1, 1) for name, _ in channels) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    attributes = (
        ("channels", "chlist", listed),
        ("compression", "compression", bytes([ZIP])),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        ("screenWindowCenter", "v2f", struct.pack("<ff", 0.0, 0.0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1.0)),
    )
    told = (f"{name}\0{kind}\0".encode() + struct.pack("<i", len(data)) + data for name, kind, data in attributes)
    return struct.pack("<ii", 20000630, 2) + b"".join(told) + b"\0"


def _packed(plain: bytes, row: int) -> bytes:
    """The bytes of a block, whose rows have `row` each: packed, or as they are, which the format takes where that is
    not longer.
    """
    sample = _steps(plain[:row])
    by_strings, by_runs = (len(_deflated(sample, strategy)) for strategy in (zlib.Z_DEFAULT_STRATEGY, zlib.Z_RLE))
    if min(by_strings, by_runs) > WORTH * row:
        return plain
    packed = _deflated(_steps(plain), zlib.Z_RLE if by_runs < AS_SHORT * by_strings else zlib.Z_DEFAULT_STRATEGY)
    return packed if len(packed) < len(plain) else plain


def _steps(plain: bytes) -> bytes:
    """First all even bytes, then the odd ones, as each differs from the one before."""
    data = np.frombuffer(plain, np.uint8)
    parted = np.concatenate([data[::2], data[1::2]])
    steps = parted.copy()
    steps[1:] = parted[1:] - parted[:-1] + np.uint8(128)
    return steps.tobytes()


def _deflated(data: bytes, strategy: int) -> bytes:
    packer = zlib.compressobj(LEVEL, strategy=strategy)
    return packer.compress(data) + packer.flush()
