#!/usr/bin/env python3
"""Measured networks meshed as they are and prepared, plain and with --refine: the table of benches/README.md.

python3 benches/measured.py PROGRAM FOLDER [--seconds 240]
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time


def run(program, args, seconds):
    """Exit code (None: out of time), standard output, seconds."""
    start = time.monotonic()
    try:
        done = subprocess.run([program, *map(str, args)], capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None, "", seconds
    return done.returncode, done.stdout, time.monotonic() - start


def meshed(program, network, mesh, refine, seconds):
    """One entry of the table: what `check` says of the mesh, its volume, the time."""
    code, _, took = run(program, ["mesh", network, "-o", mesh, "-q", *refine], seconds)
    if code is None:
        return f"none within {seconds} s"
    if not mesh.exists():
        return f"none (exit {code}, {took:.0f} s)"
    code, out, _ = run(program, ["check", mesh, "--json"], seconds)
    mesh.unlink()
    found = json.loads(out)
    return f"{'valid' if code == 0 else 'not valid'}, {found['counts']['volume']:.5g}, {took:.0f} s"


def tips(program, network):
    code, out, _ = run(program, ["info", network, "--json"], 60)
    return json.loads(out)["terminals"] if code == 0 else "not read"


def main():
    args = argparse.ArgumentParser(description=__doc__)
    args.add_argument("program")
    args.add_argument("folder", type=pathlib.Path)
    args.add_argument("--seconds", type=int, default=240)
    args = args.parse_args()
    print("| network | | tips | plain | `--refine` |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for given in sorted(p for p in args.folder.iterdir() if p.suffix in (".vtp", ".swc")):
            prepared = folder / (given.stem + ".vtp")
            run(args.program, ["prepare", given, "-o", prepared, "-q"], args.seconds)
            for name, network in (("as it is", given), ("prepared", prepared)):
                cells = [meshed(args.program, network, folder / "m.vtu", how, args.seconds) for how in ([], ["--refine"])]
                print(f"| {given.name} | {name} | {tips(args.program, network)} | {' | '.join(cells)} |")
                sys.stdout.flush()


if __name__ == "__main__":
    main()
