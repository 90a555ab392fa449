#!/usr/bin/env python3
"""From a network in arrays to a mesh and a picture of it, as in a notebook: bars of progress, then the mesh.

python vessels.py [PICTURE.png]
"""

import sys

import anastomesh
import numpy as np
import pyvista


def fork(start, direction, length, radius, levels, nodes, edges, radii):
    """A vessel that parts into two, and these again, in planes that turn."""
    nodes.append(nodes[start] + length * direction)
    radii.append(radius)
    end = len(nodes) - 1
    edges.append((start, end))
    if levels:
        side = np.cross(direction, [1.0, 0, 0] if levels % 2 else [0, 1.0, 0])
        side /= np.linalg.norm(side)
        for sign, share in ((1, 0.85), (-1, 0.75)):
            turned = direction + sign * 0.7 * side
            # Murray's law, with branches of unlike size.
            fork(end, turned / np.linalg.norm(turned), 0.8 * length, share * radius, levels - 1, nodes, edges, radii)


nodes, edges, radii = [np.zeros(3)], [], [1.0]
fork(0, np.array([0, 0, 1.0]), 14.0, 1.0, 4, nodes, edges, radii)

mesh = anastomesh.mesh((np.array(nodes), np.array(edges), np.array(radii)), data=["radius"], progress=True)
print(f"{len(mesh.points)} points, {len(mesh.tets)} tetrahedra, {len(mesh.patches) - 2} outlets")
print(f"valid: {anastomesh.check(mesh).valid}")

plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(1400, 700))
plotter.add_mesh(mesh.boundary_to_pyvista(), scalars="patch", cmap="tab20", show_scalar_bar=False)
plotter.view_xz()
plotter.subplot(0, 1)
plotter.add_mesh(mesh.to_pyvista().clip("y", invert=False, crinkle=True), scalars="radius", show_edges=True, line_width=0.3)
plotter.view_xz()
plotter.camera.zoom(2.5)
plotter.screenshot(sys.argv[1] if len(sys.argv) > 1 else "vessels.png")
