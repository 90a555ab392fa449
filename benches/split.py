#!/usr/bin/env python3
"""Meshes with a surface that may be split, beside TetGen's with the same switches: the table of benches/README.md.

    python3 benches/split.py PROGRAM SURFACE.off... [--switches pAq1.4] [--ratio 1.4] [--limit 60]

Both meshes are judged alike from their `.node`, `.ele` files: tetrahedra whose circumradius exceeds the ratio times their
shortest edge, mean radius ratio, smallest dihedral angle. CPU is that of the whole process (user).
"""
import argparse
import os
import pathlib
import resource
import shutil
import subprocess
import tempfile

import numpy as np


def run(command, limit):
    """CPU seconds of a command; `None` if it fails or exceeds the limit."""
    bound = lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=bound)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime if child.returncode == 0 else None


def table(path, columns):
    """Numbers of the rows of a TetGen file after its header, in columns 1 to `columns`."""
    lines = path.read_text().splitlines()
    count = int(lines[0].split()[0])
    return np.array([line.split()[: columns + 1] for line in lines[1 : count + 1]], dtype=float)


def judged(stem, ratio):
    """Tetrahedra, those above the ratio, mean radius ratio, smallest dihedral angle."""
    points, cells = table(pathlib.Path(f"{stem}.node"), 3), table(pathlib.Path(f"{stem}.ele"), 4)
    corners = points[:, 1:][(cells[:, 1:] - points[0, 0]).astype(int)]
    u, v, w = (corners[:, i] - corners[:, 0] for i in (1, 2, 3))
    volume = np.abs(np.einsum("ij,ij->i", u, np.cross(v, w))) / 6 + 1e-300
    squares = [(x * x).sum(1)[:, None] for x in (u, v, w)]
    radius = np.linalg.norm(
        squares[0] * np.cross(v, w) + squares[1] * np.cross(w, u) + squares[2] * np.cross(u, v), axis=1
    ) / (12 * volume)
    edges = np.stack([np.linalg.norm(x, axis=1) for x in (u, v, w, v - u, w - u, w - v)])
    normals = [np.cross(u, v), np.cross(v, w), np.cross(w, u), np.cross(w - u, v - u)]
    areas = [np.linalg.norm(n, axis=1) / 2 + 1e-300 for n in normals]
    angles = [
        np.degrees(np.arccos(np.clip(-(normals[i] * normals[j]).sum(1) / (4 * areas[i] * areas[j]), -1, 1))).min()
        for i in range(4)
        for j in range(i)
    ]
    shape = 9 * volume / sum(areas) / radius
    return len(cells), int((radius > 1.0001 * ratio * edges.min(0)).sum()), shape.mean(), min(angles)


def main():
    """Prints one row per surface, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("surfaces", nargs="+", type=pathlib.Path)
    parser.add_argument("--switches", default="pAq1.4")
    parser.add_argument("--ratio", type=float, default=1.4)
    parser.add_argument("--limit", type=int, default=60)
    args = parser.parse_args()
    print("| surface | triangles | CPU, s | tetrahedra | above | mean | min ° | TetGen CPU, s | tetrahedra | above | mean | min ° |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    sums = np.zeros(6)
    for surface in args.surfaces:
        with tempfile.TemporaryDirectory() as folder:
            ours, copy = pathlib.Path(folder) / "ours.ele", pathlib.Path(folder) / "s.off"
            shutil.copy(surface, copy)
            program = [args.program, "tetrahedralize", str(copy), "--tetgen", args.switches, "-o", str(ours)]
            tetgen = ["tetgen", f"-{args.switches}", str(copy)]
            results = []
            for command, stem in [(program, ours.with_suffix("")), (tetgen, copy.with_suffix(".1"))]:
                cpu = run(command, args.limit)
                results.append((cpu, judged(stem, args.ratio)) if cpu is not None else None)
        cells = []
        for result in results:
            if result is None:
                cells += ["-"] * 5
                continue
            cpu, (tets, above, mean, angle) = result
            cells += [f"{cpu:.2f}", f"{tets:,}", f"{above:,}", f"{mean:.3f}", f"{angle:.2f}"]
        if all(results):
            sums += [x for cpu, (tets, above, _, _) in results for x in (cpu, tets, above)]
        triangles = surface.read_text().split()[2]
        print(f"| {surface.stem} | {int(triangles):,} | " + " | ".join(cells) + " |", flush=True)
    names = ["CPU", "tetrahedra", "above"]
    print("both finish:", ", ".join(f"{n} {sums[i]:,.2f} and {sums[i + 3]:,.2f}" for i, n in enumerate(names)))


if __name__ == "__main__":
    main()
