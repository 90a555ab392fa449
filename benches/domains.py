#!/usr/bin/env python3
"""Networks with wall and tissue: each region judged as a mesh of its own, and points of equal number compared.

    python3 benches/domains.py --judge PATH/mesh_judge.py [--program PATH] [--limit SECONDS] [--options "..."] NETWORK...

Prints a row per network: exit code (none beyond the limit), tetrahedra of each region, CPU seconds, memory, and the verdict
of the judge. The exit code is 1 if a mesh that the program calls valid fails any test. Needs numpy and meshio.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import meshio
import numpy as np

from surfaces import run

OPTIONS = "--refine --wall 0.2r --wall-layers 2 --tissue box"


def problems(judge, path):
    """Problems that the judge finds in one file."""
    done = subprocess.run([sys.executable, judge, str(path), "--samples", "0"], capture_output=True, text=True)
    try:
        return json.loads(done.stdout)["problems"]
    except json.JSONDecodeError:
        return [f"no verdict: {done.stderr[-300:]}"]


def differing(paths):
    """Number of points with equal global number and different bits, over the files of all regions."""
    known, wrong = {}, 0
    for path in paths:
        data = meshio.read(path)
        for key, point in zip(np.asarray(data.point_data["GlobalNodeID"]).ravel().tolist(), data.points):
            bits = point.tobytes()
            wrong += known.setdefault(key, bits) != bits
    return wrong


def faults(judge, regions, folder):
    """Faults of the files of all regions."""
    paths = [folder / f"m_{region['name']}.vtu" for region in regions]
    lost = [path.name for path in paths if not path.exists()]
    if lost or not regions:
        return [f"files not there: {lost}"]
    found = [f"{path.stem}: {problem}" for path in paths for problem in problems(judge, path)]
    wrong = differing(paths)
    return found + [f"{wrong} points differ"] * (wrong > 0)


def case(arguments, network):
    """Prints the row of a network. Returns true if a mesh called valid has a fault."""
    with tempfile.TemporaryDirectory() as folder:
        command = [arguments.program, "mesh", str(network.absolute()), "-o", "m.vtu", "--json", "--split-regions"]
        code, cpu, memory, out, err = run(command + arguments.options.split(), arguments.limit, folder)
        regions = json.loads(out)["check"]["regions"] if code == 0 else []
        found = faults(arguments.judge, regions, pathlib.Path(folder)) if code == 0 else []
    last = (err.strip().splitlines() or [""])[-1]
    verdict = "; ".join(found) or ("judged valid" if code == 0 else last[:160])
    counts = ", ".join(f"{region['name']} {region['tets']:,}" for region in regions)
    print(f"| {network.stem} | {code} | {counts} | {cpu:.0f} s | {memory:.0f} MB | {verdict} |", flush=True)
    return bool(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--judge", required=True)
    parser.add_argument("--program", default="target/release/anastomesh")
    parser.add_argument("--limit", type=int, default=600, help="CPU seconds after which a run is ended")
    parser.add_argument("--options", default=OPTIONS)
    parser.add_argument("networks", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.program = os.path.abspath(arguments.program)
    print("| network | exit | tetrahedra | CPU | memory | verdict |\n|---|---|---|---|---|---|")
    sys.exit(any([case(arguments, network) for network in arguments.networks]))


main()
