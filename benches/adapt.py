#!/usr/bin/env python3
"""Meshes adapted by `mesh --sizes-from` beside uniform ones: errors of linear elements, as tables in Markdown.

    python3 benches/adapt.py [--program PATH] [--judge ../shared/judge] [--work DIR] [--cases moderate,severe,kidney] [--growth 2]

Cases: tubes of radius 1 and length 20 with a stenosis of length 8 in the middle, and kidney/subtree_59_inlet.swc. The stenoses
take 30 % (moderate) and 60 % (severe) of the diameter. Tubes are meshed with --keep-points.

Stokes flow with stabilised P1-P1 elements of NGSolve (those of stokes.py), viscosity 1, pressure 1 at the inlet and 0 at outlets.
Uniform meshes have one --rho. Adapted meshes begin with that of the first --rho. In each of two rounds, edge_length.py estimates
edge lengths on the last mesh for --growth times as many tetrahedra. `mesh` makes the next one with `--sizes-from`.
The row `shorter by 0.7` has 0.7 times the edge lengths of the first mesh everywhere: `--sizes-from` without adaptation.

Reference of tubes: axisymmetric P4-P3 elements on the given profile. Reference of the kidney: isoparametric P2-P1 elements on a
second-order mesh (`--order 2`). Errors are those of

    gradient      the velocity gradient: L2 norm of the difference over that of the reference
    shear         the wall shear stress, in the same way over the wall
    conductance   the flow through all outlets
    elements      the same, compared with P2-P1 elements on the same mesh: without the error of the wall's position

Sample points lie at random in the reference's elements. Points outside a mesh take the nearest element. The first three errors
thus include those of the geometry.

`share` is the number of tetrahedra over that of a uniform mesh with the same error: below 1, adaptation pays. It is interpolated
between the uniform meshes, error and number as logarithms. With a `*` it is extrapolated from the two nearest uniform meshes.

--work keeps uniform meshes, their solutions and the reference; clear it after a change of the program. --judge adds a check of
each adapted mesh by mesh_judge.py, and of its flow by stokes.py. Progress goes to stderr. Needs ngsolve, meshio, numpy, pyvista.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from second_order_flow import EDGES, curved_mesh, load

HERE = pathlib.Path(__file__).resolve().parent
SIZES = HERE.parent / "python/examples/edge_length.py"
KIDNEY = HERE.parent.parent / "shared/data/kidney/subtree_59_inlet.swc"
#: Length of tubes, half the length of a stenosis, and distance of the points of the axis. With HALF = 2 and STEP = 0.1, the wall
#: of meshes is up to 4 % off the given radii, and errors of the geometry hide those of elements.
LENGTH, HALF, STEP = 20.0, 4.0, 0.5
#: Share of the diameter that a stenosis takes.
STENOSES = {"moderate": 0.3, "severe": 0.6}
#: Resolutions of uniform meshes, and that of the kidney's reference.
RHO = {"moderate": "2.5,3,4,5,6,8", "severe": "2.5,3,4,5,6,8", "kidney": "2.5,3,4,5"}
REFERENCE = "4"
#: Edge lengths of the row without adaptation, relative to those of the first mesh.
SHORTER = 0.7
ROUNDS = 2
#: Minimum number of sample points. Errors change by at most 0.5 % of their value with ten times as many.
SAMPLES = 100_000
#: Corners of the faces of a tetrahedron.
FACES = [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]


def said(command, codes=(0,)):
    done = subprocess.run(["nice", *(str(word) for word in command)], capture_output=True, text=True)
    if done.returncode not in codes:
        sys.exit(f"{command}: {(done.stderr or done.stdout)[-2000:]}")
    return done.stdout + done.stderr


def network(case, folder):
    if case == "kidney":
        return KIDNEY
    path = folder / "network.swc"
    heights = np.linspace(0, LENGTH, round(LENGTH / STEP) + 1)
    # The ends need one point only.
    from_middle = np.abs(heights - LENGTH / 2)
    heights = heights[(from_middle < HALF + STEP / 2) | (from_middle > LENGTH / 2 - STEP / 2)]
    bump = np.where(np.abs(heights - LENGTH / 2) < HALF, 1 + np.cos(np.pi * (heights - LENGTH / 2) / HALF), 0)
    rows = zip(heights, 1 - STENOSES[case] / 2 * bump, strict=True)
    path.write_text("".join(f"{i + 1} 2 0 0 {z:.15g} {r:.15g} {i or -1}\n" for i, (z, r) in enumerate(rows)))
    return path


# ---- Flow ---------------------------------------------------------------------------------------------------------------------


@dataclass
class Solution:
    """Velocity at the nodes of a mesh, and the flow through all outlets."""

    points: np.ndarray
    tets: np.ndarray
    wall: np.ndarray
    velocity: np.ndarray
    flow: float


def solved(path, order):
    """Stokes flow through a mesh: stabilised P1-P1 elements, or P2-P1."""
    import ngsolve as ng

    kept = path.with_name(f"{path.stem}_p{order}.npz")
    if kept.exists():
        with np.load(kept) as file:
            return Solution(**{name: file[name] for name in file})
    points, tets, triangles, labels, names = load(path)
    mesh = curved_mesh(points, tets, triangles, labels, names)
    velocities = ng.VectorH1(mesh, order=order, dirichlet="wall")
    space = velocities * ng.H1(mesh, order=1)
    (u, p), (v, q) = space.TnT()
    volume = ng.dx(bonus_intorder=4 if order == 2 else 0)
    form = ng.InnerProduct(ng.Grad(u), ng.Grad(v)) * volume - (ng.div(u) * q + ng.div(v) * p) * volume
    if order == 1:
        form -= ng.specialcf.mesh_size**2 / 12 * ng.InnerProduct(ng.grad(p), ng.grad(q)) * volume
    else:
        form -= 1e-10 * p * q * volume
    normal = ng.specialcf.normal(3)
    matrix = ng.BilinearForm(form, symmetric=True).Assemble().mat
    right = ng.LinearForm(-normal * v.Trace() * ng.ds("inlet.*")).Assemble().vec
    found = ng.GridFunction(space)
    inverse = matrix.Inverse(space.FreeDofs(), "sparsecholesky")
    found.vec.data = inverse * right
    found.vec.data += inverse * (right - matrix * found.vec).Evaluate()
    flow = ng.Integrate(found.components[0] * normal * ng.ds("outlet.*", bonus_intorder=4), mesh)
    wall = triangles[np.array(names)[labels] == "wall"]
    solution = Solution(points, tets, wall, nodal(found.components[0], mesh, points, tets), flow)
    np.savez(kept, **vars(solution))
    return solution


def nodal(velocity, mesh, points, tets):
    """Velocity at vertices and midpoints."""
    import ngsolve as ng

    values = np.zeros((len(points), 3))
    for k in range(3):
        component = velocity.components[k]
        coefficients = component.vec.FV().NumPy()
        values[: mesh.nv, k] = coefficients[: mesh.nv]
        if tets.shape[1] == 10:
            # The function of an edge is -1/8 at its midpoint.
            of_edge = {tuple(sorted(end.nr for end in edge.vertices)): edge.nr for edge in mesh.edges}
            dofs = np.array([component.space.GetDofNrs(ng.NodeId(ng.EDGE, i))[0] for i in range(len(of_edge))])
            for (i, j), middle in zip(EDGES, range(4, 10), strict=True):
                edges = np.array([of_edge[tuple(pair)] for pair in np.sort(tets[:, [i, j]], axis=1).tolist()])
                values[tets[:, middle], k] = values[tets[:, [i, j]], k].mean(axis=1) - coefficients[dofs[edges]] / 8
    return values


# ---- Gradient and wall shear --------------------------------------------------------------------------------------------------


@dataclass
class Samples:
    """Places in tetrahedra by barycentric coordinates, with the velocity gradient and the derivatives of the position there."""

    points: np.ndarray
    gradient: np.ndarray
    jacobian: np.ndarray


def sampled(solution, tets, at):
    """Samples of the tetrahedra with these indices at the barycentric coordinates `at`, of shape (count, 4)."""
    slopes = np.concatenate([-np.ones((1, 3)), np.eye(3)])
    if solution.tets.shape[1] == 4:
        values, shape = at, np.broadcast_to(slopes, (len(at), 4, 3))
    else:
        i, j = np.array(EDGES).T
        values = np.concatenate([at * (2 * at - 1), 4 * at[:, i] * at[:, j]], axis=1)
        middles = 4 * (at[:, i, None] * slopes[j] + at[:, j, None] * slopes[i])
        shape = np.concatenate([(4 * at[:, :, None] - 1) * slopes, middles], axis=1)
    nodes = solution.points[solution.tets[tets]]
    jacobian = np.einsum("kni,knj->kij", nodes, shape)
    gradient = np.einsum("kni,knj->kij", solution.velocity[solution.tets[tets]], shape) @ np.linalg.inv(jacobian)
    return Samples(np.einsum("kn,kni->ki", values, nodes), gradient, jacobian)


def behind_wall(solution):
    """Tetrahedron and number of its face, for each triangle of the wall."""

    def key(corners):
        return np.sort(corners, axis=1).astype(np.int64) @ [len(solution.points) ** 2, len(solution.points), 1]

    keys = key(solution.tets[:, FACES].reshape(-1, 3))
    order = np.argsort(keys)
    found = order[np.searchsorted(keys[order], key(solution.wall[:, :3]))]
    return found // 4, found % 4


def wall_shear(solution, tets, faces, at):
    """Places, Jacobian determinants and wall shear stresses (vectors) at barycentric coordinates of faces, shape (count, 3)."""
    in_tet, corners = np.zeros((len(tets), 4)), np.array(FACES)[faces]
    np.put_along_axis(in_tet, corners, at, axis=1)
    samples = sampled(solution, tets, in_tet)
    slopes = np.concatenate([np.zeros((len(tets), 3, 1)), samples.jacobian], axis=2).transpose(0, 2, 1)
    a, b, c = (np.take_along_axis(slopes, corners[:, k, None, None], axis=1)[:, 0] for k in range(3))
    normal = np.cross(b - a, c - a)
    double_area = np.linalg.norm(normal, axis=1)
    # The normal points into the lumen.
    inwards = solution.points[solution.tets[tets, :4]].mean(axis=1) - samples.points
    normal *= (np.sign((normal * inwards).sum(axis=1)) / double_area)[:, None]
    return samples.points, double_area, tangential(samples.gradient, normal)


def tangential(gradient, normal):
    """Tangential part of the viscous stress on a surface."""
    traction = np.einsum("kij,kj->ki", gradient + gradient.transpose(0, 2, 1), normal)
    return traction - (traction * normal).sum(axis=1, keepdims=True) * normal


def norm(values, weights):
    return math.sqrt((weights * (values.reshape(len(values), -1) ** 2).sum(axis=1)).sum())


class Reference:
    """Random places with the gradient and the wall shear there, and the flow."""

    def errors(self, other, same_mesh):
        """Errors of a linear solution: gradient, wall shear, conductance, conductance beside P2-P1 elements on the same mesh."""
        grid = pv.UnstructuredGrid({pv.CellType.TETRA: other.tets}, other.points)
        cell = grid.find_containing_cell(self.points)
        cell[cell < 0] = grid.find_closest_cell(self.points[cell < 0])
        gradient = sampled(other, slice(None), np.full((len(other.tets), 4), 0.25)).gradient[cell]
        surface = pv.PolyData.from_regular_faces(other.points, other.wall)
        shear = wall_shear(other, *behind_wall(other), np.full((len(other.wall), 3), 1 / 3))[2]
        return [
            norm(gradient - self.gradient, self.volume) / norm(self.gradient, self.volume),
            norm(shear[surface.find_closest_cell(self.wall)] - self.shear, self.area) / norm(self.shear, self.area),
            float(other.flow / self.flow - 1),
            float(other.flow / same_mesh.flow - 1),
        ]


class MeshReference(Reference):
    """A solution of P2-P1 elements."""

    def __init__(self, solution):
        self.flow, random = solution.flow, np.random.default_rng(1)
        tets = np.tile(np.arange(len(solution.tets)), math.ceil(SAMPLES / len(solution.tets)))
        samples = sampled(solution, tets, random.dirichlet(np.ones(4), len(tets)))
        self.points, self.gradient = samples.points, samples.gradient
        self.volume = np.abs(np.linalg.det(samples.jacobian))
        tets, faces = (np.tile(found, math.ceil(SAMPLES / len(solution.wall))) for found in behind_wall(solution))
        self.wall, self.area, self.shear = wall_shear(solution, tets, faces, random.dirichlet(np.ones(3), len(tets)))


class AxisymmetricReference(Reference):
    """Flow through a tube along z with a piecewise linear radius."""

    def __init__(self, heights, radii):
        import ngsolve as ng

        velocity, mesh = axisymmetric(heights, radii)
        self.flow = 2 * math.pi * ng.Integrate(velocity[0] * ng.y * ng.ds("outlet"), mesh)
        random = np.random.default_rng(1)
        z, angle = random.uniform(heights[0], heights[-1], SAMPLES), random.uniform(0, 2 * math.pi, SAMPLES)
        most = np.interp(z, heights, radii)
        self.volume = most**2
        self.points, self.gradient = self.at(velocity, mesh, z, most * np.sqrt(random.uniform(1e-6, 1, SAMPLES)), angle)
        # The wall: just inside, with the normal of the cone.
        self.wall, gradient = self.at(velocity, mesh, z, most * (1 - 1e-9), angle)
        slope = (np.diff(radii) / np.diff(heights))[np.searchsorted(heights, z) - 1]
        self.area = most * np.hypot(1, slope)
        normal = np.stack([-np.cos(angle), -np.sin(angle), slope], axis=1) / np.hypot(1, slope)[:, None]
        self.shear = tangential(gradient, normal)

    @staticmethod
    def at(velocity, mesh, z, r, angle):
        """Positions and velocity gradients in space."""
        import ngsolve as ng

        place = mesh(z, r)
        axial, radial, ring = (np.asarray(f(place)) for f in (ng.grad(velocity[0]), ng.grad(velocity[1]), velocity[1]))
        zero = np.zeros_like(z)
        local = np.array([[radial[:, 1], zero, radial[:, 0]], [zero, ring[:, 0] / r, zero], [axial[:, 1], zero, axial[:, 0]]])
        cos, sin = np.cos(angle), np.sin(angle)
        turn = np.array([[cos, -sin, zero], [sin, cos, zero], [zero, zero, zero + 1]])
        gradient = np.einsum("iak,abk,jbk->kij", turn, local, turn)
        return np.stack([r * cos, r * sin, z], axis=1), gradient


def axisymmetric(heights, radii):
    """Axial and radial velocity of P4-P3 elements, and their mesh: x along the tube, y the radius."""
    import ngsolve as ng
    from netgen.geom2d import SplineGeometry

    outline = SplineGeometry()
    corners = [(heights[0], 0), *zip(heights, radii, strict=True), (heights[-1], 0)]
    ids = [outline.AppendPoint(*corner) for corner in corners]
    names = ["inlet", *["wall"] * (len(heights) - 1), "outlet", "axis"]
    for i, name in enumerate(names):
        outline.Append(["line", ids[i], ids[(i + 1) % len(ids)]], bc=name, leftdomain=0, rightdomain=1)
    mesh, r = ng.Mesh(outline.GenerateMesh(maxh=0.1)), ng.y
    axials, radials = ng.H1(mesh, order=4, dirichlet="wall"), ng.H1(mesh, order=4, dirichlet="wall|axis")
    space = axials * radials * ng.H1(mesh, order=3)
    (w, u, p), (y, v, q) = space.TnT()
    dx = ng.dx(bonus_intorder=6)
    form = (ng.grad(w) * ng.grad(y) * r + ng.grad(u) * ng.grad(v) * r + u * v / r - 1e-12 * p * q * r) * dx
    form -= ((ng.grad(w)[0] * r + ng.grad(u)[1] * r + u) * q + (ng.grad(y)[0] * r + ng.grad(v)[1] * r + v) * p) * dx
    matrix = ng.BilinearForm(form).Assemble().mat
    right = ng.LinearForm(y * r * ng.ds("inlet")).Assemble().vec
    found = ng.GridFunction(space)
    inverse = matrix.Inverse(space.FreeDofs(), "umfpack")
    found.vec.data = inverse * right
    found.vec.data += inverse * (right - matrix * found.vec).Evaluate()
    return found.components[:2], mesh


# ---- Meshes -------------------------------------------------------------------------------------------------------------------


def meshed(given, path, out, *options):
    keep = [] if path == KIDNEY else ["--keep-points"]
    return said([given.program, "mesh", path, "-o", out, "-j", "1", *keep, *options], codes=(0, 1))


def uniform(given, path, folder, rho, order=1):
    """Mesh with one resolution."""
    mesh = folder / f"{'reference' if order == 2 else 'uniform'}_{rho}.vtu"
    if not mesh.exists():
        meshed(given, path, mesh, "--rho", rho, "--order", order, "-q")
    return mesh


def resized(given, path, rho, sizes, out):
    """Mesh with the edge lengths of a file."""
    for order in (1, 2):
        out.with_name(f"{out.stem}_p{order}.npz").unlink(missing_ok=True)
    log = meshed(given, path, out, "--rho", rho, "--sizes-from", sizes, "--array", "edge_length")
    print("".join(f"    {line}\n" for line in log.splitlines()), file=sys.stderr, flush=True)
    if given.judge:
        judged(given, out, solved(out, 1).flow)
    return out


def shorter(given, path, folder, rho):
    """Mesh with shorter edges everywhere."""
    sys.path.insert(0, str(SIZES.parent))
    import edge_length

    grid = pv.read(folder / f"uniform_{rho}.vtu")
    corners, _ = edge_length.corners_of(grid)
    elements = edge_length.Tetrahedra.of(np.asarray(grid.points, float), corners)
    grid.point_data["edge_length"] = SHORTER * elements.nodal_mean(elements.lengths(), np.ones(len(corners)))
    grid.save(folder / "shorter_sizes.vtu")
    return resized(given, path, rho, folder / "shorter_sizes.vtu", folder / "shorter.vtu")


def adapted(given, path, folder, rho, of):
    """Meshes of the rounds."""
    last = folder / f"uniform_{rho}.vtu"
    for number in range(1, ROUNDS + 1):
        result, sizes, out = (folder / f"{of}_{number}{end}.vtu" for end in ("_result", "_sizes", ""))
        grid = pv.read(last)
        grid.point_data["velocity"] = solved(last, 1).velocity
        grid.save(result)
        print(said([sys.executable, SIZES, result, "-o", sizes, "--velocity", "velocity", "--of", of,
                    "--growth-of-elements", given.growth]).strip(), file=sys.stderr)
        last = resized(given, path, rho, sizes, out)
        yield last


def judged(given, mesh, flow):
    found = json.loads(said([sys.executable, f"{given.judge}/mesh_judge.py", mesh]))
    other = json.loads(said([sys.executable, f"{given.judge}/stokes.py", mesh, "--order", "1"]))
    total = sum(value for name, value in other["flow"].items() if name.startswith("outlet"))
    print(f"    judge: problems {found['problems']}, flow {total / flow - 1:+.1e} of ours", file=sys.stderr)


def share(count, error, curve):
    """Number of tetrahedra over that of a uniform mesh with this error."""
    counts, errors = np.log([curve[0], np.abs(curve[1])])
    wish = math.log(abs(error))
    # Errors fall along the curve.
    last = len(errors) - 1
    i = int(np.clip(np.searchsorted(-errors, -wish), 1, last))
    at = counts[i - 1] + (counts[i] - counts[i - 1]) * (wish - errors[i - 1]) / (errors[i] - errors[i - 1])
    return f"{count / math.exp(at):.2f}" + ("" if errors[last] <= wish <= errors[0] else "*")


NAMES = ["gradient", "shear", "conductance", "elements"]


def table(given, case, folder):
    folder.mkdir(parents=True, exist_ok=True)
    path = network(case, folder)
    if case == "kidney":
        reference = MeshReference(solved(uniform(given, path, folder, given.reference, order=2), 2))
    else:
        profile = np.loadtxt(path)
        reference = AxisymmetricReference(profile[:, 4], profile[:, 5])
    resolutions, curves = (given.rho or RHO[case]).split(","), [[] for _ in NAMES]
    print(f"\nConductance of the reference: {reference.flow:.6g}\n")
    print(f"| {case} | tetrahedra | {' | '.join(f'{name} | share' for name in NAMES)} |")
    print("|" + "---|" * (2 + 2 * len(NAMES)), flush=True)

    def row(name, mesh, cells):
        solution = solved(mesh, 1)
        errors = reference.errors(solution, solved(mesh, 2))
        shares = cells(len(solution.tets), errors)
        both = " | ".join(f"{100 * error:.2f} % | {share}" for error, share in zip(errors, shares, strict=True))
        print(f"| {name} | {len(solution.tets):,} | {both} |", flush=True)
        return len(solution.tets), errors

    for rho in resolutions:
        count, errors = row(f"ρ = {rho}", uniform(given, path, folder, rho), lambda *_: [""] * len(NAMES))
        for curve, error in zip(curves, errors, strict=True):
            curve.append((count, error))

    def shares(count, errors):
        return [share(count, error, np.array(curve).T) for error, curve in zip(errors, curves, strict=True)]

    row(f"shorter by {SHORTER}", shorter(given, path, folder, resolutions[0]), shares)
    for of in ("gradient", "shear"):
        for number, mesh in enumerate(adapted(given, path, folder, resolutions[0], of), start=1):
            row(f"`--of {of}`, round {number}", mesh, shares)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", default="target/release/anastomesh")
    options.add_argument("--judge", help="folder of mesh_judge.py and stokes.py")
    options.add_argument("--work", help="folder that keeps meshes and solutions")
    options.add_argument("--cases", default="moderate,severe,kidney")
    options.add_argument("--growth", type=float, default=2.0, help="of the number of tetrahedra in a round")
    options.add_argument("--rho", help="of uniform meshes; adapted ones begin with the first")
    options.add_argument("--reference", default=REFERENCE, help="ρ of the kidney's reference")
    given = options.parse_args()
    import ngsolve

    ngsolve.SetNumThreads(1)
    with tempfile.TemporaryDirectory() as folder:
        for case in given.cases.split(","):
            table(given, case, pathlib.Path(given.work or folder).resolve() / case)


if __name__ == "__main__":
    main()
