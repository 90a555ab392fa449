#!/usr/bin/env python3
"""Diffusion over wall and tissue of a Y in FEniCSx, from an MSH file with tags.

    python3 benches/fenicsx.py FOLDER [--program PATH] [--bar 0.001]

The network `y` of solver_cases.py is meshed with `--wall 0.2r --tissue box` as MSH. Debian's dolfinx 0.5 (`/usr/bin/python3`,
package python3-dolfinx) gets cells and tags from meshio as XDMF, and solves for a concentration of 1 in the lumen and 0 on the
organ. Mean concentrations are compared with the elements of regions.py. Exit code 1 if they differ by more than the bar.
Needs numpy, scipy, h5py and meshio in this Python."""

import argparse
import json
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np

import regions
import shells
from solver_cases import Y

SCRIPT = """
import sys, json, ufl
from mpi4py import MPI
from petsc4py.PETSc import ScalarType
from dolfinx import fem, io, mesh
with io.XDMFFile(MPI.COMM_WORLD, sys.argv[1], "r") as file:
    domain = file.read_mesh(name="Grid")
    tags = file.read_meshtags(domain, name="Grid")
space = fem.FunctionSpace(domain, ("Lagrange", 1))
lumen, *others = map(int, sys.argv[2:])
inside = fem.locate_dofs_topological(space, 3, tags.find(lumen))
domain.topology.create_connectivity(2, 3)
low, high = domain.geometry.x.min(0), domain.geometry.x.max(0)
size = 1e-9 * (high - low).max()
outer = fem.locate_dofs_geometrical(space, lambda x: ((abs(x.T - low) < size) | (abs(x.T - high) < size)).any(1))
u, v, dx = ufl.TrialFunction(space), ufl.TestFunction(space), ufl.Measure("dx", domain, subdomain_data=tags)
ends = [fem.dirichletbc(ScalarType(1), inside, space), fem.dirichletbc(ScalarType(0), outer, space)]
zero = fem.Constant(domain, ScalarType(0))
problem = fem.petsc.LinearProblem(ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx, zero * v * ufl.dx, ends)
found, one = problem.solve(), fem.Constant(domain, ScalarType(1))
total = lambda value, tag: fem.assemble_scalar(fem.form(value * dx(tag)))
print(json.dumps([total(found, tag) / total(one, tag) for tag in others]))
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", default="anastomesh")
    parser.add_argument("--bar", type=float, default=1e-3)
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    network = args.folder / "y.swc"
    network.write_text(Y)
    options = ["--wall", "0.2r", "--tissue", "box"]
    points, tets, parts, numbers, patches = shells.mesh(args.program, network, args.folder / "y.vtu", *options)
    subprocess.run([args.program, "convert", args.folder / "y.vtu", "-o", args.folder / "y.msh", "-q"], check=True)
    tagged = meshio.read(args.folder / "y.msh")
    tags = tagged.cell_data_dict["gmsh:physical"]["tetra"]
    meshio.write(args.folder / "y.xdmf", meshio.Mesh(tagged.points, {"tetra": tagged.cells_dict["tetra"]}, cell_data={"tags": [tags]}))
    ids = [str(tagged.field_data[name][0]) for name in ("lumen", "wall", "tissue")]
    command = ["/usr/bin/python3", "-c", SCRIPT, str(args.folder / "y.xdmf"), *ids]
    found = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout.splitlines()[-1])
    expected, volumes = regions.elements(points, tets, parts, numbers, patches)
    print("| region | dolfinx | elements of regions.py |\n|---|---|---|")
    worst = 0.0
    for name, value in zip(("wall", "tissue"), found):
        cells = parts == numbers[name]
        mean = np.average(expected[cells], weights=volumes[cells])
        worst = max(worst, abs(value / mean - 1))
        print(f"| {name} | {value:.5f} | {mean:.5f} |")
    sys.exit(0 if worst < args.bar else 1)


if __name__ == "__main__":
    main()
