#!/usr/bin/env python3
"""Every format that `anastomesh mesh` writes, opened by programs of others, as a table in Markdown.

    python3 benches/readers.py NETWORK... [--outlets grouped,separate] [--program PATH] [--rho R] [--folder DIR]

A network is meshed once for each format. A reader passes when it finds as many points and tetrahedra as `check` does, and
patches of the names and areas that BASE_patches.csv has, and as much wall as the first reader; readers that know patches by number alone are asked for these. FreeFEM,
NGSolve and dolfinx then solve -Δu = 0 with linear elements, u = 1 at the inlets and 0 at the outlets: ∫|∇u|² has to be the same.

Readers: meshio, pyvista (VTK), gmsh, ngsolve, mfem of this Python; gmsh and dolfinx of Debian's (`/usr/bin/python3`: packages
python3-gmsh, python3-dolfinx); `pvpython` (paraview), `FreeFem++` (freefem++, libfreefem++), `gmshToFoam`, `checkMesh` and `decomposePar`
(openfoam). What is not there is left out of the table.
"""

import argparse
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TRIANGLE, TETRA = 5, 10


def areas(points, triangles, labels):
    """The area of the triangles of each label."""
    import numpy as np

    corners = np.asarray(points, float)[np.asarray(triangles)]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    return {str(label): float(area[labels == label].sum()) for label in np.unique(labels)}


def named(areas_by_id, names):
    return {names[int(label)]: area for label, area in areas_by_id.items()}


def texts(array):
    """Names that stand as bytes with zeros behind them."""
    return bytes(int(b) for b in array).decode().split("\0")


# ---- Readers: what each finds in a file. They run in processes, and Pythons, of their own. -------------------------------------


def read_meshio(path):
    import meshio
    import numpy as np

    mesh = meshio.read(path)
    key = next(k for k in ("patch", "gmsh:physical", "medit:ref") if k in mesh.cell_data)
    triangles, labels, tets = [], [], 0
    for cells, values in zip(mesh.cells, mesh.cell_data[key]):
        if cells.type == "triangle":
            triangles.append(cells.data)
            labels.append(values)
        tets += len(cells.data) if cells.type == "tetra" else 0
    found = areas(mesh.points, np.vstack(triangles), np.concatenate(labels))
    names = {int(value[0]): name for name, value in mesh.field_data.items() if np.size(value) == 2}
    if "patch_names" in mesh.field_data:
        names = dict(enumerate(texts(mesh.field_data["patch_names"])))
    return dict(points=len(mesh.points), tets=tets, patches=named(found, names) if names else found)


def of_vtk_grid(grid):
    """The same of pyvista's and ParaView's grids."""
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy as array

    kinds = array(grid.GetCellTypesArray())
    cells = grid.GetCells()
    ids, starts = array(cells.GetConnectivityArray()), array(cells.GetOffsetsArray())[:-1]
    faces = np.flatnonzero(kinds == TRIANGLE)
    labels = array(grid.GetCellData().GetArray("patch"))[faces]
    found = areas(array(grid.GetPoints().GetData()), ids[starts[faces][:, None] + np.arange(3)], labels)
    names = texts(array(grid.GetFieldData().GetArray("patch_names")))
    return dict(points=grid.GetNumberOfPoints(), tets=int((kinds == TETRA).sum()), patches=named(found, names))


