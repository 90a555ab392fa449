#!/usr/bin/env python3
"""Second-order files (`--order 2`) in VTK, meshio, scikit-fem, Gmsh, dolfinx, NGSolve and MFEM, as a table in Markdown.

    python3 benches/second_order_readers.py [--program PATH] [--cases tree,layers,surface] [--folder DIR]

Cases: the fixture tree, a tube with `--layers 3`, and a torus filled by `tetrahedralize`. Each is written as VTU, MSH 4.1, MSH 2.2 and
NumPy arrays. A reader passes if it finds the points, tetrahedra and volume of `check`, one sign of the Jacobian determinant in
every element, and the areas of the patches. Volumes, determinants and areas come from the reader's own elements and quadrature.
meshio has no elements; the rules of this script are used for its nodes.

Readers run in this Python: meshio, pyvista, scikit-fem, gmsh, ngsolve, mfem. dolfinx is Debian's (`/usr/bin/python3`, package
python3-dolfinx), and gets the module gmsh of this Python. Readers that are not installed are left out of the table.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FIXTURES = pathlib.Path(__file__).resolve().parent.parent / "fixtures"
TUBE = "1 2 0 0 0 1 -1\n2 2 0 0 20 1 1\n"
#: Ends of the midpoints 4 to 9 of a tetrahedron in VTK, meshio and our arrays.
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


# ---- Quadrature of this script, for readers without elements ------------------------------------------------------------------


def derivatives(at, edges):
    """Derivatives of the nodal functions by the barycentric coordinates 1, 2, ... with 0 eliminated."""
    import numpy as np

    corners = len(at)
    by = np.zeros((corners + len(edges), corners))
    for i in range(corners):
        by[i, i] = 4 * at[i] - 1
    for k, (i, j) in enumerate(edges):
        by[corners + k, i], by[corners + k, j] = 4 * at[j], 4 * at[i]
    return by[:, 1:] - by[:, :1]


def determinants(nodes, at):
    import numpy as np

    return np.linalg.det(np.einsum("enk,nd->ekd", nodes, derivatives(at, EDGES)))


#: Barycentric coordinates and weights that integrate cubic polynomials exactly: Keast, 1986.
RULE = [([0.25] * 4, -0.8)] + [([0.5 if i == j else 1 / 6 for j in range(4)], 0.45) for i in range(4)]


def of_arrays(points, tets, triangles, labels):
    """Counts, volume, least determinant relative to its mean, and areas of the labels, by the rules of this script."""
    import numpy as np

    nodes = np.asarray(points, float)[tets]
    at_rule = np.array([determinants(nodes, at) for at, _ in RULE])
    at_corners = np.array([determinants(nodes, at) for at in np.eye(4)])
    least = np.minimum(at_rule.min(axis=0), at_corners.min(axis=0)) / np.abs(at_rule.mean(axis=0))
    volume = float((np.array([weight for _, weight in RULE]) @ at_rule).sum() / 6)
    return dict(points=len(points), tets=len(tets), volume=volume, least=float(least.min()),
                patches=areas(points, triangles, labels))


def areas(points, triangles, labels):
    """Areas of curved triangles, each divided into 64 flat ones: extrapolated from 16."""
    import numpy as np

    found = []
    for n in (4, 8):
        total = np.zeros(len(triangles))
        value = lambda i, j: shapes(1 - (i + j) / n, i / n, j / n) @ np.asarray(points, float)[triangles]
        for i in range(n):
            for j in range(n - i):
                a, b, c = value(i, j), value(i + 1, j), value(i, j + 1)
                total += np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
                if i + j < n - 1:
                    d = value(i + 1, j + 1)
                    total += np.linalg.norm(np.cross(d - b, c - b), axis=1) / 2
        found.append(total)
    exact = (4 * found[1] - found[0]) / 3
    return {str(label): float(exact[labels == label].sum()) for label in np.unique(labels)}


def shapes(a, b, c):
    import numpy as np

    return np.array([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * a * c])


def texts(array):
    """Names that are stored as bytes with zeros behind them."""
    return bytes(int(b) for b in array).decode().split("\0")


def named(found, names):
    return {names.get(int(label), label): area for label, area in found.items()}


# ---- Readers ------------------------------------------------------------------------------------------------------------------


def of_meshio(path):
    """Points, tetrahedra, triangles, labels and names as meshio reads them."""
    import contextlib

    import meshio
    import numpy as np

    with contextlib.redirect_stdout(None):  # meshio prints an empty line.
        mesh = meshio.read(path)
    key = next(k for k in ("patch", "gmsh:physical") if k in mesh.cell_data)
    cells = {kind: [(b.data, v) for b, v in zip(mesh.cells, mesh.cell_data[key]) if b.type == kind]
             for kind in ("tetra10", "triangle6")}
    tets, triangles = (np.vstack([data for data, _ in cells[kind]]) for kind in ("tetra10", "triangle6"))
    labels = np.concatenate([values for _, values in cells["triangle6"]])
    names = {int(v[0]): name for name, v in mesh.field_data.items() if np.size(v) == 2 and v[1] == 2}
    if "patch_names" in mesh.field_data:
        names = {i: name for i, name in enumerate(texts(mesh.field_data["patch_names"])) if name}
    return mesh.points, tets, triangles, labels, names


def read_meshio(path):
    *arrays, names = of_meshio(path)
    found = of_arrays(*arrays)
    return found | dict(patches=named(found["patches"], names))


def read_numpy(path):
    import numpy as np

    folder = pathlib.Path(path)
    points, tets, triangles, labels = (np.load(folder / f"{name}.npy") for name in
                                       ("points", "tets", "triangles", "triangle_patches"))
    names = {patch["id"]: patch["name"] for patch in json.loads((folder / "mesh.json").read_text())["patches"]}
    found = of_arrays(points, tets, triangles, labels)
    return found | dict(patches=named(found["patches"], names))


def read_pyvista(path):
    """VTK's cells: its derivatives of the nodal functions at its own parametric coordinates, and its validator."""
    import numpy as np
    import pyvista
    from vtkmodules.vtkFiltersGeneral import vtkCellValidator

    grid = pyvista.read(path)
    tets = grid.cells_dict[pyvista.CellType.QUADRATIC_TETRA]
    cell, nodes = grid.GetCell(int(np.flatnonzero(grid.celltypes == 24)[0])), np.asarray(grid.points, float)[tets]
    values = []
    for at, _ in RULE:
        by = np.zeros(30)
        cell.InterpolateDerivs(list(at[1:]), by)
        values.append(np.linalg.det(np.einsum("enk,dn->ekd", nodes, by.reshape(3, 10))))
    values = np.array(values)
    volume = (np.array([weight for _, weight in RULE]) @ values).sum() / 6
    validator = vtkCellValidator()
    validator.SetInputData(grid)
    validator.Update()
    from vtkmodules.util.numpy_support import vtk_to_numpy
    state = vtk_to_numpy(validator.GetOutput().GetCellData().GetArray("ValidityState"))
    faces = grid.extract_cells(grid.celltypes == 22)
    names = {i: name for i, name in enumerate(texts(grid.field_data["patch_names"])) if name}
    found = areas(grid.points, grid.cells_dict[22], np.asarray(grid.cell_data["patch"])[grid.celltypes == 22])
    assert faces.n_cells == len(grid.cells_dict[22])
    return dict(points=grid.n_points, tets=len(tets), volume=float(volume), least=float((values / np.abs(values.mean(axis=0))).min()),
                patches=named(found, names), invalid=int((state[grid.celltypes == 24] != 0).sum()))


