#!/usr/bin/env python3
"""Every surface of a folder through `anastomesh tetrahedralize` and `tetgen`, as a table in Markdown.

    python3 benches/surfaces.py FOLDER [--mode keep|quality] [--only PART]... [--program PATH] [--tetgen PATH|none]

keep     ours: --no-refine, TetGen: -pYQ
quality  ours: as it is,    TetGen: -pYq1.4Q

CPU is user and system time of the whole process, reading and writing included. A surface is kept when each of its
triangles is a face of the mesh: ours says so or fails, of TetGen's files it is checked here. `µs` is CPU per tetrahedron,
`min °` the smallest dihedral angle, `apart` the same without tetrahedra on triangles of the surface that have an angle
below 12° (needs numpy). Files whose name begins with
`plc_` are complexes of facets; a surface that fails is tried again with --repair and marked so.
"""

import argparse
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile

try:
    import numpy as np
except ImportError:
    np = None


def run(command, limit, folder):
    """Exit code (none when it took too long), CPU seconds, megabytes, stdout, stderr."""
    out, err = (open(os.path.join(folder, name), "w+b") for name in ("stdout", "stderr"))
    process = subprocess.Popen(
        command, stdout=out, stderr=err, cwd=folder,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1)),
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    out.seek(0), err.seek(0)
    late = process.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
    code = None if late else process.returncode
    return code, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, out.read(), err.read().decode(errors="replace")


def triangles_of_off(path):
    words = [w for line in open(path) for w in line.split("#")[0].split()]
    points, faces = int(words[1]), int(words[2])
    at = 4 + 3 * points
    rows = (words[at + 4 * i + 1 : at + 4 * i + 4] for i in range(faces))
    return [frozenset(map(int, row)) for row in rows]


def faces_of_tetgen(path):
    rows = (line.split() for line in open(path) if not line.startswith("#"))
    next(rows)
    return {frozenset(map(int, row[1:4])) for row in rows if row}


def quality(program, mesh, folder):
    check = subprocess.run([program, "check", mesh, "--json"], capture_output=True, cwd=folder)
    try:
        report = json.loads(check.stdout)
        return report["counts"]["tets"], report["quality"]
    except (json.JSONDecodeError, KeyError):
        return None, None


def rows_of(path, columns, kind):
    """The rows of a file of TetGen's family, their number left out."""
    lines = [line for line in open(path) if line.strip() and not line.startswith("#")]
    table = np.array(" ".join(lines[1:]).split(), dtype=kind if kind is float else None)
    width = len(lines[1].split())
    return table.reshape(-1, width)[:, 1 : 1 + columns].astype(kind)


def smallest_apart(surface, node, ele):
    """Smallest dihedral angle in degrees of the tetrahedra that do not stand on a triangle with an angle below 12°."""
    points, tets = rows_of(node, 3, float), rows_of(ele, 4, int)
    first = int(next(line for line in list(open(ele))[1:] if not line.startswith("#")).split()[0])
    tets -= first

    def cosines(p, q, r):
        u, v = q - p, r - p
        return (u * v).sum(1) / np.maximum(np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1), 1e-300)

    triangles = np.array([sorted(t) for t in triangles_of_off(surface)])
    a, b, c = (points[triangles[:, i]] for i in range(3))
    sharpest = np.max([cosines(a, b, c), cosines(b, c, a), cosines(c, a, b)], axis=0)
    count = len(points)
    code = lambda f: (f[:, 0] * count + f[:, 1]) * count + f[:, 2]
    bad = code(triangles[sharpest > np.cos(np.radians(12.0))])
    ordered = np.sort(tets, axis=1)
    on_bad = np.zeros(len(tets), bool)
    for f in ([1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]):
        on_bad |= np.isin(code(ordered[:, f]), bad)
    p = points[tets[~on_bad]]
    least = 180.0
    for i, j, k, l in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 0, 2), (2, 3, 0, 1)):
        edge = p[:, j] - p[:, i]
        m, n = np.cross(edge, p[:, k] - p[:, i]), np.cross(edge, p[:, l] - p[:, i])
        sine = np.linalg.norm(np.cross(m, n), axis=1)
        least = min(least, float(np.degrees(np.arctan2(sine, (m * n).sum(1)).min(initial=np.pi))))
    return f"{least:.2f}"


def shape(q, apart):
    if not q:
        return ["", "", "", "", ""]
    return [f"{q['mean']:.3f}", f"{q['percentile_1']:.3f}", f"{q['dihedral_min']:.2f}", apart, f"{q['dihedral_max']:.1f}"]