def read_pyvista(path):
    import numpy as np
    import pyvista

    path = pathlib.Path(path)
    if path.suffix == ".foam":
        return of_foam(pyvista.OpenFOAMReader(str(path / "case.foam")).read())
    if path.suffix == ".svmesh":
        grid = pyvista.read(path / "mesh-complete.mesh.vtu")
        exterior = pyvista.read(path / "mesh-complete.exterior.vtp").compute_cell_sizes(length=False, volume=False)
        surfaces = {p.stem: pyvista.read(p).area for p in (path / "mesh-surfaces").glob("*.vtp")}
        surfaces.setdefault("wall", pyvista.read(path / "walls_combined.vtp").area)
        whole, ids = float(np.sum(exterior["Area"])), grid.point_data["GlobalNodeID"]
        assert abs(sum(surfaces.values()) - whole) < 1e-9 * whole and (np.sort(ids) == np.arange(1, len(ids) + 1)).all()
        return dict(points=grid.n_points, tets=int((grid.celltypes == TETRA).sum()), patches=surfaces)
    grid = pyvista.read(path)
    if path.suffix == ".pvtu":
        # Points that pieces share are one.
        ids = grid.point_data["GlobalPointIds"]
        return of_vtk_grid(grid) | dict(points=len(np.unique(ids)))
    return of_vtk_grid(grid)


def of_foam(blocks):
    inside, patches = blocks["internalMesh"], blocks["boundary"]
    found = {name: float(patches[name].area) for name in patches.keys()}
    return dict(points=inside.n_points, tets=int((inside.celltypes == TETRA).sum()), patches=found)


def read_paraview(path):
    from paraview import servermanager, simple

    if path.endswith(".foam"):
        return of_paraview_case(simple.OpenFOAMReader(FileName=path + "/case.foam"), servermanager)
    return of_vtk_grid(servermanager.Fetch(simple.OpenDataFile(path)))


def of_paraview_case(reader, servermanager):
    from vtkmodules.vtkFiltersCore import vtkMassProperties, vtkTriangleFilter

    reader.MeshRegions = reader.MeshRegions.Available
    tree = servermanager.Fetch(reader).NewTreeIterator()
    tree.VisitOnlyLeavesOn()
    found = dict(patches={})
    while not tree.IsDoneWithTraversal():
        block, name = tree.GetCurrentDataObject(), tree.GetCurrentMetaData().Get(tree.GetDataSet().NAME())
        if name == "internalMesh":
            found |= dict(points=block.GetNumberOfPoints(), tets=block.GetNumberOfCells())
        else:
            triangles, size = vtkTriangleFilter(), vtkMassProperties()
            triangles.SetInputData(block)
            size.SetInputConnection(triangles.GetOutputPort())
            size.Update()
            found["patches"][name] = size.GetSurfaceArea()
        tree.GoToNextItem()
    return found


def read_gmsh(path):
    import gmsh
    import numpy as np

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    tags, places, _ = gmsh.model.mesh.getNodes()
    row = np.zeros(int(tags.max()) + 1, int)
    row[tags.astype(int)] = np.arange(len(tags))
    found = {}
    for dimension, group in gmsh.model.getPhysicalGroups(2):
        corners = [gmsh.model.mesh.getElementsByType(2, surface)[1] for surface in
                   gmsh.model.getEntitiesForPhysicalGroup(2, group)]
        triangles = row[np.concatenate(corners).astype(int)].reshape(-1, 3)
        name = gmsh.model.getPhysicalName(2, group) or str(group)
        found[name] = sum(areas(places.reshape(-1, 3), triangles, np.zeros(len(triangles))).values())
    return dict(points=len(tags), tets=len(gmsh.model.mesh.getElementsByType(4)[0]), patches=found)


def read_ngsolve(path):
    import ngsolve
    from netgen.read_gmsh import ReadGmsh

    mesh = ngsolve.Mesh(ReadGmsh(path))
    names = mesh.GetBoundaries()
    values = ngsolve.Integrate(ngsolve.CF(1), mesh, ngsolve.BND, region_wise=True)
    space = ngsolve.H1(mesh, order=1, dirichlet="inlet.*|outlet.*")
    u, v = space.TnT()
    with ngsolve.TaskManager():
        form = ngsolve.BilinearForm(ngsolve.grad(u) * ngsolve.grad(v) * ngsolve.dx).Assemble()
        solution = ngsolve.GridFunction(space)
        solution.Set(1, definedon=mesh.Boundaries("inlet.*"))
        rest = (-form.mat * solution.vec).Evaluate()
        solution.vec.data += form.mat.Inverse(space.FreeDofs(), "sparsecholesky") * rest
    energy = ngsolve.Integrate(ngsolve.grad(solution) * ngsolve.grad(solution), mesh)
    return dict(points=mesh.nv, tets=mesh.ne, patches=dict(zip(names, values)), energy=energy)


