#!/usr/bin/env python3
"""Stokes flow through tubes of linear and second-order elements (`--order 1` and `2`), as a table in Markdown.

    python3 benches/second_order_flow.py [--program PATH] [--rho 3,4] [--tubes straight,bent] [--options ";--joint none"] [--bar 0.2]

P2-P1 elements of NGSolve, isoparametric on second-order meshes; pressure 1 at the inlet, 0 at the outlet. Both tubes have radius 1.
The straight one has length 20 and is compared with Poiseuille's law. The bent one has a quarter of a torus of radius 4 between
two straight pieces of length 5. It is compared with P4-P3 elements of order 4 on the CAD body of OpenCASCADE.

Rows `on the radius` move the nodes of the wall to distance 1 from the axis, and inner vertices by the same factor. They give the error
that is left to the elements. --dolfinx adds rows of Debian's dolfinx 0.5 (python3-dolfinx) for order 2, from XDMF files of meshio.
--options lists options of `mesh`, separated by semicolons. The bent tube has `--axis-tolerance 0.002` unless an option gives another one.
The exit code is 1 if order 2 without options misses the conductance by more than --bar, in percent.
Needs ngsolve, meshio, numpy, scipy; h5py for --dolfinx.
"""

import argparse
import contextlib
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

LENGTH, BEND, PIECE = 20.0, 4.0, 5.0
#: Ends of the midpoints 4 to 9 of a tetrahedron in VTK and meshio.
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


DOLFINX = """
import sys, ufl
import numpy as np
from dolfinx import fem, io
from mpi4py import MPI
with io.XDMFFile(MPI.COMM_WORLD, sys.argv[1], "r") as file:
    domain = file.read_mesh(name="Grid")
domain.topology.create_connectivity(2, 3)
with io.XDMFFile(MPI.COMM_WORLD, sys.argv[2], "r") as file:
    tags = file.read_meshtags(domain, name="Grid")
wall, inlet, outlet = map(int, sys.argv[3:])
cell = domain.ufl_cell()
space = fem.FunctionSpace(domain, ufl.MixedElement([ufl.VectorElement("Lagrange", cell, 2), ufl.FiniteElement("Lagrange", cell, 1)]))
velocities, _ = space.sub(0).collapse()
still = fem.Function(velocities)
dofs = fem.locate_dofs_topological((space.sub(0), velocities), 2, tags.indices[tags.values == wall])
(u, p), (v, q) = ufl.TrialFunctions(space), ufl.TestFunctions(space)
normal, ds = ufl.FacetNormal(domain), ufl.Measure("ds", domain, subdomain_data=tags, metadata={"quadrature_degree": 8})
dx = ufl.dx(domain, metadata={"quadrature_degree": 8})
left = (ufl.inner(ufl.grad(u), ufl.grad(v)) - ufl.div(u) * q - ufl.div(v) * p) * dx
options = {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"}
problem = fem.petsc.LinearProblem(left, -ufl.inner(normal, v) * ds(inlet), [fem.dirichletbc(still, dofs, space.sub(0))], petsc_options=options)
found = problem.solve()
value = lambda form: np.real(fem.assemble_scalar(fem.form(form)))
print("FOUND", value(ufl.inner(found.sub(0), normal) * ds(outlet)), value(fem.Constant(domain, 1.0) * dx))
"""


def of_dolfinx(points, tets, triangles, labels, names, folder):
    """Conductance and volume by Debian's dolfinx."""
    import meshio

    meshio.write(folder / "mesh.xdmf", meshio.Mesh(points, [("tetra10", tets)]))
    meshio.write(folder / "faces.xdmf", meshio.Mesh(points, [("triangle6", triangles)], cell_data={"tags": [labels]}))
    ids = [str(names.index(name)) for name in ("wall", "inlet", "outlet_0")]
    out = subprocess.run(["/usr/bin/python3", "-c", DOLFINX, folder / "mesh.xdmf", folder / "faces.xdmf", *ids], capture_output=True, text=True)
    if "FOUND" not in out.stdout:
        sys.exit(out.stderr)
    return map(float, out.stdout.split("FOUND")[1].split())


