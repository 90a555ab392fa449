#!/usr/bin/env python3
"""Network in arrays, mesh with progress bars, and a picture of it.

python vessels.py [PICTURE.png]
"""

import sys

import anastomesh
import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]

nodes: list[Vector] = [np.zeros(3)]
edges: list[tuple[int, int]] = []
radii = [1.0]


def grow(start: int, direction: Vector, length: float, radius: float, levels: int) -> None:
    """Adds a vessel and the tree at its end, whose bifurcation planes alternate."""
    nodes.append(nodes[start] + length * direction)
    radii.append(radius)
    end = len(nodes) - 1
    edges.append((start, end))
    if levels:
        side = np.cross(direction, [1.0, 0, 0] if levels % 2 else [0, 1.0, 0])
        side /= np.linalg.norm(side)
        for sign, share in ((1, 0.85), (-1, 0.75)):
            turned = direction + sign * 0.7 * side
            # Murray's law, with branches of different size.
            grow(end, turned / np.linalg.norm(turned), 0.8 * length, share * radius, levels - 1)


grow(0, np.array([0, 0, 1.0]), 14.0, 1.0, 4)
network = (np.array(nodes), np.array(edges), np.array(radii))

mesh = anastomesh.mesh(network, progress=True)
print(f"{mesh}, {len(mesh.patches) - 2} outlets")
print(f"valid: {anastomesh.check(mesh).valid}")

picture = sys.argv[1] if len(sys.argv) > 1 else "vessels.png"
anastomesh.render(mesh, picture, network=network, color="radius", clip="y")