def read_mfem(path):
    import mfem.ser as mfem
    import numpy as np

    mesh = mfem.Mesh(path, 1, 1)
    faces = range(mesh.GetNBE())
    triangles = np.array([mesh.GetBdrElementVertices(i) for i in faces])
    labels = np.array([mesh.GetBdrAttribute(i) for i in faces])
    points = np.array([list(mesh.GetVertexArray(i)) for i in range(mesh.GetNV())])
    return dict(points=mesh.GetNV(), tets=mesh.GetNE(), patches=areas(points, triangles, labels))


def read_dolfinx(path):
    import gmsh
    import numpy as np
    import ufl
    from dolfinx import fem
    from dolfinx.io import gmshio
    from mpi4py import MPI

    # As gmshio.read_from_msh means to do; in Debian's version that ends in a NameError.
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.merge(path)
    mesh, _, tags = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0)
    mesh.topology.create_connectivity(2, 0)
    mesh.topology.create_connectivity(2, 3)
    corners = np.array([mesh.topology.connectivity(2, 0).links(face) for face in tags.indices])
    # Vertices are numbered otherwise than the points of the geometry.
    mesh.topology.create_connectivity(3, 0)
    place = np.zeros((mesh.topology.index_map(0).size_local, 3))
    cells, dofs = mesh.topology.connectivity(3, 0), mesh.geometry.dofmap
    tets = mesh.topology.index_map(3).size_local
    for cell in range(tets):
        place[cells.links(cell)] = mesh.geometry.x[dofs.links(cell)]
    found = areas(place, corners, tags.values)
    space = fem.FunctionSpace(mesh, ("CG", 1))
    ends = [(1.0, tags.values == 2), (0.0, tags.values > 2)]
    known = [fem.dirichletbc(value, fem.locate_dofs_topological(space, 2, tags.indices[here]), space)
             for value, here in ends]
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    left, right = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx, ufl.inner(fem.Constant(mesh, 0.0), v) * ufl.dx
    options = {"ksp_type": "cg", "ksp_rtol": 1e-12, "pc_type": "jacobi"}
    solution = fem.petsc.LinearProblem(left, right, known, petsc_options=options).solve()
    energy = fem.assemble_scalar(fem.form(ufl.inner(ufl.grad(solution), ufl.grad(solution)) * ufl.dx))
    return dict(points=len(mesh.geometry.x), tets=tets, patches=found, energy=float(np.real(energy)))


FREEFEM = """mesh3 Th = %s("%s");
int[int] all = labels(Th), outlets(all.n - 2);
int next = 0;
cout.precision(15);
cout << "COUNTS " << Th.nv << " " << Th.nt << endl;
for (int i = 0; i < all.n; i++) {
    if (all[i] > 2) outlets[next++] = all[i];
    cout << "AREA " << all[i] << " " << int2d(Th, all[i])(1.) << endl;
}
fespace Space(Th, P1);
Space u, v;
solve laplace(u, v, solver = CG, eps = 1e-20) =
    int3d(Th)(dx(u) * dx(v) + dy(u) * dy(v) + dz(u) * dz(v)) + on(2, u = 1) + on(outlets, u = 0);
cout << "ENERGY " << int3d(Th)(dx(u)^2 + dy(u)^2 + dz(u)^2) << endl;
"""