def curved_mesh(points, tets, triangles, labels, names):
    """NGSolve mesh of linear or second-order elements. Second-order ones are linear elements with a deformation of order 2.

    Vertices must be numbered before midpoints, as in all files of this program."""
    import netgen.meshing as nm
    import ngsolve

    corners = int(tets[:, :4].max()) + 1
    mesh = nm.Mesh(dim=3)
    mesh.AddPoints(np.ascontiguousarray(points[:corners]))
    mesh.SetMaterial(1, "lumen")
    for j, label in enumerate(np.unique(labels)):
        face = mesh.Add(nm.FaceDescriptor(surfnr=j + 1, domin=1, domout=0, bc=j + 1))
        mesh.SetBCName(j, names[label])
        mesh.AddElements(dim=2, index=face, data=np.ascontiguousarray(triangles[labels == label][:, :3].astype(np.int32)), base=0)
    mesh.AddElements(dim=3, index=1, data=np.ascontiguousarray(tets[:, :4].astype(np.int32)), base=0)
    mesh = ngsolve.Mesh(mesh)
    if tets.shape[1] == 10:
        middles = {}
        for (i, j), k in zip(EDGES, range(4, 10)):
            middles |= zip(map(tuple, np.sort(tets[:, [i, j]], axis=1).tolist()), tets[:, k].tolist())
        ends = np.array([sorted(vertex.nr for vertex in edge.vertices) for edge in mesh.edges])
        offsets = points[[middles[tuple(pair)] for pair in ends.tolist()]] - points[ends].mean(axis=1)
        space = ngsolve.VectorH1(mesh, order=2)
        deformation = ngsolve.GridFunction(space)
        one = space.components[0]
        dofs = [one.GetDofNrs(ngsolve.NodeId(ngsolve.EDGE, i))[0] for i in range(len(ends))]
        for k in range(3):
            values = deformation.components[k].vec.FV().NumPy()
            values[:] = 0
            # The function of an edge is -1/8 at its midpoint.
            values[dofs] = -8 * offsets[:, k]
        mesh.SetDeformation(deformation)
    return mesh


def load(path):
    import meshio

    with contextlib.redirect_stdout(None):  # meshio prints an empty line.
        mesh = meshio.read(path)
    find = lambda kinds: next(i for i, block in enumerate(mesh.cells) if block.type in kinds)
    tets, faces = find(("tetra", "tetra10")), find(("triangle", "triangle6"))
    names = bytes(int(b) for b in mesh.field_data["patch_names"]).decode().split("\0")
    return mesh.points, mesh.cells[tets].data, mesh.cells[faces].data, mesh.cell_data["patch"][faces], names


def solve(mesh, order=2):
    """Conductance for a viscosity of 1, and the volume."""
    from ngsolve import CF, H1, BilinearForm, Grad, GridFunction, InnerProduct, Integrate, LinearForm, VectorH1, div, ds, dx, specialcf

    velocities = VectorH1(mesh, order=order, dirichlet="wall")
    space = velocities * H1(mesh, order=order - 1)
    (u, p), (v, q) = space.TnT()
    normal = specialcf.normal(3)
    # The term of the pressure makes all pivots nonzero; one correction removes its effect.
    # Jacobian determinants are cubic, so that products of gradients need more points than on linear elements.
    volume = dx(bonus_intorder=4)
    form = InnerProduct(Grad(u), Grad(v)) * volume - (div(u) * q + div(v) * p) * volume - 1e-10 * p * q * volume
    matrix = BilinearForm(form, symmetric=True).Assemble().mat
    right = LinearForm(-normal * v.Trace() * ds("inlet")).Assemble().vec
    found = GridFunction(space)
    inverse = matrix.Inverse(space.FreeDofs(), "sparsecholesky")
    found.vec.data = inverse * right
    found.vec.data += inverse * (right - matrix * found.vec).Evaluate()
    flow = Integrate(found.components[0] * normal * ds("outlet_0", bonus_intorder=4), mesh)
    return flow, Integrate(CF(1), mesh, order=6)


