#!/usr/bin/env python3
"""Oxygen in the wall and the tissue around a vessel, against Krogh's cylinder, as a table in Markdown.

    python3 benches/oxygen.py FOLDER [--program PATH] [--rho 6,9] [--bar 0.02]

A straight vessel has a wall of 0.2 r and tissue of 2 r (`--wall 0.2r --shell tissue=2r`). Oxygen diffuses from the lumen, with
half the diffusivity in the wall, and the tissue consumes a constant rate. Linear elements on the tetrahedra of both regions are
compared with the exact solution. The error is the largest at a point, relative to the exact drop of the concentration. Exit code 1
if the error at the finest resolution exceeds the bar, or does not fall with the resolution. Needs numpy, scipy and meshio."""

import sys

import numpy as np

import shells

WALL, TISSUE = 0.5, 1.0
RATE = 1.0
INNER, OUTER, EDGE, LENGTH = 1.0, 1.2, 3.2, 6.0


def krogh(radius):
    """Exact drop of the concentration from the lumen (Krogh 1919), with the resistance of a wall."""
    through = RATE * (EDGE**2 - OUTER**2) / (2 * WALL)
    wall = through * np.log(np.clip(radius, INNER, OUTER) / INNER)
    r = np.clip(radius, OUTER, None)
    return wall + RATE / (2 * TISSUE) * (EDGE**2 * np.log(r / OUTER) - (r**2 - OUTER**2) / 2)


def row(args, rho):
    network = args.folder / "tube.swc"
    network.write_text(f"1 3 0 0 0 {INNER} -1\n2 3 0 0 {LENGTH} {INNER} 1\n")
    layers = (round(rho / 3), 2 * rho)
    options = ["--rho", rho, "--wall", "0.2r", "--wall-layers", layers[0], "--shell", f"tissue=2r:{layers[1]}", "--without", "lumen"]
    points, tets, regions, numbers, patches = shells.mesh(args.program, network, args.folder / f"krogh_{rho}.vtu", *options)
    in_tissue = regions == numbers["tissue"]
    matrix, volumes = shells.stiffness(points, tets, np.where(in_tissue, TISSUE, WALL))
    load = np.zeros(len(points))
    np.add.at(load, tets[in_tissue], -RATE * volumes[in_tissue, None] / 4)
    radius = np.hypot(points[:, 0], points[:, 1])
    inner = np.unique(next(faces for name, faces in patches.items() if "lumen" in name))
    found = -shells.solve(matrix, load, inner, 0.0)
    error = np.abs(found - krogh(radius)).max() / krogh(EDGE)
    print(f"| {rho} | {len(tets):,} | {np.abs(radius[inner] - INNER).max():.1e} | {error:.2%} |", flush=True)
    return error


def main():
    parser = shells.arguments(__doc__, "6,9", 0.02)
    args = parser.parse_args()
    print("| ρ | tetrahedra | error of the lumen's radius | error |\n|---|---|---|---|")
    errors = shells.rows(args, row)
    is_good = errors[-1] < args.bar and all(a > b for a, b in zip(errors, errors[1:]))
    sys.exit(0 if is_good else 1)


if __name__ == "__main__":
    main()