def read_freefem(path):
    with tempfile.NamedTemporaryFile("w", suffix=".edp") as script:
        is_gmsh = path.endswith(".msh")
        script.write('load "gmsh"\n' * is_gmsh + FREEFEM % ("gmshload3" if is_gmsh else "readmesh3", path))
        script.flush()
        text = said(["FreeFem++", "-nw", "-v", "0", script.name], env={"FF_LOADPATH": "/usr/lib/freefem++"} | os.environ)
    points, tets = map(int, re.search(r"COUNTS (\d+) (\d+)", text).groups())
    found = {label: float(area) for label, area in re.findall(r"AREA (\d+) (\S+)", text)}
    return dict(points=points, tets=tets, patches=found, energy=float(re.search(r"ENERGY (\S+)", text)[1]))


def foam_said(command, case):
    environment = {"WM_PROJECT_DIR": "/usr/share/openfoam"} | os.environ
    return said([*command, "-case", case], env=environment)


def read_gmshtofoam(path):
    """Into a case beside; what is in it VTK tells."""
    case = pathlib.Path(path).with_suffix(".case.foam")
    (case / "system").mkdir(parents=True)
    head = "FoamFile { version 2.0; format ascii; class dictionary; object %s; }\n"
    control = "startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;"
    (case / "system/controlDict").write_text(head % "controlDict" + control)
    (case / "system/fvSchemes").write_text(head % "fvSchemes")
    (case / "system/fvSolution").write_text(head % "fvSolution")
    (case / "case.foam").touch()
    foam_said(["gmshToFoam", path], str(case))
    return read_pyvista(case)


def read_checkmesh(path):
    """Counts, names, and that all is well; then the case is split for four processes."""
    text = foam_said(["checkMesh", "-allGeometry", "-allTopology"], path)
    assert "Mesh OK." in text, text[-1000:]
    counts = {what: int(re.search(rf"{what}: +(\d+)", text)[1]) for what in ("points", "cells", "tetrahedra")}
    assert counts["cells"] == counts["tetrahedra"]
    split = foam_said(["decomposePar", "-force"], path)
    assert "End" in split and len(list(pathlib.Path(path).glob("processor*"))) == 4, split[-1000:]
    for part in pathlib.Path(path).glob("processor*"):
        shutil.rmtree(part)
    patches = re.findall(r"^ +(\S+) +\d+ +\d+ +ok", text, re.M)
    return dict(points=counts["points"], tets=counts["tetrahedra"], patches={name: None for name in patches})


# ---- What is written, and who reads it -----------------------------------------------------------------------------------------

HERE, DEBIAN, PARAVIEW = [sys.executable], ["/usr/bin/python3"], ["pvpython"]
#: File, options of `mesh`, readers: the name in the table, the interpreter, the function above.
FORMATS = [
    ("a.vtu", [], [("meshio", HERE, "meshio"), ("VTK (pyvista)", HERE, "pyvista"), ("ParaView", PARAVIEW, "paraview")]),
    ("b.pvtu", [], [("VTK (pyvista)", HERE, "pyvista")]),
    ("c.msh", [], [("meshio", HERE, "meshio"), ("Gmsh", HERE, "gmsh"), ("Gmsh of Debian", DEBIAN, "gmsh"),
                   ("dolfinx", DEBIAN, "dolfinx")]),
    ("d.msh", ["--format", "msh2"], [
        ("meshio", HERE, "meshio"), ("Gmsh", HERE, "gmsh"), ("Gmsh of Debian", DEBIAN, "gmsh"), ("NGSolve", HERE, "ngsolve"),
        ("MFEM", HERE, "mfem"), ("FreeFEM", HERE, "freefem"), ("dolfinx", DEBIAN, "dolfinx"),
        ("gmshToFoam", HERE, "gmshtofoam")]),
    ("e.mesh", [], [("meshio", HERE, "meshio"), ("FreeFEM", HERE, "freefem")]),
    ("f.foam", [], [("VTK (pyvista)", HERE, "pyvista"), ("ParaView", PARAVIEW, "paraview"),
                    ("checkMesh, decomposePar", HERE, "checkmesh")]),
    ("g.svmesh", [], [("VTK (pyvista)", HERE, "pyvista")]),
]


