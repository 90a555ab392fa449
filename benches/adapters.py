#!/usr/bin/env python3
"""The adapters of the Python package beside the back ends of their packages, as tables in Markdown.

    python benches/adapters.py SURFACE.off...            all tables
    python benches/adapters.py --timeout 60 SURFACE.off...

Needs Python 3.12 and `pip install anastomesh pyvista tetgen meshio vmtk svv pytetwild netgen-mesher`; `ANASTOMESH_BINARY` is the
path of another program. Each fill runs in its own process, one time, from arrays in memory to arrays in memory; imports are not
counted. A surface is kept if all its points are unchanged and each of its triangles is a face of a tetrahedron.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

from python import kept, surface_of

#: Trees for svVascularize, by the number of vessels added to the root.
TREES = (1, 20)


def tetgen(points, triangles):
    from tetgen import TetGen

    return filled(TetGen, points, triangles)


def anastomesh_tetgen(points, triangles):
    from anastomesh import TetGen

    return filled(TetGen, points, triangles)


def filled(TetGen, points, triangles):
    def run():
        tet = TetGen(points, triangles)
        tet.tetrahedralize(minratio=1.414, mindihedral=10, nobisect=True)
        return tet.node, tet.elem

    return run


def vmtktetgen(points, triangles):
    from vmtk import vmtktetgen

    return piped(vmtktetgen.vmtkTetGen(), points, triangles)


def vmtkanastomesh(points, triangles):
    from anastomesh.adapters import vmtk

    return piped(vmtk.vmtkAnastomesh(), points, triangles)


def piped(script, points, triangles):
    import pyvista

    script.Mesh = pyvista.UnstructuredGrid({pyvista.CellType.TRIANGLE: triangles}, points)
    script.LogOn, script.ExitOnError, script.NoBoundarySplit = 0, 0, 1

    def run():
        script.Execute()
        made = pyvista.wrap(script.Mesh)
        return made.points, made.cells_dict[pyvista.CellType.TETRA]

    return run


def edge_length(points):
    return float(np.linalg.norm(np.ptp(points, axis=0))) / 20


def ftetwild(points, triangles):
    import pytetwild

    return lambda: pytetwild.tetrahedralize(points, triangles, edge_length_abs=edge_length(points), quiet=True, vtk_ordering=True)


def netgen(points, triangles):
    from netgen import meshing

    def run():
        meshing.SetMessageImportance(0)
        mesh = meshing.Mesh(dim=3)
        mesh.AddPoints(points)
        face = mesh.Add(meshing.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
        mesh.AddElements(dim=2, index=face, data=np.ascontiguousarray(triangles, np.int32), base=0)
        mesh.GenerateVolumeMesh(maxh=edge_length(points), grading=0.3)
        return np.array(mesh.Coordinates()), mesh.Elements3D().NumPy()["nodes"][:, :4].astype(np.int64) - 1

    return run


def slicer(points, triangles):
    from anastomesh.adapters import slicer

    ids = np.ones(len(triangles), np.int32)
    return lambda: slicer.tetrahedralize(points, triangles, ids, maxh=edge_length(points), grading=0.3)[:2]


KEEP = [tetgen, anastomesh_tetgen, vmtktetgen, vmtkanastomesh]
SIZE = [ftetwild, netgen, slicer]


def one_fill(name, path):
    """Prints the result of one back end for a surface, as JSON."""
    points, triangles = surface_of(path)
    run = globals()[name](points, triangles)
    start = time.perf_counter()
    nodes, tets = run()
    seconds = time.perf_counter() - start
    if not len(tets):
        raise RuntimeError("no tetrahedra")
    is_kept = np.array_equal(nodes[: len(points)], points) and kept(triangles, tets) == len(triangles)
    # Tetrahedra that fill another volume than that of the surface, or lie over each other.
    a, b, c, d = (nodes[tets[:, corner]] for corner in range(4))
    inside = np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)).sum() / 6
    corners = points[triangles]
    enclosed = abs(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6
    if inside < 0.99 * enclosed:
        raise RuntimeError(f"{inside / enclosed:.0%} of the volume filled")
    print(json.dumps({"seconds": seconds, "tets": len(tets), "kept": bool(is_kept), "volume": inside / enclosed}))


def one_tree(name, added):
    """Prints the result for a tree of svVascularize, as JSON."""
    import pyvista
    from svv.domain.domain import Domain
    from svv.tree.tree import Tree

    domain = Domain(pyvista.Cube(x_length=10, y_length=10, z_length=10).triangulate().subdivide(2))
    domain.random_seed = 1
    domain.create()
    domain.solve()
    domain.build()
    tree = Tree()
    tree.random_seed = 1
    tree.set_domain(domain)
    tree.set_root()
    tree.n_add(int(added))
    start = time.perf_counter()
    if name == "svv":
        from svv.simulation.simulation import Simulation

        simulation = Simulation(tree, directory=os.getcwd())
        solid = tree.export_solid
        # Its default folder does not exist.
        tree.export_solid = lambda **options: solid(outdir=os.getcwd(), **options)
        simulation.build_meshes(fluid=True, tissue=False, boundary_layer=False)
        tets = simulation.fluid_domain_volume_meshes[0].n_cells
    else:
        from anastomesh.adapters import svv

        tets = len(svv.mesh(tree, **({"wall": "0.2r"} if name == "walls" else {})).tets)
    print(json.dumps({"seconds": time.perf_counter() - start, "tets": tets, "vessels": int(tree.segment_count)}))


def one_format(extension, path):
    """Prints times of meshio for a mesh in one format, as JSON."""
    import anastomesh
    import anastomesh.adapters.meshio  # noqa: F401
    import meshio

    mesh = anastomesh.tetrahedralize(*surface_of(path)).to_meshio()
    file = "mesh" + extension
    start = time.perf_counter()
    mesh.write(file)
    written = time.perf_counter()
    again = meshio.read(file)
    done = time.perf_counter()
    same = np.array_equal(again.points, mesh.points) and np.array_equal(again.cells_dict["tetra"], mesh.cells_dict["tetra"])
    has_names = set(again.field_data) == set(mesh.field_data)
    print(json.dumps({"write": written - start, "read": done - written, "same": bool(same), "names": has_names}))


def in_process(kind, name, what, limit):
    """Result of a run in a process of its own: a dictionary, or the reason of the failure."""
    command = [sys.executable, os.path.abspath(__file__), "--one", kind, name, str(what)]
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit, cwd=folder)
        except subprocess.TimeoutExpired:
            return f"more than {limit} s"
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode == 0 and lines:
        return json.loads(lines[-1])
    if done.returncode < 0:
        return f"failed: signal {-done.returncode}"
    said = done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit code {done.returncode}"
    print(f"{name}, {what}: {said}", file=sys.stderr)
    exception, _, text = said.partition(": ")
    return f"failed: {text if exception == 'RuntimeError' else exception}"


def cell(made):
    if isinstance(made, str):
        return made
    notes = "" if made["kept"] else ", surface changed"
    if abs(made["volume"] - 1) > 1e-6:
        notes += f", volume {made['volume'] - 1:+.2%}"
    return f"{made['seconds']:.2f} s, {made['tets']:,}{notes}"


def fills(backends, paths, limit):
    names = [backend.__name__ for backend in backends]
    print(f"| surface | triangles | {' | '.join(names)} |\n|---|---|{'---|' * len(names)}")
    results = []
    for path in paths:
        results.append([in_process("fill", name, path, limit) for name in names])
        print(f"| {pathlib.Path(path).stem} | {len(surface_of(path)[1]):,} | {' | '.join(map(cell, results[-1]))} |", flush=True)
    failed = [sum(isinstance(made, str) for made in column) for column in zip(*results, strict=True)]
    print(f"| failures | | {' | '.join(map(str, failed))} |\n")


def trees(limit):
    print('| vessels | svv | adapter | adapter, `wall="0.2r"` |\n|---|---|---|---|')
    for added in TREES:
        made = [in_process("tree", name, added, limit) for name in ("svv", "lumen", "walls")]
        vessels = next((m["vessels"] for m in made if not isinstance(m, str)), "")
        said = [m if isinstance(m, str) else f"{m['seconds']:.2f} s, {m['tets']:,}" for m in made]
        print(f"| {vessels} | {' | '.join(said)} |", flush=True)
    print()


def formats(path, limit):
    print("| meshio | write | read | same points and tetrahedra | same names of patches |\n|---|---|---|---|---|")
    for extension in (".vtu", ".msh", ".npyd", ".pvtu"):
        made = in_process("format", extension, path, limit)
        if isinstance(made, str):
            print(f"| `{extension}` | {made} | | | |", flush=True)
            continue
        same, names = ("yes" if made[key] else "no" for key in ("same", "names"))
        print(f"| `{extension}` | {1e3 * made['write']:.0f} ms | {1e3 * made['read']:.0f} ms | {same} | {names} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--timeout", type=int, default=20, help="seconds for each run")
    parser.add_argument("--one", choices=["fill", "tree", "format"], help=argparse.SUPPRESS)
    parser.add_argument("paths", nargs="+")
    arguments = parser.parse_args()
    if arguments.one:
        {"fill": one_fill, "tree": one_tree, "format": one_format}[arguments.one](*arguments.paths)
        return
    paths = [os.path.abspath(path) for path in arguments.paths]
    fills(KEEP, paths, arguments.timeout)
    fills(SIZE, paths, arguments.timeout)
    trees(arguments.timeout)
    formats(max(paths, key=os.path.getsize), arguments.timeout)


if __name__ == "__main__":
    main()
