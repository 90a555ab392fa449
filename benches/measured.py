#!/usr/bin/env python3
"""Networks of a folder meshed by one command each, plain and with --refine: the table of benches/README.md.

python3 benches/measured.py PROGRAM FOLDER... [--seconds 120]

A mesh counts as valid when `mesh` exits 0 (it holds the axis against the network) and `check` says so of the file.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

EXTENSIONS = {".vtp", ".swc", ".vtk", ".am", ".xml", ".in"}


def run(program, args, seconds):
    """Exit code (None: out of time), standard output, seconds."""
    start = time.monotonic()
    try:
        done = subprocess.run([program, *map(str, args)], capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None, "", seconds
    return done.returncode, done.stdout, time.monotonic() - start


def failing(report):
    lines = (report.get("check") or {}).get("lines", [])
    return [line["line"] for line in lines if line["outcome"] == "fail"]


def meshed(program, network, mesh, refine, seconds):
    """Cells of the table: what became of it; the fidelity of the mesh."""
    code, out, took = run(program, ["mesh", network, "-o", mesh, "-q", "--json", *refine], seconds)
    if code is None:
        return [f"none within {seconds} s", "", ""]
    try:
        report = json.loads(out)
    except json.JSONDecodeError:
        return [f"none (exit {code}, {took:.0f} s)", "", ""]
    if not mesh.exists():
        return [f"{len(report['run']['failed'])} blocks failed ({took:.0f} s)", "", ""]
    checked, _, _ = run(program, ["check", mesh, "--json"], seconds)
    mesh.unlink()
    sound = "valid" if checked == 0 and code == 0 else "sound, exit 1" if checked == 0 else "not valid: " + ", ".join(failing(report))
    fidelity = report["fidelity"]
    axis, wall, lumen = fidelity["axis"], fidelity["wall"], fidelity["volume"] / fidelity["lumen"] - 1
    return [
        f"{sound}, {took:.1f} s",
        f"{axis['median']:.3f} / {axis['p99']:.2f} / {axis['worst']:.2f}",
        f"{100 * wall['median']:.1f} / {100 * wall['p99']:.0f} %, {100 * lumen:+.1f} %",
    ]


def main():
    args = argparse.ArgumentParser(description=__doc__)
    args.add_argument("program")
    args.add_argument("folders", type=pathlib.Path, nargs="+")
    args.add_argument("--seconds", type=int, default=120)
    args = args.parse_args()
    print("| network | | `mesh` | axis: median / 99 % / worst (r) | wall: median / 99 %; lumen |\n|---|---|---|---|---|")
    networks = [p for folder in args.folders for p in folder.iterdir()]
    networks = [p for p in networks if p.suffix in EXTENSIONS or p.name.endswith("_vertices.csv")]
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "m.vtu"
        for network in sorted(networks, key=lambda p: p.name):
            for name, how in (("plain", []), ("`--refine`", ["--refine"])):
                cells = meshed(args.program, network, mesh, how, args.seconds)
                print(f"| {network.name} | {name} | {' | '.join(cells)} |")
                sys.stdout.flush()


if __name__ == "__main__":
    main()