def read_skfem(path):
    """scikit-fem loses the tags of six-node triangles: boundaries are named from the triangles that meshio reads."""
    import logging

    import numpy as np
    import skfem
    from skfem.helpers import det

    logging.disable(logging.CRITICAL)
    mesh = skfem.MeshTet2.load(path)
    *_, triangles, labels, names = of_meshio(path)
    # Vertices keep their numbers, so that facets are found by their corners.
    facets = {tuple(f): i for i, f in enumerate(np.sort(mesh.facets.T, axis=1))}
    row = np.array([facets[tuple(f)] for f in np.sort(triangles[:, :3], axis=1)])
    mesh = mesh.with_boundaries({name: row[labels == label] for label, name in names.items() if (labels == label).any()})
    basis = skfem.Basis(mesh, skfem.ElementTetP0(), intorder=4)
    values = det(basis.mapping.DF(basis.X))
    found, note = {}, ""
    for name in mesh.boundaries:
        try:
            found[name] = float(skfem.FacetBasis(mesh, skfem.ElementTetP0(), facets=name, intorder=8).dx.sum())
        except Exception as fault:
            found[name], note = None, f"no boundary integrals: {fault}"
    return dict(points=mesh.doflocs.shape[1], tets=mesh.nelements, volume=float(basis.dx.sum()), note=note,
                least=float((values / abs(values.mean(axis=1, keepdims=True))).min()), patches=found)