# ---- Tubes --------------------------------------------------------------------------------------------------------------------


def straight_axis(points):
    """Nearest point of the axis, and the distance along it."""
    at = points * [0, 0, 1]
    return at, points[:, 2]


def bent_axis(points):
    x, z = points[:, 0], points[:, 2]
    angle = np.clip(np.arctan2(z, BEND - x), 0, math.pi / 2)
    at = np.stack([BEND - BEND * np.cos(angle), 0 * x, BEND * np.sin(angle)], axis=1)
    at[z < 0] = points[z < 0] * [0, 0, 1]
    last = (x > BEND) & (z >= 0)
    at[last] = points[last] * [1, 0, 0] + [0, 0, BEND]
    along = BEND * angle + np.where(z < 0, z, 0) + np.where(last, x - BEND, 0)
    return at, along


def network(tube, path):
    points = [(0, 0, 0), (0, 0, LENGTH)]
    if tube == "bent":
        angles = np.linspace(0, math.pi / 2, 46)
        points = [(0, 0, -PIECE), *((BEND * (1 - math.cos(a)), 0, BEND * math.sin(a)) for a in angles), (BEND + PIECE, 0, BEND)]
    path.write_text("".join(f"{i + 1} 2 {x:.15g} {y} {z:.15g} 1 {i or -1}\n" for i, (x, y, z) in enumerate(points)))


def bent_reference():
    """Conductance of the CAD body with elements of order 4."""
    import ngsolve
    from netgen.occ import Axes, Axis, Cylinder, Glue, OCCGeometry, Vec, WorkPlane, X, Y, Z, gp_Dir, gp_Pnt

    disc = WorkPlane(Axes((0, 0, 0), n=Z, h=X)).Circle(0, 0, 1).Face()
    bend = disc.Revolve(Axis((BEND, 0, 0), Y), 90)
    body = Glue([Cylinder(gp_Pnt(0, 0, -PIECE), gp_Dir(0, 0, 1), r=1, h=PIECE), bend,
                 Cylinder(gp_Pnt(BEND, 0, BEND), gp_Dir(1, 0, 0), r=1, h=PIECE)])
    for face in body.faces:
        at = np.array([face.center.x, face.center.y, face.center.z])
        near = lambda place: np.linalg.norm(at - place) < 1e-6
        face.name = "wall"
        if near([0, 0, -PIECE]):
            face.name = "inlet"
        elif near([BEND + PIECE, 0, BEND]):
            face.name = "outlet_0"
        elif near([0, 0, 0]) or near([BEND, 0, BEND]):
            face.name = "inside"
    mesh = ngsolve.Mesh(OCCGeometry(body).GenerateMesh(maxh=0.8))
    mesh.Curve(4)
    return solve(mesh, 4)[0]


# ---- Nodes on the radius ------------------------------------------------------------------------------------------------------


#: Depth at which inner edges are straight: twice a quarter of the radius.
DEPTH = 0.5


