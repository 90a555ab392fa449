#!/usr/bin/env python3
"""Networks of folders with wall and tissue: each region judged as a mesh of its own, and points of equal number compared.

    python3 benches/domains.py --judge PATH/mesh_judge.py --program PATH [--limit SECONDS] [--options "..."] FILE...

Prints a row per network: exit code, tetrahedra of each region, time, memory, and the verdict of the judge. The exit code is 1 if a mesh that the program calls valid fails any test. Needs numpy and meshio.
"""
import argparse
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import meshio
import numpy as np

OPTIONS = "--refine --wall 0.2r --wall-layers 2 --tissue box"


def run(command, limit, folder):
    """Exit code, seconds, memory in MB, report, and last line of the messages."""
    began = time.time()
    with open(folder / "out", "w+") as out, open(folder / "err", "w+") as err:
        child = subprocess.Popen(command, stdout=out, stderr=err,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        text, notes = out.read(), err.read().strip().splitlines()
    try:
        report = json.loads(text)
    except json.JSONDecodeError:
        report = {}
    return child.returncode, time.time() - began, usage.ru_maxrss / 1024, report, notes[-1] if notes else ""


def judge(program, path):
    """Problems that the judge finds in one file; empty without any."""
    done = subprocess.run([sys.executable, program, str(path), "--samples", "0"], capture_output=True, text=True)
    try:
        found = json.loads(done.stdout)
    except json.JSONDecodeError:
        return f"no verdict: {done.stderr[-300:]}"
    return "; ".join(map(str, found["problems"]))


def shared(paths):
    """Number of points with equal global number and different bits, over the files of all regions."""
    known, wrong = {}, 0
    for path in paths:
        data = meshio.read(path)
        for key, point in zip(np.asarray(data.point_data["GlobalNodeID"]).ravel().tolist(), data.points):
            bits = point.tobytes()
            wrong += known.setdefault(key, bits) != bits
    return wrong


def one(arguments, network, folder):
    """Row of a network, and whether a mesh called valid is not."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    target = folder / "m.vtu"
    command = [arguments.program, "mesh", str(network), "-o", str(target), "--json", "--split-regions", *arguments.options.split()]
    code, seconds, memory, report, last = run(command, arguments.limit, folder)
    files = sorted(path for path in folder.glob("m_*.vtu"))
    faults = [f"{path.stem[2:]}: {fault}" for path in files if (fault := judge(arguments.judge, path))] if code == 0 else []
    wrong = shared(files) if code == 0 else 0
    faults += [f"{wrong} points differ"] if wrong else []
    regions = ", ".join(f"{region['name']} {region['tets']:,}" for region in report.get("check", {}).get("regions", []))
    verdict = "; ".join(faults) or ("judged valid" if code == 0 else last[:160])
    print(f"| {network.stem} | {code} | {regions} | {seconds:.0f} s | {memory:.0f} MB | {verdict} |", flush=True)
    return bool(faults)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--judge", required=True)
    parser.add_argument("--program", default="target/release/anastomesh")
    parser.add_argument("--limit", type=int, default=600)
    parser.add_argument("--options", default=OPTIONS)
    parser.add_argument("networks", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    print("| network | exit | tetrahedra | time | memory | verdict |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        sys.exit(any([one(arguments, network, pathlib.Path(folder, "run")) for network in arguments.networks]))


main()