def read_gmsh(path):
    import gmsh
    import numpy as np

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    tags, _ = gmsh.model.mesh.getElementsByType(11)
    points, weights = gmsh.model.mesh.getIntegrationPoints(11, "Gauss4")
    _, values, _ = gmsh.model.mesh.getJacobians(11, points)
    volume = float((values.reshape(len(tags), -1) @ weights).sum())
    least, scaled = (float(gmsh.model.mesh.getElementQualities(tags, name).min()) for name in ("minDetJac", "minSJ"))
    points, weights = gmsh.model.mesh.getIntegrationPoints(9, "Gauss8")
    found = {}
    for _, group in gmsh.model.getPhysicalGroups(2):
        name = gmsh.model.getPhysicalName(2, group) or str(group)
        for surface in gmsh.model.getEntitiesForPhysicalGroup(2, group):
            _, values, _ = gmsh.model.mesh.getJacobians(9, points, surface)
            found[name] = found.get(name, 0.0) + float((values.reshape(-1, len(weights)) @ weights).sum())
    return dict(points=len(gmsh.model.mesh.getNodes()[0]), tets=len(tags), volume=volume, least=scaled, patches=found,
                note=f"minDetJac {least:.1e}, minSJ {scaled:.3f}")


def of_dolfinx(domain, tags):
    import numpy as np
    import ufl
    from dolfinx import fem

    one = fem.Constant(domain, 1.0)
    total = lambda measure: float(np.real(fem.assemble_scalar(fem.form(one * measure))))
    corners = np.vstack([np.eye(4)[:, 1:], [[0.25] * 3], 0.1 + 0.6 * np.eye(4)[:, 1:]])
    values = fem.Expression(ufl.JacobianDeterminant(domain), corners).eval(np.arange(domain.topology.index_map(3).size_local, dtype=np.int32))
    # Elements are numbered by ascending vertices, so that half of them are mirrored.
    least = (values * np.sign(values[:, 4:5]) / abs(values[:, 4:5])).min()
    found = {}
    surface = ufl.Measure("ds", domain, subdomain_data=tags, metadata={"quadrature_degree": 8})
    for label in np.unique(tags.values):
        found[str(label)] = total(surface(int(label)))
    return dict(points=len(domain.geometry.x), tets=domain.topology.index_map(3).size_local,
                volume=total(ufl.dx(domain, metadata={"quadrature_degree": 4})), least=float(least), patches=found)


def read_dolfinx(path):
    sys.path.append(os.environ["GMSH_MODULE"])
    import gmsh
    from dolfinx.io import gmshio
    from mpi4py import MPI

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.merge(path)
    domain, _, tags = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0)
    return of_dolfinx(domain, tags)


def read_dolfinx_xdmf(path):
    """XDMF files that `write_xdmf` made of the mesh and of its triangles."""
    from dolfinx import io
    from mpi4py import MPI

    with io.XDMFFile(MPI.COMM_WORLD, path + ".xdmf", "r") as file:
        domain = file.read_mesh(name="Grid")
    domain.topology.create_connectivity(2, 3)
    with io.XDMFFile(MPI.COMM_WORLD, path + "_faces.xdmf", "r") as file:
        tags = file.read_meshtags(domain, name="Grid")
    return of_dolfinx(domain, tags)


def write_xdmf(path):
    import meshio

    points, tets, triangles, labels, _ = of_meshio(path)
    meshio.write(path + ".xdmf", meshio.Mesh(points, [("tetra10", tets)]))
    # Tags of facets are found by their corners, or by all nodes of the geometry: `read_meshtags` of dolfinx 0.5 takes six.
    meshio.write(path + "_faces.xdmf", meshio.Mesh(points, [("triangle6", triangles)], cell_data={"tags": [labels]}))


