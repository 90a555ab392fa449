#!/usr/bin/env python3
"""Inflation of a thick-walled tube against Lame's solution, as a table in Markdown.

    python3 benches/lame.py FOLDER [--program PATH] [--rho 4,6] [--poisson 0.3] [--bar 0.02]

A straight vessel has a wall of 0.5 r, and the lumen is left out (`--wall 0.5r --without lumen`). The pressure of the lumen acts
on its surface, and the ends do not move along the axis (plane strain). Quadratic elements with straight edges on the tetrahedra of
the wall. Errors are the largest of the radial displacement at a point, relative to the largest exact one. Exit code 1 if the error
at the finest resolution exceeds the bar. Needs numpy, scipy and meshio."""

import sys

import numpy as np
import scipy.sparse as sparse

import shells

INNER, OUTER, LENGTH = 1.0, 1.5, 3.0
MODULUS, PRESSURE = 1.0, 1e-3
EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])
# Four points of a rule of second order in a tetrahedron.
NEAR, FAR = (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20


def lame(radius, poisson):
    """Exact radial displacement in plane strain (Lame and Clapeyron 1831)."""
    scale = (1 + poisson) * PRESSURE * INNER**2 / (MODULUS * (OUTER**2 - INNER**2))
    return scale * ((1 - 2 * poisson) * radius + OUTER**2 / radius)


def midpoints(points, tets):
    """Points with those of the middle of edges, quadratic tetrahedra, and middles by their ends."""
    ends = np.sort(tets[:, EDGES].reshape(-1, 2), 1)
    unique, index = np.unique(ends, axis=0, return_inverse=True)
    middles = {tuple(pair): len(points) + i for i, pair in enumerate(unique)}
    every = np.vstack([points, points[unique].mean(1)])
    return every, np.hstack([tets, len(points) + index.reshape(-1, 6)]), middles


def stiffness(points, tets, quadratic, poisson):
    """Matrix of linear elasticity."""
    slopes, volumes = shells.gradients(points, tets)
    shear = MODULUS / (2 * (1 + poisson))
    bulk = MODULUS * poisson / ((1 + poisson) * (1 - 2 * poisson))
    local = np.zeros((len(tets), 10, 3, 10, 3))
    for k in range(4):
        weights = np.full(4, FAR)
        weights[k] = NEAR
        corners = (4 * weights - 1)[None, :, None] * slopes
        edges = 4 * (weights[EDGES[:, 0]][:, None] * slopes[:, EDGES[:, 1]] + weights[EDGES[:, 1]][:, None] * slopes[:, EDGES[:, 0]])
        g = np.concatenate([corners, edges], 1)
        dot = np.einsum("nak,nbk->nab", g, g)
        part = bulk * np.einsum("nai,nbj->naibj", g, g) + shear * np.einsum("naj,nbi->naibj", g, g)
        part += shear * np.einsum("nab,ij->naibj", dot, np.eye(3))
        local += part * (volumes / 4)[:, None, None, None, None]
    unknowns = (3 * quadratic[:, :, None] + np.arange(3)).reshape(len(tets), 30)
    rows, columns = np.repeat(unknowns, 30, 1).ravel(), np.tile(unknowns, (1, 30)).ravel()
    size = 3 * (quadratic.max() + 1)
    return sparse.csr_matrix((local.ravel(), (rows, columns)), shape=(size, size))


def pressed(points, faces, middles, count):
    """Forces of the pressure on triangles: a third of each triangle's at the middle of each edge."""
    load = np.zeros((count, 3))
    corners = points[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    outwards = np.sign((normal[:, :2] * corners.mean(1)[:, :2]).sum(1))
    for a, b in ((0, 1), (1, 2), (2, 0)):
        at = [middles[tuple(sorted(pair))] for pair in faces[:, [a, b]].tolist()]
        np.add.at(load, at, PRESSURE * normal * outwards[:, None] / 3)
    return load.ravel()


def row(args, rho):
    network = args.folder / "tube.swc"
    network.write_text(f"1 3 0 0 0 {INNER} -1\n2 3 0 0 {LENGTH} {INNER} 1\n")
    options = ["--rho", rho, "--wall", "0.5r", "--wall-layers", max(2, rho // 2), "--without", "lumen"]
    points, tets, _, _, patches = shells.mesh(args.program, network, args.folder / f"lame_{rho}.vtu", *options)
    every, quadratic, middles = midpoints(points, tets)
    matrix = stiffness(points, tets, quadratic, args.poisson)
    faces = next(faces for name, faces in patches.items() if "lumen" in name)
    load = pressed(points, faces, middles, len(every))
    x, y, z = every.T
    at_ends = np.flatnonzero((np.abs(z) < 1e-9) | (np.abs(z - LENGTH) < 1e-9))
    # Two planes of symmetry would hold the tube, but the mesh has none: its rigid motions have a weak spring at the ends.
    spring = np.zeros((len(every), 3))
    spring[at_ends, :2] = 1e-9 * MODULUS
    matrix = matrix + sparse.diags(spring.ravel())
    found = shells.solve(matrix, load, 3 * at_ends + 2, 0.0).reshape(-1, 3)
    used = np.unique(quadratic)
    radius = np.hypot(x, y)[used]
    radial = (found[used, 0] * x[used] + found[used, 1] * y[used]) / radius
    exact = lame(radius, args.poisson)
    error = np.abs(radial - exact).max() / lame(INNER, args.poisson)
    mean = np.sqrt(np.mean((radial - exact) ** 2)) / lame(INNER, args.poisson)
    print(f"| {rho} | {len(tets):,} | {mean:.2%} | {error:.2%} |", flush=True)
    return error


def main():
    parser = shells.arguments(__doc__, "4,6", 0.02)
    parser.add_argument("--poisson", type=float, default=0.3)
    args = parser.parse_args()
    print("| ρ | tetrahedra | root mean square error | largest error |\n|---|---|---|---|")
    errors = shells.rows(args, row)
    sys.exit(0 if errors[-1] < args.bar else 1)


if __name__ == "__main__":
    main()
