#!/usr/bin/env python3
"""Line source in a box, solved on the mesh of `mesh --embed` and compared with the logarithmic solution.

  line_source.py [--sizes 8,4,2,1] [--growth 1.3]      one row per edge length at the vessel, in its radii

A vessel of radius 1 and length 20 with the source 1 per length ends in two sides of a box. On the four other sides the solution
is prescribed, the ends have no flux, and the solution is -ln(r) / 2π. Linear elements; the table `OUT_embedding.csv` gives the
load. Needs numpy and scipy, and a release build.
"""
import argparse
import csv
import os
import resource
import subprocess
import tempfile

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

PROGRAM = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "target", "release", "anastomesh")
LENGTH, HALF, SQUARES = 20.0, 20.0, 8
#: Position of the vessel, which is no plane of symmetry of the box.
AXIS = np.array([0.3, -0.7])


def box(path):
    """Writes the box as an OFF file, with the sides divided into squares of two triangles."""
    steps = np.linspace(-HALF, HALF, SQUARES + 1)
    heights = np.linspace(0.0, LENGTH, SQUARES // 2 + 1)
    counts = (SQUARES, SQUARES, SQUARES // 2)
    numbers, points, triangles = {}, [], []

    def number(at):
        if at not in numbers:
            numbers[at] = len(points)
            points.append((steps[at[0]], steps[at[1]], heights[at[2]]))
        return numbers[at]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, counts[axis]):
            for i in range(counts[u]):
                for j in range(counts[v]):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        at = [0, 0, 0]
                        at[axis], at[u], at[v] = end, i + di, j + dj
                        corners.append(number(tuple(at)))
                    a, b, c, d = corners if end else corners[::-1]
                    triangles += [(a, b, c), (a, c, d)]
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(points)} {len(triangles)} 0\n")
        file.writelines(f"{x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in points)
        file.writelines(f"3 {a} {b} {c}\n" for a, b, c in triangles)


def solve(points, tets, pieces):
    """Values at the points: linear elements with the pieces as load."""
    corners = points[tets]
    edges = corners[:, 1:] - corners[:, :1]
    volumes = np.linalg.det(edges) / 6.0
    gradients = np.empty((len(tets), 4, 3))
    gradients[:, 1:] = np.linalg.inv(edges).transpose(0, 2, 1)
    gradients[:, 0] = -gradients[:, 1:].sum(axis=1)
    local = volumes[:, None, None] * (gradients @ gradients.transpose(0, 2, 1))
    rows, columns = np.repeat(tets, 4, axis=1).ravel(), np.tile(tets, (1, 4)).ravel()
    matrix = coo_matrix((local.ravel(), (rows, columns)), (len(points),) * 2).tocsr()
    load = np.zeros(len(points))
    for cell, start, end, length in pieces:
        middle = np.array([*AXIS, LENGTH * (start + end) / 2])
        inner = gradients[cell, 1:] @ (middle - corners[cell, 0])
        np.add.at(load, tets[cell], length * np.concatenate([[1 - inner.sum()], inner]))
    exact = -np.log(np.maximum(distance(points), 1e-9)) / (2 * np.pi)
    held = np.abs(points[:, :2]).max(axis=1) == HALF
    free = ~held
    values = np.where(held, exact, 0.0)
    values[free] = spsolve(matrix[free][:, free].tocsc(), load[free] - matrix[free][:, held] @ values[held])
    return values, exact


def distance(points):
    return np.linalg.norm(points[:, :2] - AXIS, axis=1)


def measure(size, growth, folder):
    organ, network, out = (os.path.join(folder, name) for name in ("box.off", "line.swc", "tissue.npyd"))
    box(organ)
    with open(network, "w", encoding="ascii") as file:
        file.write(f"1 1 {AXIS[0]} {AXIS[1]} 0 1 -1\n2 1 {AXIS[0]} {AXIS[1]} {LENGTH} 1 1\n")
    options = ["--embed", f"--embed-size={size}r", f"--tissue={organ}", f"--tissue-growth={growth}", "-q"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([PROGRAM, "mesh", network, "-o", out, *options], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    points, tets = (np.load(os.path.join(out, f"{name}.npy")) for name in ("points", "tets"))
    with open(os.path.join(folder, "tissue_embedding.csv"), newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    pieces = [(int(r["cell"]), float(r["start"]), float(r["end"]), float(r["length"])) for r in rows]
    values, exact = solve(points, tets, pieces)
    r = distance(points)
    shown = []
    for low, high in ((1.0, 2.0), (2.0, 4.0), (4.0, HALF)):
        ring = (r >= low) & (r < high)
        error = np.sqrt(np.mean((values[ring] - exact[ring]) ** 2)) if ring.any() else float("nan")
        # Relative to the difference between the wall of the vessel and the sides of the box.
        shown.append(f"{100 * error / (np.log(HALF) / (2 * np.pi)):.2f} %")
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    total = sum(piece[3] for piece in pieces)
    row(f"{size:g} r", f"{len(tets):,}", f"{len(pieces):,}", f"{abs(total - LENGTH):.0e}", *shown, f"{seconds:.1f} s")


def row(*cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default="8,4,2,1")
    parser.add_argument("--growth", type=float, default=1.3)
    options = parser.parse_args()
    row("edges", "cells", "pieces", "length error", "error at 1 to 2 r", "2 to 4 r", "beyond", "CPU")
    row(*["---"] * 8)
    with tempfile.TemporaryDirectory() as folder:
        for size in options.sizes.split(","):
            measure(float(size), options.growth, folder)


if __name__ == "__main__":
    main()
