# SPDX-License-Identifier: MIT
"""One box in the dialects that programs write: each is (extension, contents)."""

import struct
import sys
from pathlib import Path

import numpy as np

VERTICES = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]
# Each corner of a strip closes a triangle with the two before it.
STRIPS = [corner for a, b, c, d in QUADS for corner in (a, b, d, c, -1)]


def lines(form, rows):
    return "".join(form % tuple(row) for row in rows)


V_LINES = lines("v %g %g %g\n", VERTICES)
POINTS = lines("%g %g %g\n", VERTICES)
OBJ = V_LINES + lines("f %d %d %d\n", np.array(TRIANGLES) + 1)
OBJ_QUADS = V_LINES + lines("f %d %d %d %d\n", np.array(QUADS) + 1)
OFF_BODY = POINTS + lines("3 %d %d %d\n", TRIANGLES)
OFF = "OFF\n8 12 18\n" + OFF_BODY
STL = (
    "solid box\n"
    + "".join(
        "facet normal 0 0 0\n outer loop\n" + lines("  vertex %g %g %g\n", VERTICES[list(t)]) + " endloop\nendfacet\n"
        for t in TRIANGLES
    )
    + "endsolid box\n"
)
STL_BODY = b"".join(struct.pack("<12fH", 0, 0, 0, *VERTICES[list(t)].ravel(), 0) for t in TRIANGLES)


def off_with(magic, of_vertex="", of_face=""):
    faces = lines("3 %d %d %d" + of_face + "\n", TRIANGLES)
    return magic + "\n8 12 0\n" + lines("%g %g %g" + of_vertex + "\n", VERTICES) + faces


def stl_binary(head=b"made by a program", count=12, more=b""):
    return head.ljust(80) + struct.pack("<I", count) + STL_BODY + more


def ply_header(encoding, real="float", index="list uchar int", names="xyz", faces="vertex_indices", element="face 12"):
    properties = "".join(f"property {real} {name}\n" for name in names)
    return (
        f"ply\nformat {encoding} 1.0\nelement vertex 8\n{properties}"
        f"element {element}\nproperty {index} {faces}\nend_header\n"
    )


PLY = ply_header("ascii") + OFF_BODY
CODES = dict(zip(["char", "uchar", "short", "ushort", "int", "uint", "float", "double"], "bBhHiIfd", strict=True))


def ply_binary(order="<", real="float", count="uchar", index="int", **header):
    encoding = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    whole = VERTICES.astype(int) if real in ("char", "int") else VERTICES
    data = b"".join(struct.pack(order + 3 * CODES[real], *v) for v in whole.tolist())
    data += b"".join(struct.pack(order + CODES[count] + 3 * CODES[index], 3, *t) for t in TRIANGLES)
    return ply_header(encoding, real, f"list {count} {index}", **header).encode() + data


PLY_STRIPS = ply_header("ascii", index="list int int", element="tristrips 1")


def ply_strips(order):
    encoding = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    data = VERTICES.astype(order + "f4").tobytes() + struct.pack(order + "i", len(STRIPS))
    data += np.array(STRIPS, order + "i4").tobytes()
    return ply_header(encoding, index="list int int", element="tristrips 1").encode() + data


