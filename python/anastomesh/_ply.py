"""Binary PLY files as the program writes them."""

from __future__ import annotations

import numpy as np

from ._arrays import Floats, Ints

_POINT = np.dtype([("at", "<f8", (3,))])
_CORNERS = [("count", "u1"), ("corners", "<i4", (3,))]
_MARKER = ("marker", "<i4")


def write(path: str, points: Floats, triangles: Ints, markers: Ints | None) -> None:
    """Writes a surface; ``markers`` become the property ``patch`` of its triangles."""
    faces = np.zeros(len(triangles), np.dtype(_CORNERS + ([] if markers is None else [_MARKER])))
    faces["count"] = 3
    faces["corners"] = triangles
    if markers is not None:
        faces["marker"] = markers
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment anastomesh",
        f"element vertex {len(points)}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {len(triangles)}",
        "property list uchar int vertex_indices",
        *([] if markers is None else ["property int patch"]),
        "end_header",
    ]
    with open(path, "wb") as file:
        file.write("".join(f"{line}\n" for line in header).encode())
        file.write(np.ascontiguousarray(points, "<f8").tobytes())
        file.write(faces.tobytes())


def read(path: str) -> tuple[Floats, Ints, Ints | None]:
    """Points, triangles and, if the file has them, the patches of the triangles."""
    with open(path, "rb") as file:
        header: list[list[str]] = []
        while not header or header[-1] not in (["end_header"], []):
            header.append(file.readline().decode().split())
        sizes = {words[1]: int(words[2]) for words in header if words[0] == "element"}
        labelled = ["property", "int", "patch"] in header
        points = np.fromfile(file, _POINT, sizes["vertex"])["at"]
        faces = np.fromfile(file, np.dtype(_CORNERS + ([_MARKER] if labelled else [])), sizes["face"])
    return points, faces["corners"].copy(), faces["marker"].copy() if labelled else None