def on_the_radius(axis, points, tets, triangles, labels, names):
    """The mesh with the nodes of the wall at distance 1, inner vertices moved alike, and inner edges straight."""
    from scipy.spatial import cKDTree

    at, along = axis(points)
    distance = np.linalg.norm(points - at, axis=1)
    wall = np.unique(triangles[np.array(names)[labels] == "wall"])
    direction = (points - at) / np.maximum(distance, 1e-9)[:, None]
    key = np.concatenate([along[:, None], direction], axis=1)
    far, near = cKDTree(key[wall]).query(key, k=6)
    weights = 1 / np.maximum(far, 1e-6) ** 3
    factor = (weights / distance[wall][near]).sum(axis=1) / weights.sum(axis=1)
    factor[wall] = 1 / distance[wall]
    moved = at + (points - at) * factor[:, None]
    # Edges in layers are curved like the edge of the wall above them, less with the depth; other inner edges are straight.
    corners = np.unique(tets[:, :4])
    outer = np.intersect1d(wall, corners)
    off, above = cKDTree(key[outer]).query(key)
    above, depth = np.where(off < 0.02, outer[above], -1), 1 - distance * factor
    arcs = {}
    for face in triangles[np.array(names)[labels] == "wall"]:
        for i, j, k in ((0, 1, 3), (1, 2, 4), (0, 2, 5)):
            arcs[tuple(sorted((face[i], face[j])))] = moved[face[k]] - moved[face[[i, j]]].mean(axis=0)
    inner = np.ones(len(points), bool)
    inner[wall] = False
    for (i, j), k in zip(EDGES, range(4, 10)):
        for a, b, middle in tets[inner[tets[:, k]]][:, [i, j, k]]:
            share = max(0.0, 1 - (depth[a] + depth[b]) / DEPTH)
            moved[middle] = moved[[a, b]].mean(axis=0) + share * arcs.get(tuple(sorted((above[a], above[b]))), 0.0)
    return moved, tets, triangles, labels, names


def spread(values):
    return f"{values.mean():.4f} ({values.min():.3f} to {values.max():.3f})" if len(values) else ""


def row(name, axis, mesh, exact, volume, solver=lambda *mesh: solve(curved_mesh(*mesh))):
    points, tets, triangles, labels, names = mesh
    flow, found = solver(*mesh)
    wall = triangles[np.array(names)[labels] == "wall"]
    distance = lambda nodes: np.linalg.norm(points[nodes] - axis(points[nodes])[0], axis=1)
    error = 100 * (flow / exact - 1)
    print(f"| {name} | {len(tets):,} | {100 * (found / volume - 1):+.3f} % | {error:+.3f} % | {spread(distance(np.unique(wall[:, :3])))} "
          f"| {spread(distance(np.unique(wall[:, 3:])))} |", flush=True)
    return error


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", default="target/release/anastomesh")
    options.add_argument("--rho", default="3,4")
    options.add_argument("--tubes", default="straight,bent")
    options.add_argument("--options", default=";--joint none;--layers 3")
    options.add_argument("--dolfinx", action="store_true")
    options.add_argument("--bar", type=float, default=0.2)
    given = options.parse_args()
    import ngsolve

    ngsolve.SetNumThreads(1)
    worst = 0.0
    print("| tube | ρ | options | order | tetrahedra | volume | conductance | distance of wall vertices from the axis | of midpoints |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for tube in given.tubes.split(","):
            network(tube, folder / "tube.swc")
            axis = straight_axis if tube == "straight" else bent_axis
            length = LENGTH if tube == "straight" else 2 * PIECE + BEND * math.pi / 2
            exact = math.pi / 8 / length if tube == "straight" else bent_reference()
            fine_axis = [] if tube == "straight" else ["--axis-tolerance", "0.002"]
            for rho in given.rho.split(","):
                for extra in given.options.split(";"):
                    always = [] if "--axis-tolerance" in extra else fine_axis
                    for order in ("1", "2"):
                        command = [given.program, "mesh", folder / "tube.swc", "-o", folder / "tube.vtu", "--rho", rho, "--order", order,
                                   "-q", *always, *extra.split()]
                        made = subprocess.run([str(word) for word in command], capture_output=True, text=True)
                        if made.returncode not in (0, 1):
                            sys.exit(made.stderr)
                        mesh = load(folder / "tube.vtu")
                        name = f"{tube} | {rho} | {f'`{extra}`' if extra else ''} | "
                        error = row(name + order, axis, mesh, exact, math.pi * length)
                        if order == "2":
                            worst = max(worst, 0 if extra else abs(error))
                            if given.dolfinx:
                                row(name + "2, dolfinx", axis, mesh, exact, math.pi * length, lambda *mesh: of_dolfinx(*mesh, folder))
                            row(name + "2, on the radius", axis, on_the_radius(axis, *mesh), exact, math.pi * length)
    sys.exit(0 if worst <= given.bar else 1)


if __name__ == "__main__":
    main()
