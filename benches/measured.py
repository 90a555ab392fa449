#!/usr/bin/env python3
"""Networks of a folder meshed by one command each, plain and with --refine: the table of benches/README.md.

    python3 benches/measured.py [--limit CPU_SECONDS] [--only NAME] PROGRAM FOLDER...

A run that exceeds the limit is killed. The column 'same' compares the bytes of both meshes where the plain one is valid. A
second table lists the columns in which the refined mesh is worse than a valid plain one.
"""
import argparse
import hashlib
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

EXTENSIONS = {".vtp", ".vtu", ".swc", ".vtk", ".am", ".xml", ".in", ".net", ".h5"}


def mesh(program, network, options, limit, folder):
    """Exit code ('killed' beyond the limit), CPU seconds, report, last line, and hash of the mesh."""
    path = pathlib.Path(folder) / "m.vtu"
    path.unlink(missing_ok=True)
    command = [program, "mesh", str(network), "-o", str(path), "--json", *options]
    bound = lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    with open(f"{folder}/out", "w+") as out, open(f"{folder}/err", "w+") as err:
        child = subprocess.Popen(command, stdout=out, stderr=err, preexec_fn=bound)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        text, notes = out.read(), err.read()
    code = "killed" if child.returncode < 0 else str(child.returncode)
    try:
        report = json.loads(text)
    except json.JSONDecodeError:
        report = {}
    lines = [line for line in notes.splitlines() if line.strip()]
    last = report.get("verdict") if code == "0" else None
    digest = hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else ""
    return code, usage.ru_utime + usage.ru_stime, report, last or (lines[-1] if lines else ""), digest


def cells(report):
    """Axis at 50, 99 and 100 %, lumen error and nodes moved, as numbers; `None` without a mesh."""
    fidelity = report.get("fidelity")
    if not fidelity:
        return None
    axis = fidelity["axis"]
    moved = ((report.get("changes") or {}).get("moved") or {}).get("count", 0)
    return [axis["median"], axis["p99"], axis["worst"], fidelity["volume"] / fidelity["lumen"] - 1, moved]


def text(values):
    if values is None:
        return ["", "", ""]
    median, p99, worst, lumen, moved = values
    return [f"{median:.3f} / {p99:.2f} / {worst:.2f}", f"{100 * lumen:+.1f} %", str(moved)]


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("program")
    args.add_argument("folders", type=pathlib.Path, nargs="+")
    args.add_argument("--limit", type=int, default=120)
    args.add_argument("--only", default="")
    args = args.parse_args()
    networks = [p for folder in args.folders for p in (folder.iterdir() if folder.is_dir() else [folder])]
    is_network = lambda p: p.suffix in EXTENSIONS or p.name.endswith(("_vertices.csv", "_nodes.csv"))
    networks = [p for p in networks if is_network(p) and args.only in p.name]
    print("| network | | exit | CPU s | axis: median / 99 % / max (r) | lumen | moved | same | last line |")
    print("|---|---|---|---|---|---|---|---|---|")
    worse = []
    with tempfile.TemporaryDirectory() as folder:
        for network in sorted(networks, key=lambda p: p.name):
            plain = None
            for name, options in (("plain", []), ("`--refine`", ["--refine"])):
                code, seconds, report, last, digest = mesh(args.program, network, options, args.limit, folder)
                values = cells(report)
                same = ""
                if plain is None:
                    plain = (code, values, digest)
                elif plain[0] == "0":
                    same = "yes" if digest == plain[2] else "no"
                    columns = ["median", "99 %", "max", "lumen"]
                    pairs = zip(columns, plain[1], values or [9e9] * 4)
                    worse += [(network.name, c, a, b) for c, a, b in pairs if abs(b) > abs(a) + 1e-9]
                row = [network.name, name, code, f"{seconds:.1f}", *text(values), same, last[:160]]
                print("| " + " | ".join(row) + " |", flush=True)
    print(f"\n{len(worse)} columns in which refinement is worse than a valid plain mesh")
    for name, column, before, after in worse:
        print(f"- {name}: {column} {before:.3f} to {after:.3f}")


if __name__ == "__main__":
    main()
