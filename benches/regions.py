#!/usr/bin/env python3
"""Diffusion from the lumen over wall and tissue of a Y, in OpenFOAM and with finite elements, as a table in Markdown.

    python3 benches/regions.py FOLDER [--program PATH] [--rho 3,5,8] [--bar 0.03]

The network `y` of solver_cases.py is meshed with `--wall 0.2r --tissue box`, as CASE.foam and as VTU. `checkMesh` and `laplacianFoam`
run on the case without edits, then `splitMeshRegions` on a copy. The concentration of each cell is compared with that of linear
elements on the same tetrahedra: 1 on the lumen, 0 on the organ. Exit code 1 if a program fails, if the mean concentrations of a
region differ by more than the bar at the finest resolution, or if the difference does not fall. Needs OpenFOAM, numpy, scipy and meshio."""

import re
import shutil
import sys

import numpy as np

import foam
import shells
from solver_cases import Y, run


def latest(case):
    """Concentrations of the cells in the last result."""
    data = (case / foam.times(case)[-1] / "T").read_bytes()
    start = re.search(rb"internalField\s+nonuniform List<scalar>\s*(\d+)\s*\(", data)
    return np.frombuffer(data, "<f8", int(start.group(1)), start.end())


def elements(points, tets, regions, numbers, patches):
    """Mean concentration of each tetrahedron by linear elements."""
    lumen = np.unique(tets[regions == numbers["lumen"]])
    organ = np.unique(patches["organ"])
    matrix, volumes = shells.stiffness(points, tets, np.ones(len(tets)))
    fixed = np.concatenate([lumen, organ])
    values = np.concatenate([np.ones(len(lumen)), np.zeros(len(organ))])
    return shells.solve(matrix, np.zeros(len(points)), fixed, values)[tets].mean(1), volumes


def row(args, rho):
    network, case = args.folder / "y.swc", args.folder / f"y_{rho}.foam"
    network.write_text(Y)
    shutil.rmtree(case, ignore_errors=True)
    options = ["--units", "mm:m", "--rho", rho, "--wall", "0.2r", "--tissue", "box"]
    made = [args.program, "mesh", network, "-o", case, "-q", *options]
    points, tets, regions, numbers, patches = shells.mesh(args.program, network, args.folder / f"y_{rho}.vtu", *options)
    codes = [run(made, case.with_suffix(".log"))]
    codes += [run([tool, "-case", case], args.folder / f"{tool}.log") for tool in ("checkMesh", "laplacianFoam")]
    found = latest(case)
    expected, volumes = elements(points, tets, regions, numbers, patches)
    split = args.folder / f"y_{rho}_split.foam"
    shutil.rmtree(split, ignore_errors=True)
    shutil.copytree(case, split)
    codes.append(run(["splitMeshRegions", "-cellZones", "-overwrite", "-case", split], args.folder / "split.log"))
    pieces, errors = [], []
    for name in ("wall", "tissue"):
        cells = regions == numbers[name]
        a, b = (np.average(values[cells], weights=volumes[cells]) for values in (found, expected))
        errors.append(abs(a / b - 1))
        pieces += [f"{a:.4f}", f"{b:.4f}", f"{a / b - 1:+.2%}"]
    verdict = "yes" if not any(codes) else f"no, exit codes {codes}"
    print(f"| {rho} | {len(tets):,} | " + " | ".join(pieces) + f" | {verdict} |", flush=True)
    return max(errors), any(codes)


def main():
    parser = shells.arguments(__doc__, "3,5,8", 0.03)
    args = parser.parse_args()
    print("| ρ | tetrahedra | wall: OpenFOAM | elements | difference | tissue: OpenFOAM | elements | difference | unedited |")
    print("|---|---|---|---|---|---|---|---|---|")
    rows = shells.rows(args, row)
    errors = [error for error, _ in rows]
    falls = all(a > b for a, b in zip(errors, errors[1:]))
    sys.exit(0 if falls and errors[-1] < args.bar and not any(failed for _, failed in rows) else 1)


if __name__ == "__main__":
    main()
