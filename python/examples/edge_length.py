#!/usr/bin/env python3
"""Edge lengths for an adapted mesh, estimated from the velocity on an earlier one.

    anastomesh mesh NETWORK -o coarse.vtu --rho 2.5
    # Solve for the velocity on coarse.vtu. The solver writes result.vtu.
    python edge_length.py result.vtu -o sizes.vtu --velocity NAME --growth-of-elements 2
    anastomesh mesh NETWORK -o adapted.vtu --rho 2.5 --sizes-from sizes.vtu --array edge_length

The error of the velocity gradient is estimated by gradient recovery (Zienkiewicz and Zhu 1987). The gradient G_K of linear
elements is constant in a tetrahedron K. The recovered gradient G* is linear: its value at a vertex is the mean of G_K over the
tetrahedra around it, weighted by volume. The error of an element is e_K = |G* - G_K|, in the L2 norm over K.

    --of gradient   takes the errors of all tetrahedra.
    --of shear      takes those of tetrahedra at the wall only, for the wall shear stress. The others keep their length.
                    A tetrahedron is at the wall if a vertex lies on the boundary and has no velocity.

Elements of degree p have e_K^2 = c h^(2p) h^3 for edges of length h. For a given number of elements N, the error is least with

    h_new = h_old (theta / e_K)^(2 / (2 p + 3)),   p = 1

and one theta for all elements (Almeida et al. 2000, in three dimensions). h_old is the mean edge length of K. Bisection finds
theta for the requested N, which is predicted as the sum of (h_old / h_new)^3. h_new / h_old is at least --shortest and at most
--longest. The default of --longest is 1, as edges of `mesh --sizes-from` are never longer than those of `--rho`.

`mesh` uses one length for each section of a vessel: the lower quartile of those at the points there. It makes more tetrahedra
than predicted where lengths differ within a section.

The velocity is a point array with three components. In second-order tetrahedra, the values at the corners count. The output has
all arrays of the input, and the point array `edge_length`: the geometric mean over the tetrahedra around a point.

References:
O. C. Zienkiewicz, J. Z. Zhu, A simple error estimator and adaptive procedure for practical engineering analysis, IJNME 24, 1987.
O. C. Zienkiewicz, J. Z. Zhu, The superconvergent patch recovery and a posteriori error estimates, IJNME 33, 1992.
R. C. Almeida et al., Adaptive finite element computational fluid dynamics using an anisotropic error estimator, CMAME 182, 2000.

Needs numpy and pyvista.
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista as pv

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

#: Name of the array in the output.
ARRAY = "edge_length"
#: Degree of the elements.
DEGREE = 1
#: Exponent of theta / e_K.
EXPONENT = 2 / (2 * DEGREE + 3)
#: Largest speed of a vertex without velocity, relative to the largest speed in the file. Solvers write float32 at worst.
STILL = 1e-6
#: Estimated error relative to the gradient, below which it is rounding: the velocity is linear.
EXACT = 1e-6
#: VTK's linear and second-order tetrahedra, with their numbers of nodes. The first four nodes are the corners.
TETRAHEDRA = ((10, 4), (24, 10))
#: Corners at the ends of the six edges. Nodes 4 to 9 of second-order tetrahedra are their midpoints in this order.
EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])
#: Corners of the four faces.
FACES = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]


class InputError(Exception):
    """Input that cannot be used, with the reason."""


@dataclass
class Tetrahedra:
    """Linear tetrahedra with their volumes and the gradients of their four shape functions."""

    points: Floats
    corners: Ints
    volumes: Floats
    gradients: Floats

    @classmethod
    def of(cls, points: Floats, corners: Ints) -> Tetrahedra:
        """Computes volumes and gradients."""
        edges = points[corners[:, 1:]] - points[corners[:, :1]]
        volumes = np.abs(np.linalg.det(edges)) / 6
        flat = np.flatnonzero(~(volumes > 1e-14 * np.linalg.norm(edges, axis=2).max(axis=1) ** 3))
        if flat.size:
            raise InputError(f"tetrahedron {flat[0] + 1} has no volume ({flat.size} of {len(corners)}): repair the mesh")
        last = np.linalg.inv(edges).transpose(0, 2, 1)
        return cls(points, corners, volumes, np.concatenate([-last.sum(axis=1, keepdims=True), last], axis=1))

    def lengths(self) -> Floats:
        """Returns the mean edge length of each tetrahedron."""
        ends = self.points[self.corners[:, EDGES]]
        lengths: Floats = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2).mean(axis=1)
        return lengths

    def gradient(self, values: Floats) -> Floats:
        """Returns the gradient of a vector in each tetrahedron: derivative j of component i at [K, i, j]."""
        gradient: Floats = np.einsum("kni,knj->kij", values[self.corners], self.gradients)
        return gradient

    def nodal_mean(self, values: Floats, weights: Floats) -> Floats:
        """Returns the weighted mean over the tetrahedra around each point. It is NaN at points without tetrahedra."""
        flat = values.reshape(len(values), -1)
        nodes, size = self.corners.ravel(), len(self.points)
        total = np.bincount(nodes, np.repeat(weights, 4), size)
        sums = [np.bincount(nodes, np.repeat(weights * column, 4), size) for column in flat.T]
        with np.errstate(invalid="ignore"):
            means: Floats = np.stack(sums, axis=1) / total[:, None]
        return means.reshape(size, *values.shape[1:])

    def on_boundary(self) -> Bools:
        """Returns whether each point lies on the boundary: a face with it belongs to one tetrahedron only."""
        faces = np.sort(self.corners[:, FACES].reshape(-1, 3), axis=1)
        size = len(self.points)
        keys = (faces[:, 0] * size + faces[:, 1]) * size + faces[:, 2]
        _, first, counts = np.unique(keys, return_index=True, return_counts=True)
        found = np.zeros(size, bool)
        found[faces[first[counts == 1]]] = True
        return found

    def at_wall(self, velocity: Floats) -> Bools:
        """Returns whether each tetrahedron has a boundary vertex without velocity."""
        speed = np.linalg.norm(velocity, axis=1)
        still = self.on_boundary() & (speed <= STILL * speed[self.corners].max())
        return np.asarray(still[self.corners].any(axis=1))


def estimated_errors(tetrahedra: Tetrahedra, velocity: Floats) -> Floats:
    """Returns the L2 norm of the difference of recovered gradient and element gradient, for each tetrahedron."""
    gradient = tetrahedra.gradient(velocity)
    recovered = tetrahedra.nodal_mean(gradient, tetrahedra.volumes)
    difference = (recovered[tetrahedra.corners] - gradient[:, None]).reshape(len(gradient), 4, 9)
    # Shape functions have the mass matrix (1 + delta_ij) V / 20.
    squares = (difference**2).sum(axis=(1, 2)) + (difference.sum(axis=1) ** 2).sum(axis=1)
    errors: Floats = np.sqrt(tetrahedra.volumes / 20 * squares)
    return errors


def length_factors(errors: Floats, wish: float, shortest: float, longest: float) -> Floats:
    """Returns h_new / h_old of each element, so that their predicted number is `wish`.

    Elements without error have the longest edges."""
    with np.errstate(divide="ignore"):
        inverse = np.where(errors > 0, 1 / errors, np.inf)

    def factors(theta: float) -> Floats:
        return np.clip((theta * inverse) ** EXPONENT, shortest, longest)

    def predicted(theta: float) -> float:
        return float((factors(theta) ** -3).sum())

    some = errors[errors > 0]
    # Beyond these values of theta, all elements with an error have the longest or the shortest edges.
    low, high = some.min() * shortest ** (1 / EXPONENT), some.max() * longest ** (1 / EXPONENT)
    most, least = predicted(low), predicted(high)
    if not least <= wish <= most:
        raise InputError(f"{wish:,.0f} tetrahedra are out of reach ({least:,.0f} to {most:,.0f}): "
                         "change the number, --shortest or --longest")
    for _ in range(200):
        middle = math.sqrt(low * high)
        if predicted(middle) > wish:
            low = middle
        else:
            high = middle
    return factors(high)


def corners_of(mesh: pv.UnstructuredGrid) -> tuple[Ints, Ints]:
    """Corners of all tetrahedra, and the ten nodes of the second-order ones."""
    cells: dict[Any, Any] = mesh.cells_dict
    first, second = (np.asarray(cells.get(kind, np.empty((0, size))), np.int64) for kind, size in TETRAHEDRA)
    if not len(first) + len(second):
        raise InputError("the mesh has no tetrahedra: give the volume mesh of the lumen")
    return np.concatenate([first, second[:, :4]]), second


def velocity_of(mesh: pv.UnstructuredGrid, name: str, used: Ints) -> Floats:
    """Velocity at points, checked at those of tetrahedra."""
    if name not in mesh.point_data:
        names = ", ".join(f"'{found}'" for found in mesh.point_data) or "none"
        hint = " It is a cell array: convert it to a point array." if name in mesh.cell_data else ""
        raise InputError(f"there is no point array '{name}'; the file has {names}.{hint} Choose with --velocity")
    velocity = np.asarray(mesh.point_data[name], float)
    if velocity.ndim != 2 or velocity.shape[1] != 3:
        count = velocity.size // max(1, len(velocity))
        raise InputError(f"array '{name}' has {count} component{'s' * (count != 1)}: give a vector with 3")
    bad = used[~np.isfinite(velocity[used]).all(axis=1)]
    if bad.size:
        raise InputError(f"array '{name}' is not finite at point {bad[0] + 1} ({bad.size} of {used.size}): check the solution")
    if not velocity[used].any():
        raise InputError(f"array '{name}' is zero everywhere: check the solution")
    return velocity


def add_edge_lengths(
    mesh: pv.UnstructuredGrid,
    name: str,
    of: str = "gradient",
    growth: float = 2.0,
    tetrahedra: float | None = None,
    shortest: float = 0.25,
    longest: float = 1.0,
) -> str:
    """Adds the array `edge_length` to a mesh with the velocity `name`, and returns a summary.

    The number of tetrahedra is `tetrahedra`, or else `growth` times the present one."""
    points = np.asarray(mesh.points, float)
    corners, second = corners_of(mesh)
    used = np.unique(corners)
    if not np.isfinite(points[used]).all():
        raise InputError("a point has a coordinate that is not finite: repair the mesh")
    velocity = velocity_of(mesh, name, used)
    elements = Tetrahedra.of(points, corners)
    errors = estimated_errors(elements, velocity)
    energy = (elements.volumes * (elements.gradient(velocity) ** 2).sum(axis=(1, 2))).sum()
    total = math.sqrt((errors**2).sum() / energy)
    # Tetrahedra away from the wall have no part in the error of the wall shear.
    counted = elements.at_wall(velocity) if of == "shear" else np.ones(len(corners), bool)
    if not counted.any():
        raise InputError(f"array '{name}' is zero at no boundary vertex: --of shear needs a wall without slip")
    if not total > EXACT or not errors[counted].any():
        raise InputError(f"the gradient of array '{name}' has no estimated error: edge lengths cannot be derived from it")
    wish = tetrahedra or growth * len(corners)
    old, factors = elements.lengths(), np.ones(len(corners))
    factors[counted] = length_factors(errors[counted], wish - np.count_nonzero(~counted), shortest, longest)
    lengths = np.exp(elements.nodal_mean(np.log(old * factors), np.ones(len(old))))
    lengths[second[:, 4:]] = np.sqrt(lengths[second[:, EDGES]].prod(axis=2))
    # Points of other cells only.
    lengths[np.isnan(lengths)] = np.nanmax(lengths)
    mesh.point_data[ARRAY] = lengths
    return (
        f"{len(corners):,} tetrahedra, {(factors**-3).sum():,.0f} predicted; estimated gradient error {100 * total:.1f} %; "
        f"edge lengths {old.min():.3g} to {old.max():.3g}, requested {lengths[used].min():.3g} to {lengths[used].max():.3g}"
    )


def positive(text: str) -> float:
    value = float(text)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a finite number above zero")
    return value


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("result", type=Path, metavar="RESULT.vtu", help="mesh with the velocity")
    options.add_argument("-o", "--output", type=Path, required=True, metavar="SIZES.vtu", help="the same mesh with edge lengths")
    options.add_argument("--velocity", required=True, metavar="NAME", help="point array of the velocity")
    options.add_argument("--of", choices=["gradient", "shear"], default="gradient", help="error to reduce (default: gradient)")
    number = options.add_mutually_exclusive_group()
    number.add_argument("--growth-of-elements", type=positive, default=2.0, metavar="F",
                        help="requested number of tetrahedra, relative to the present one (default: 2)")
    number.add_argument("--tetrahedra", type=positive, metavar="N", help="requested number of tetrahedra")
    options.add_argument("--shortest", type=positive, default=0.25, metavar="F", help="minimum of h_new / h_old (default: 0.25)")
    options.add_argument("--longest", type=positive, default=1.0, metavar="F", help="maximum of h_new / h_old (default: 1)")
    given = options.parse_args()
    if given.shortest > given.longest:
        options.error(f"--shortest {given.shortest:g} is above --longest {given.longest:g}")
    try:
        if not given.result.is_file():
            raise InputError("there is no such file")
        try:
            mesh = pv.read(given.result)
        except (OSError, ValueError) as error:
            raise InputError("VTK cannot read this file: give a .vtu file") from error
        if not isinstance(mesh, pv.UnstructuredGrid):
            raise InputError("this is not an unstructured grid: give a .vtu file")
        summary = add_edge_lengths(mesh, given.velocity, given.of, given.growth_of_elements, given.tetrahedra, given.shortest,
                                   given.longest)
    except InputError as error:
        sys.exit(f"{given.result}: {error}")
    mesh.save(given.output)
    print(f"{given.output}: {summary}")


if __name__ == "__main__":
    main()