def ours(args, surface, folder):
    command = [args.program, "tetrahedralize", str(surface), "-o", "ours.ele", "--json", "-j", "1"]
    command += ["--no-refine"] if args.mode == "keep" else []
    command += ["--plc"] if surface.name.startswith("plc_") else []
    command += args.option
    note = ""
    code, cpu, memory, out, err = run(command, args.limit, folder)
    if code == 3:
        code, cpu, memory, out, err = run(command + ["--repair"], args.limit, folder)
        note = " (repaired)"
    if code not in (0, 1):
        why = "too long" if code is None else f"exit {code}: {err.strip().splitlines()[0][:90] if err.strip() else ''}"
        return None, [f"{cpu:.2f}", f"**no**: {why}"] + [""] * 8
    report = json.loads(out)["report"]
    tets = report["mesh"]["tets"]
    apart = smallest_apart(surface, f"{folder}/ours.node", f"{folder}/ours.ele") if np and args.mode == "quality" else ""
    rows = [f"{cpu:.2f}", "yes" + note, str(tets), f"{1e6 * cpu / max(tets, 1):.2f}"]
    return cpu, rows + shape(report["quality"], apart) + [f"{memory:.0f}"]


def tetgen(args, surface, folder):
    name = "input" + surface.suffix
    shutil.copy(surface, os.path.join(folder, name))
    switches = "-pYQ" if args.mode == "keep" else "-pYq1.4Q"
    code, cpu, _, _, _ = run([args.tetgen, switches, name], args.limit, folder)
    if code != 0 or not os.path.exists(os.path.join(folder, "input.1.ele")):
        return None, [f"{cpu:.2f}", "**no**: " + ("too long" if code is None else f"exit {code}")] + [""] * 7
    there = faces_of_tetgen(os.path.join(folder, "input.1.face"))
    lost = sum(t not in there for t in triangles_of_off(surface))
    tets, q = quality(args.program, "input.1.ele", folder)
    kept = "yes" if lost == 0 else f"**no**: {lost} lost"
    family = [os.path.join(folder, "input.1." + end) for end in ("node", "ele")]
    apart = smallest_apart(surface, *family) if np and lost == 0 and args.mode == "quality" else ""
    return cpu, [f"{cpu:.2f}", kept, str(tets), f"{1e6 * cpu / max(tets or 0, 1):.2f}"] + shape(q, apart)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--mode", choices=("keep", "quality"), default="keep")
    parser.add_argument("--only", action="append", default=[], help="surfaces whose name has this part")
    parser.add_argument("--option", action="append", default=[], help="a further option for our program")
    parser.add_argument("--program", default="target/release/anastomesh")
    parser.add_argument("--tetgen", default=shutil.which("tetgen") or "none")
    parser.add_argument("--limit", type=int, default=300, help="CPU seconds after which a run is ended")
    args = parser.parse_args()
    args.program = os.path.abspath(args.program)
    surfaces = sorted(p.resolve() for p in args.folder.glob("*.off"))
    surfaces = [p for p in surfaces if not args.only or any(part in p.name for part in args.only)]
    columns = ["CPU s", "kept", "tets", "µs", "mean", "1 %", "min °", "apart", "max °"]
    print("| surface | triangles | " + " | ".join(columns + ["MB"]) + " | " + " | ".join("TetGen " + c for c in columns) + " |")
    print("|---" * (2 + 2 * len(columns) + 1) + "|", flush=True)
    kept = total = both_ours = both_theirs = kept_theirs = 0
    for surface in surfaces:
        with tempfile.TemporaryDirectory() as folder:
            mine, row = ours(args, surface, folder)
            theirs, other = (None, [""] * 9) if args.tetgen == "none" else tetgen(args, surface, folder)
        total += 1
        kept += mine is not None
        kept_theirs += other[1] == "yes"
        if mine is not None and theirs is not None:
            both_ours, both_theirs = both_ours + mine, both_theirs + theirs
        print("| " + " | ".join([surface.stem, str(len(triangles_of_off(surface)))] + row + other) + " |", flush=True)
    print(f"\n{kept} of {total} kept; TetGen {kept_theirs}. CPU where both finish: {both_ours:.2f} s and {both_theirs:.2f} s", end="")
    print(f" (ratio {both_ours / both_theirs:.2f})." if both_theirs else ".")


if __name__ == "__main__":
    main()