def said(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, timeout=900, **options)
    if done.returncode != 0:
        raise RuntimeError((done.stderr or done.stdout).strip()[-800:])
    return done.stdout


def expected(folder, program):
    """Counts as `check` has them; areas of patches by name, and their numbers."""
    report = json.loads(said([program, "check", str(folder / "a.vtu"), "--json"]))
    patches, numbers = {}, {}
    with open(folder / "a_patches.csv") as table:
        for row in csv.DictReader(table):
            patches[row["name"]] = patches.get(row["name"], 0.0) + float(row["area"])
            numbers[row["id"]] = row["name"]
    return report["counts"] | dict(patches=patches, numbers=numbers | {"1": "wall"})


def compared(found, known, in_floats):
    """How what was found differs from what is known: words for the table."""
    faults = [f"{found[what]} {what}, not {known[what]}" for what in ("points", "tets") if found[what] != known[what]]
    by_number = all(name.isdigit() for name in found["patches"])
    patches = {known["numbers"].get(name, name): area for name, area in found["patches"].items()}
    patches = {name: area for name, area in patches.items() if area != 0.0}
    if set(patches) != set(known["patches"]) | {"wall"}:
        faults.append(f"patches {sorted(set(patches) ^ (set(known['patches']) | {'wall'}))[:6]}")
    # The table has no wall: that of the first reader.
    areas_known = known["patches"] | {"wall": known.setdefault("wall", patches.get("wall"))}
    worst = [abs(area / areas_known[name] - 1) for name, area in patches.items() if area and name in areas_known]
    # VTK reads OpenFOAM's points as numbers of 32 bits.
    if worst and max(worst) > (1e-4 if in_floats else 1e-9):
        faults.append(f"areas differ by {max(worst):.1e}")
    return "; ".join(faults) or "same", "by number" if by_number else "by name", max(worst, default=None)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("networks", nargs="*")
    options.add_argument("--outlets", default="grouped,separate")
    options.add_argument("--program", default="target/release/anastomesh")
    options.add_argument("--rho", default="3")
    options.add_argument("--folder")
    options.add_argument("--read", nargs=2, help=argparse.SUPPRESS)
    given = options.parse_args()
    if given.read:
        print("FOUND", json.dumps(globals()[f"read_{given.read[0]}"](given.read[1])))
        return
    print("| network | file | reader | points, tetrahedra, patches | patches known | areas differ by | ∫∣∇u∣² |")
    print("|---|---|---|---|---|---|---|")
    for network in given.networks:
        for outlets in given.outlets.split(","):
            with tempfile.TemporaryDirectory(dir=given.folder) as folder:
                rows(network, outlets, pathlib.Path(folder).resolve(), given)


def rows(network, outlets, folder, given):
    known = None
    for file, more, readers in FORMATS:
        mesh = [given.program, "mesh", network, "-o", str(folder / file), "--outlets", outlets, "--rho", given.rho, "-q"]
        said([*mesh, *more])
        known = known or expected(folder, given.program)
        for name, interpreter, reader in readers:
            command = [*interpreter, os.path.abspath(__file__), "--read", reader, str(folder / file)]
            energy = differ = None
            try:
                out = said(command)
                found = json.loads(re.search(r"^FOUND (.*)$", out, re.M)[1])
                words, how, differ = compared(found, known, "foam" in file or reader == "gmshtofoam")
                energy = found.get("energy")
            except FileNotFoundError:
                continue
            except Exception as fault:
                words, how = f"FAILS: {str(fault).splitlines()[-1][:100]}", ""
            label = " ".join([f"`{pathlib.Path(file).suffix}`", *(f"`{word}`" for word in more)])
            print(f"| {pathlib.Path(network).stem}, {outlets} | {label} | {name} | {words} | {how} |"
                  f" {'' if differ is None else f'{differ:.0e}'} | {'' if energy is None else f'{energy:.8g}'} |", flush=True)


if __name__ == "__main__":
    main()
