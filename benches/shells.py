"""Meshes with regions for the benchmarks of solvers, their arguments, and matrices of linear tetrahedra."""

import argparse
import subprocess
from pathlib import Path

import meshio
import numpy as np
import scipy.sparse as sparse


def mesh(program, network, target, *options):
    """Runs `anastomesh mesh`, and returns points, tetrahedra, their regions, and the points of each patch."""
    subprocess.run([program, "mesh", network, "-o", target, "-q", *map(str, options)], check=True)
    return read(target)


def read(path):
    data = meshio.read(path)
    names = bytes(np.asarray(data.field_data["region_names"], np.uint8)).decode().split("\0")
    numbers = dict(zip(names, np.asarray(data.field_data["region_ids"]).ravel()))
    labels = bytes(np.asarray(data.field_data["patch_names"], np.uint8)).decode().split("\0")
    patch, triangles = data.cell_data_dict["patch"]["triangle"], data.cells_dict["triangle"]
    patches = {label: triangles[patch == i] for i, label in enumerate(labels) if (patch == i).any()}
    return data.points, data.cells_dict["tetra"], data.cell_data_dict["region"]["tetra"], numbers, patches


def gradients(points, tets):
    """Gradients of the barycentric coordinates (n, 4, 3), and volumes."""
    corners = points[tets]
    edges = corners[:, 1:] - corners[:, :1]
    inner = np.linalg.inv(edges).transpose(0, 2, 1)
    return np.concatenate([-inner.sum(1, keepdims=True), inner], 1), np.abs(np.linalg.det(edges)) / 6


def stiffness(points, tets, coefficient):
    """Matrix of a Laplacian with a coefficient for each tetrahedron."""
    slopes, volumes = gradients(points, tets)
    local = np.einsum("nik,njk->nij", slopes, slopes) * (volumes * coefficient)[:, None, None]
    rows, columns = np.repeat(tets, 4, 1).ravel(), np.tile(tets, (1, 4)).ravel()
    return sparse.csr_matrix((local.ravel(), (rows, columns)), shape=(len(points),) * 2), volumes


def solve(matrix, load, fixed, values):
    """Solution of a symmetric system with fixed unknowns."""
    import scipy.sparse.linalg as linear

    found = np.zeros(len(load))
    found[fixed] = values
    free = np.setdiff1d(np.flatnonzero(np.asarray(abs(matrix).sum(1)).ravel() > 0), fixed)
    inner = matrix[free]
    block = inner[:, free].tocsc()
    right = load[free] - inner @ found
    scale = sparse.diags(1 / block.diagonal())
    answer, code = linear.cg(block, right, M=scale, rtol=1e-10, maxiter=20000)
    if code != 0:
        raise RuntimeError("conjugate gradients do not converge")
    found[free] = answer
    return found


def arguments(text, rho, bar):
    """Parser of a benchmark with its default resolutions and bar."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", default="anastomesh")
    parser.add_argument("--rho", default=rho)
    parser.add_argument("--bar", type=float, default=bar)
    return parser


def rows(args, row):
    """Result of a row for each resolution."""
    args.folder.mkdir(parents=True, exist_ok=True)
    return [row(args, int(rho)) for rho in args.rho.split(",")]