BOM = "\ufeff"
EDGES = "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
DIALECTS = {
    "obj": ("obj", OBJ),
    "obj, quads": ("obj", OBJ_QUADS),
    "obj, byte order mark": ("obj", BOM + OBJ),
    "obj, Windows": ("obj", OBJ.replace("\n", "\r\n")),
    "obj, old Macintosh": ("obj", OBJ.replace("\n", "\r")),
    "obj, tabs": ("obj", OBJ.replace(" ", "\t \t")),
    "obj, capitals": ("obj", OBJ.upper()),
    "obj, no last line end": ("obj", OBJ.rstrip()),
    "obj, continued": ("obj", OBJ.replace("f 1 2 4\n", "f 1 2 \\\n4\n")),
    "obj, continued at once": ("obj", OBJ.replace("f 1 2 4\n", "f 1\\\n 2\\\n4\n")),
    "obj, continued, Windows": ("obj", OBJ.replace("f 1 2 4\n", "f 1 2\\\n4\n").replace("\n", "\r\n")),
    "obj, continued vertex and normal": ("obj", "vn 0 0\\\n1\n" + OBJ.replace("v 0 0 1\n", "v 0 \\\n 0 1\n")),
    "obj, comment that ends with a backslash": ("obj", "# c:\\\n" + OBJ.replace("f 1 2 4\n", "f 1 2 4 # c:\\\n")),
    "obj, name that ends with a backslash": ("obj", "g c:\\\n" + OBJ),
    "obj, textures and normals": ("obj", "vt 0 0\nvn 0 0 1\n" + OBJ.replace("f 1 2 4", "f 1/1/1 2//1 4/1")),
    "obj, negative": ("obj", V_LINES + lines("f %d %d %d\n", np.array(TRIANGLES) - 8)),
    "obj, faces first": ("obj", lines("f %d %d %d\n", np.array(TRIANGLES) + 1) + V_LINES),
    "obj, colors": ("obj", OBJ.replace("v 0 0 0\n", "v 0 0 0 0.5 0.5 1\n")),
    "obj, names": ("obj", "mtllib a b.mtl\no x\ng\ns off\nusemtl é\n" + OBJ),
    "obj, lines, points, curves": ("obj", OBJ + "l 1 2\np 1\ncurv 0 1 1 2\n"),
    "obj, old faces": ("obj", OBJ.replace("f ", "fo ")),
    "off": ("off", OFF),
    "off, small letters": ("off", OFF.replace("OFF", "off")),
    "off, glued": ("off", OFF.replace("OFF\n", "OFF")),
    "off, one line": ("off", OFF.replace("OFF\n", "OFF ")),
    "off, no magic": ("off", OFF.replace("OFF\n", "")),
    "off, no count of edges": ("off", OFF.replace("8 12 18", "8 12")),
    "off, byte order mark": ("off", BOM + OFF),
    "off, comments and blanks": ("off", "# a\n" + OFF.replace("8 12 18\n", "\n# b\n8 12 18 # c\n\n")),
    "off, old Macintosh": ("off", OFF.replace("\n", "\r")),
    "off, colors": ("off", off_with("COFF", " 255 0 0 255", " 3 1 0 0")),
    "off, normals": ("off", off_with("NOFF", " 0 0 1")),
    "off, textures": ("off", off_with("STOFF", " 0.5 1")),
    "stl": ("stl", STL),
    "stl, capitals": ("stl", STL.upper()),
    "stl, a blank line first": ("stl", "\n \n" + STL),
    "stl, byte order mark": ("stl", BOM + STL),
    "stl, Windows": ("stl", STL.replace("\n", "\r\n")),
    "stl, few lines": ("stl", STL.replace("\n ", " ")),
    "stl, normals that are no numbers": ("stl", STL.replace("0 0 0\n outer", "-1.#IND 1.#QNAN nan\n outer")),
    "stl, two solids": ("stl", STL.replace("endfacet\n", "endfacet\nendsolid box\nsolid more\n", 1)),
    "stl, binary": ("stl", stl_binary()),
    "stl, binary that begins as text": ("stl", stl_binary(b"solid box")),
    "stl, binary without a count": ("stl", stl_binary(count=0)),
    "stl, binary without a count that begins as text": ("stl", stl_binary(b"solid box", count=0)),
    "stl, binary and a byte": ("stl", stl_binary(more=b"\n")),
    "stl, binary and many bytes": ("stl", stl_binary(more=b"x" * 130)),
    "ply": ("ply", PLY),
    "ply, capitals": ("ply", ply_header("ascii", names="XYZ", faces="VERTEX_INDICES") + OFF_BODY),
    "ply, all capitals": ("ply", PLY.upper().replace("ASCII", "ascii")),
    "ply, vertex_index": ("ply", ply_header("ascii", faces="vertex_index") + OFF_BODY),
    "ply, byte order mark": ("ply", BOM + PLY),
    "ply, Windows": ("ply", PLY.replace("\n", "\r\n")),
    "ply, old Macintosh": ("ply", PLY.replace("\n", "\r")),
    "ply, comments": ("ply", PLY.replace("\n", "\ncomment a\n", 1).replace("end_", "comment x\nobj_info y\nend_")),
    "ply, more elements": ("ply", "ply" + EDGES.join(PLY[3:].split("end_header\n")) + "0 1\n"),
    "ply, strips": ("ply", PLY_STRIPS + POINTS + " ".join(map(str, [len(STRIPS), *STRIPS]))),
    "ply, strips, little endian": ("ply", ply_strips("<")),
    "ply, strips, big endian": ("ply", ply_strips(">")),
    "ply, little endian": ("ply", ply_binary()),
    "ply, big endian": ("ply", ply_binary(">")),
    "ply, bytes and shorts": ("ply", ply_binary("<", "char", "ushort", "uchar")),
    "ply, doubles and shorts": ("ply", ply_binary(">", "double", "short", "ushort")),
    "ply, ints": ("ply", ply_binary("<", "int", "uint", "uint")),
    "ply, binary and a line end": ("ply", ply_binary() + b"\r\n"),
    "ply, binary, Windows": ("ply", b"\r\n".join(ply_binary().split(b"\n", 9))),
    "ply, binary, old Macintosh": ("ply", b"\r".join(ply_binary().split(b"\n", 9))),
}


def contents(name):
    """The bytes of a dialect."""
    data = DIALECTS[name][1]
    return data if isinstance(data, bytes) else data.encode()


if __name__ == "__main__":  # seeds for tests/fuzz_readers.cpp: the format's number, then the file
    for number, name in enumerate(DIALECTS):
        kind = bytes([("obj", "off", "ply", "stl").index(DIALECTS[name][0])])
        (Path(sys.argv[1]) / f"seed-{number}").write_bytes(kind + contents(name))
