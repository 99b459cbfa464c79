# SPDX-License-Identifier: MIT
"""A graph's file taken apart and put together again, as the format says: what the tests and the fuzzer damage."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

MAGIC = b"\x89SVGr\r\n\x1a"
# magic, version, header bytes, file bytes, mesh fingerprint, vertices, faces, arcs, k, flags, accuracy, longest path,
# longest arc, target bits, least exponent, quantum
FIELDS_OF_HEADER = struct.Struct("<8sIIQQQQQIIdddiid")
HEADER = struct.Struct("112s")  # those, their checksum, and four zeros
FIELDS = (
    "magic", "version", "header_bytes", "file_bytes", "fingerprint", "vertex_count", "face_count", "arc_count", "k",
    "flags", "accuracy", "longest_path", "longest_arc", "target_bits", "least_exponent", "quantum",
)  # fmt: skip


@dataclass
class GraphFile:
    """The parts of a file; `bytes` joins them with the right checksum and, unless `header` says otherwise, length."""

    header: dict[str, object]
    vertices: NDArray[np.int32]
    degrees: NDArray[np.uint32]
    arcs: NDArray[np.uint64]
    behind: bytes = b""
    fixed: dict[str, object] = field(default_factory=dict)

    @classmethod
    def of(cls, contents: bytes) -> GraphFile:
        header = dict(zip(FIELDS, FIELDS_OF_HEADER.unpack(contents[: FIELDS_OF_HEADER.size]), strict=True))
        count, size = int(header["vertex_count"]), HEADER.size
        return cls(
            header,
            np.frombuffer(contents, "<i4", count, size).copy(),
            np.frombuffer(contents, "<u4", count, size + 4 * count).copy(),
            np.frombuffer(contents, "<u8", int(header["arc_count"]), size + 8 * count).copy(),
        )

    @classmethod
    def read(cls, path: Path) -> GraphFile:
        return cls.of(path.read_bytes())

    def with_header(self, **fields: object) -> GraphFile:
        return replace(self, fixed=fields)

    def row(self, node: int) -> slice:
        first = int(self.degrees[:node].sum())
        return slice(first, first + int(self.degrees[node]))

    @property
    def target_bits(self) -> int:
        return int(self.header["target_bits"])

    def targets(self) -> NDArray[np.int64]:
        return (self.arcs & np.uint64((1 << self.target_bits) - 1)).astype(np.int64)

    def bytes(self) -> bytes:
        body = self.vertices.tobytes() + self.degrees.tobytes() + self.arcs.tobytes() + self.behind
        size = {"file_bytes": HEADER.size + len(body) + 4, "arc_count": len(self.arcs)}
        header = FIELDS_OF_HEADER.pack(*(({**self.header, **size, **self.fixed})[name] for name in FIELDS))
        return with_checksum(with_checksum(header) + bytes(4) + body)

    def bytes_of_version_1(self) -> bytes:
        """As older libraries wrote it: the seconds of the build in its header, and no lengths."""
        size = HEADER.size - 16
        old = self.with_header(version=1, header_bytes=size, longest_path=0.25).bytes()
        longest_arc, checksum = FIELDS_OF_HEADER.size - 24, FIELDS_OF_HEADER.size
        length = (len(old) - 16).to_bytes(8, "little")
        fields = old[:16] + length + old[24:longest_arc] + old[longest_arc + 8 : checksum]
        return with_checksum(fields + old[HEADER.size : -4])


def with_checksum(contents: bytes) -> bytes:
    return contents + struct.pack("<I", zlib.crc32(contents))