def of_ngsolve(mesh, points):
    import numpy as np
    from ngsolve import BND, CF, Det, IfPos, Integrate, VOL, specialcf

    jacobian = Det(specialcf.JacobianMatrix(3))
    volumes = np.array(Integrate(CF(1), mesh, VOL, order=6, element_wise=True))
    positive = np.array(Integrate(IfPos(jacobian, 1, 0), mesh, VOL, order=6, element_wise=True))
    found = Integrate(CF(1), mesh, BND, order=10, region_wise=True)
    mixed = np.minimum(positive, volumes - positive) > 1e-9 * volumes
    patches = {}
    for name, area in zip(mesh.GetBoundaries(), found):
        patches[name] = patches.get(name, 0.0) + float(area)
    return dict(points=points, tets=mesh.ne, volume=float(volumes.sum()), least=-1.0 if mixed.any() else None, patches=patches)


def read_ngsolve_gmsh(path):
    """Netgen's own reader of MSH 2.2."""
    import ngsolve
    from netgen.read_gmsh import ReadGmsh

    read = ReadGmsh(path)
    return of_ngsolve(ngsolve.Mesh(read), len(read.Points()))


def read_ngsolve(path):
    """Linear elements, curved by a deformation of order 2: `curved_mesh` of second_order_flow.py."""
    import second_order_flow

    points, tets, triangles, labels, names = of_meshio(path)
    return of_ngsolve(second_order_flow.curved_mesh(points, tets, triangles, labels, names), len(points))


def read_mfem(path):
    import mfem.ser as mfem
    import numpy as np

    mesh = mfem.Mesh(path, 1, 1)
    space = mesh.GetNodalFESpace()
    assert space is not None, "no curved nodes"
    rule = mfem.IntRules.Get(mfem.Geometry.TETRAHEDRON, 6)
    least, volume = np.inf, 0.0
    weights = np.array([rule.IntPoint(k).weight for k in range(rule.GetNPoints())])
    for i in range(mesh.GetNE()):
        values, transformation = [], mesh.GetElementTransformation(i)
        for k in range(rule.GetNPoints()):
            transformation.SetIntPoint(rule.IntPoint(k))
            values.append(transformation.Jacobian().Det())
        least = min(least, min(values) / abs(np.mean(values)))
        volume += weights @ values
    found = {}
    faces = mfem.IntRules.Get(mfem.Geometry.TRIANGLE, 8)
    for i in range(mesh.GetNBE()):
        transformation, label = mesh.GetBdrElementTransformation(i), str(mesh.GetBdrAttribute(i))
        for k in range(faces.GetNPoints()):
            point = faces.IntPoint(k)
            transformation.SetIntPoint(point)
            found[label] = found.get(label, 0.0) + point.weight * transformation.Weight()
    # GetElementVolume takes a rule of lower order.
    own = sum(mesh.GetElementVolume(i) for i in range(mesh.GetNE()))
    return dict(points=space.GetNDofs(), tets=mesh.GetNE(), volume=float(volume), least=float(least), patches=found,
                note=f"GetElementVolume {own / volume - 1:+.0e}")


# ---- Files, and their readers -------------------------------------------------------------------------------------------------

HERE, DEBIAN = [sys.executable], ["/usr/bin/python3"]
FORMATS = [
    ("a.vtu", [("meshio", HERE, "meshio"), ("VTK (pyvista)", HERE, "pyvista"), ("scikit-fem", HERE, "skfem"),
               ("NGSolve, deformation", HERE, "ngsolve"), ("dolfinx, XDMF", DEBIAN, "dolfinx_xdmf")]),
    ("b.msh", [("meshio", HERE, "meshio"), ("Gmsh", HERE, "gmsh"), ("scikit-fem", HERE, "skfem"), ("dolfinx, gmshio", DEBIAN, "dolfinx"),
               ("NGSolve, deformation", HERE, "ngsolve"), ("dolfinx, XDMF", DEBIAN, "dolfinx_xdmf")]),
    ("c.msh2", [("meshio", HERE, "meshio"), ("Gmsh", HERE, "gmsh"), ("scikit-fem", HERE, "skfem"), ("dolfinx, gmshio", DEBIAN, "dolfinx"),
                ("NGSolve, ReadGmsh", HERE, "ngsolve_gmsh"), ("NGSolve, deformation", HERE, "ngsolve"), ("MFEM", HERE, "mfem")]),
    ("d.npyd", [("NumPy", HERE, "numpy")]),
]


