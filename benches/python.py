#!/usr/bin/env python3
"""The Python package beside PyPI's `tetgen` and beside the bare program, as tables in Markdown.

    python benches/python.py plain SURFACE.off...      tetgen.TetGen and anastomesh.TetGen, no quality points
    python benches/python.py quality SURFACE.off...    the same with a bound on the ratio
    python benches/python.py split SURFACE.off...      the same with bounds on ratio and angle; the boundary may be split
    python benches/python.py overhead SURFACE.off... NETWORK...    a run from Python beside the bare program

`sphere` is the surface `pyvista.Sphere()`. Needs both packages (`pip install tetgen anastomesh pyvista meshio`);
`ANASTOMESH_BINARY` is the path of another program. Times are the minimum of three runs, and the ratio is that of CPU times;
`overhead` gives medians of pairs. A surface is kept if each of its triangles is a face of a tetrahedron. Each call of tetgen
runs in its own process, because some calls end the process.
"""

import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import anastomesh
import numpy as np

CALLS = {
    "plain": {"nobisect": True, "quality": False},
    "quality": {"nobisect": True, "minratio": 1.4},
    "split": {"mindihedral": 10, "minratio": 1.5},
}


def surface_of(path):
    if path == "sphere":
        import pyvista

        return pyvista.Sphere().points.astype(np.float64), pyvista.Sphere().regular_faces.astype(np.int32)
    import meshio

    mesh = meshio.read(path)
    return np.ascontiguousarray(mesh.points, np.float64), mesh.cells_dict["triangle"].astype(np.int32)


def now():
    """Wall and CPU time in seconds, including children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return np.array([time.perf_counter(), sum(u.ru_utime + u.ru_stime for u in used)])


def taken(run):
    start = now()
    run()
    return now() - start


def kept(triangles, tets):
    """Number of triangles that are faces of tetrahedra."""
    faces = np.sort(np.concatenate([tets[:, [i for i in range(4) if i != k]] for k in range(4)]), axis=1)

    def key(rows):
        return {row.tobytes() for row in np.ascontiguousarray(rows, np.int64)}

    return len(key(np.sort(triangles, axis=1)) & key(faces))


def smallest_angle(points, tets):
    """The smallest dihedral angle, in degrees."""
    corners = points[tets]
    least = 180.0
    for i, j in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]:
        others = [v for v in range(4) if v not in (i, j)]
        axis = corners[:, j] - corners[:, i]
        sides = [np.cross(axis, corners[:, v] - corners[:, i]) for v in others]
        lengths = np.linalg.norm(sides[0], axis=1) * np.linalg.norm(sides[1], axis=1)
        cosine = np.einsum("ij,ij->i", *sides) / np.where(lengths > 0, lengths, 1)
        least = min(least, float(np.degrees(np.arccos(np.clip(cosine, -1, 1))).min()))
    return least


def one(call, package, path):
    """Prints the result of one package for a surface, as JSON."""
    if package == "tetgen":
        from tetgen import TetGen
    else:
        from anastomesh import TetGen
    points, triangles = surface_of(path)

    def run():
        tet = TetGen(points, triangles)
        tet.tetrahedralize(**CALLS[call])
        return tet

    tet = run()
    report = {
        "seconds": np.min([taken(run) for _ in range(3)], axis=0).tolist(),
        "tets": len(tet.elem),
        "kept": kept(triangles, tet.elem),
        "triangles": len(triangles),
        "same": bool(np.array_equal(tet.node[: len(points)], points)),
        "angle": smallest_angle(tet.node, tet.elem),
    }
    print(json.dumps(report))


def replace(call, paths):
    print(f"`TetGen(points, triangles).tetrahedralize({', '.join(f'{k}={v}' for k, v in CALLS[call].items())})`\n")
    print("| surface | triangles | kept: tetgen, ours | tetrahedra | smallest angle | wall, s | CPU, s | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for path in paths:
        print(row(path, [in_process(call, package, path) for package in ("tetgen", "anastomesh")]), flush=True)


def in_process(call, package, path):
    """Result of one package for a surface, or None if its process ends without one."""
    command = [sys.executable, __file__, "one", call, package, path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if not lines:
        print(f"{package}, {path}: {done.returncode} {done.stderr.strip().splitlines()[-1:]}", file=sys.stderr)
    return json.loads(lines[-1]) if lines else None


def row(path, made):
    def said(form):
        return ", ".join("failed" if m is None else form(m) for m in made)

    def of_surface(m):
        return "all" if m["kept"] == m["triangles"] and m["same"] else f"{m['kept']:,}"

    cells = [
        pathlib.Path(path).stem,
        next((f"{m['triangles']:,}" for m in made if m), ""),
        said(of_surface),
        said(lambda m: str(m["tets"])),
        said(lambda m: f"{m['angle']:.2f}°"),
        said(lambda m: f"{m['seconds'][0]:.2f}"),
        said(lambda m: f"{m['seconds'][1]:.2f}"),
        f"{made[1]['seconds'][1] / made[0]['seconds'][1]:.2f}" if all(made) else "",
    ]
    return f"| {' | '.join(cells)} |"


def overhead(paths):
    print("| input | program, wall and CPU, s | from Python | more |")
    print("|---|---|---|---|")
    for path in paths:
        pairs = seconds_both(path)
        (bare, bare_cpu), (python, python_cpu) = np.median(pairs, axis=0)
        # Differences of pairs: the load of the machine changes.
        more, more_cpu = np.median(pairs[:, 1] - pairs[:, 0], axis=0)
        shares = f"{1e3 * more:.0f} ms ({more / bare:.1%}), {1e3 * more_cpu:.0f} ms ({more_cpu / bare_cpu:.1%})"
        print(f"| {pathlib.Path(path).name} | {bare:.3f}, {bare_cpu:.3f} | {python:.3f}, {python_cpu:.3f} | {shares} |", flush=True)


def seconds_both(path, pairs=21):
    """Wall time and CPU time of the program, from file to file, and from Python, arrays to arrays of a surface, the file of a
    network to arrays: (pairs, 2, 2)."""
    is_surface = pathlib.Path(path).suffix == ".off"
    arrays = surface_of(path) if is_surface else (path,)
    make = anastomesh.tetrahedralize if is_surface else anastomesh.mesh
    verb = "tetrahedralize" if is_surface else "mesh"

    with tempfile.TemporaryDirectory() as folder:
        command = [anastomesh.binary(), verb, path, "-o", os.path.join(folder, "mesh.vtu"), "--quiet"]
        runs = [lambda: subprocess.run(command, check=True), lambda: make(*arrays)]
        turns = [[0, 1], [1, 0]]
        found = [{k: taken(runs[k]) for k in turns[pair % 2]} for pair in range(pairs)]
        return np.array([[both[0], both[1]] for both in found])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=[*CALLS, "overhead", "one"])
    parser.add_argument("paths", nargs="+")
    arguments = parser.parse_args()
    match arguments.what:
        case "one":
            one(*arguments.paths)
        case "overhead":
            overhead(arguments.paths)
        case call:
            replace(call, arguments.paths)


if __name__ == "__main__":
    main()