def said(command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=900, **options)
    if done.returncode != 0:
        raise RuntimeError((done.stderr or done.stdout).strip()[-800:])
    return done.stdout


def make(case, folder, file, program):
    """Makes a mesh of a case; returns its path."""
    path = folder / file
    if case == "surface":
        said([program, "tetrahedralize", FIXTURES / "torus.off", "-o", path, "--order", "2", "-q"])
    else:
        network, options = (FIXTURES / "tree_30.vtp", []) if case == "tree" else (folder / "tube.swc", ["--layers", "3"])
        said([program, "mesh", network, "-o", path, "--order", "2", "-q", *options])
    # Most readers know MSH files by the extension `msh`.
    return path.rename(folder / "c.msh") if path.suffix == ".msh2" else path


def compared(found, known):
    """Words for the table: how counts, volume and patches differ from `check` and from the first reader."""
    faults = [f"{found[what]:,} {what}, not {known[what]:,}" for what in ("points", "tets") if found[what] != known[what]]
    error = found["volume"] / known["volume"] - 1
    if abs(error) > 1e-9:
        faults.append("volume")
    if found["least"] is not None and found["least"] <= 0:
        faults.append("negative Jacobian determinant")
    if found.get("invalid"):
        faults.append(f"{found['invalid']} invalid cells")
    names = {str(label): name for label, name in known["names"].items()}
    patches = {names.get(name, name): area for name, area in found["patches"].items()}
    if set(patches) != set(known["areas"]):
        faults.append(f"patches {sorted(set(patches) ^ set(known['areas']))[:4]}")
    else:
        worst = max(abs(patches[name] / area - 1) if patches[name] else 0 for name, area in known["areas"].items())
        if worst > 1e-4:
            faults.append(f"areas differ by {worst:.1e}")
    by = "number" if all(name.isdigit() for name in found["patches"]) else "name"
    return error, "; ".join(faults) or "passes", by


def rows(case, folder, given):
    known = None
    (folder / "tube.swc").write_text(TUBE)
    for file, readers in FORMATS:
        path = make(case, folder, file, given.program)
        if known is None:
            counts = json.loads(said([given.program, "check", path, "--json"]))["counts"]
            *arrays, names = of_meshio(path)
            known = dict(points=len(arrays[0]), tets=counts["tets"], volume=counts["volume"], names=names,
                         areas=named(of_arrays(*arrays)["patches"], names))
        for name, interpreter, reader in readers:
            if reader == "dolfinx_xdmf":
                write_xdmf(str(path))
            try:
                out = said([*interpreter, os.path.abspath(__file__), "--read", reader, path], env=given.env)
                found = json.loads(re.search(r"^FOUND (.*)$", out, re.M)[1])
                error, words, by = compared(found, known)
                least = "" if found["least"] is None else f"{found['least']:.3f}"
                cells = f"{found['tets']:,} | {error:+.0e} | {least} | {by} | {words} | {found.get('note', '')}"
            except FileNotFoundError:
                continue
            except Exception as fault:
                cells = f" |  |  |  | fails: {str(fault).splitlines()[-1][:120]} | "
            print(f"| {case} | `.{file.split('.')[1]}` | {name} | {cells} |", flush=True)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", default="target/release/anastomesh")
    options.add_argument("--cases", default="tree,layers,surface")
    options.add_argument("--folder")
    options.add_argument("--read", nargs=2, help=argparse.SUPPRESS)
    given = options.parse_args()
    if given.read:
        print("FOUND", json.dumps(globals()[f"read_{given.read[0]}"](given.read[1])))
        return
    import importlib.util

    with tempfile.TemporaryDirectory(dir=given.folder) as folder:
        folder = pathlib.Path(folder).resolve()
        # Debian's Python gets this module alone, not the other packages of this Python.
        spec = importlib.util.find_spec("gmsh")
        if spec:
            (folder / "module").mkdir()
            (folder / "module/gmsh.py").symlink_to(pathlib.Path(spec.origin))
        given.env = os.environ | {"GMSH_MODULE": str(folder / "module")}
        print("| case | file | reader | tetrahedra | volume, compared with `check` | least determinant / mean | patches by | result | |")
        print("|---|---|---|---|---|---|---|---|---|")
        for case in given.cases.split(","):
            rows(case, folder, given)


if __name__ == "__main__":
    main()
