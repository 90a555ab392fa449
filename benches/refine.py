#!/usr/bin/env python3
"""CPU of `anastomesh refine` per iteration and edge, for copies of one tree side by side and for given networks.

    python3 benches/refine.py NETWORK.vtp [--copies 1,2,4] [--other FILE]... [--program PATH] [--iterations 200]

The cost of an iteration is that of the run less that of a run of no iterations (reading, splitting, the figures, writing),
over the iterations that it took (it ends early when nothing is left to do). Peak memory is the process's. Needs pyvista,
to read NETWORK.vtp and write copies of it as SWC.
"""

import argparse
import json
import os
import subprocess
import tempfile

import numpy as np
import pyvista as pv


def copies(path, n, out):
    """n copies of a tree side by side, as SWC."""
    tree = pv.read(path)
    points, lines = np.asarray(tree.points, float), tree.lines.reshape(-1, 3)[:, 1:]
    radius, width = tree["Radius"], np.ptp(points[:, 0]) + 10 * tree["Radius"].max()
    children = [[] for _ in points]
    has_parent = np.zeros(len(points), bool)
    for a, b in lines:
        children[a].append(b)
        has_parent[b] = True
    with open(out, "w") as file:
        number = 0
        for copy in range(n):
            stack = [(i, -1) for i in np.where(~has_parent)[0]]
            while stack:
                node, parent = stack.pop()
                number += 1
                x, y, z = points[node] + [copy * width, 0, 0]
                print(number, 0, x, y, z, radius[node], parent, file=file)
                stack += [(child, number) for child in children[node]]


def run(program, network, iterations):
    """CPU seconds, wall seconds, peak MB, report."""
    command = [program, "refine", network, "-o", "/dev/null/none.vtp", "--json", "-q"]
    with tempfile.TemporaryDirectory() as folder:
        command[4] = os.path.join(folder, "out.vtp")
        command += ["--iterations", str(iterations), "--every", "0", "--residual", "report"]
        with tempfile.TemporaryFile() as out:
            started = os.times().elapsed
            process = subprocess.Popen(command, stdout=out)
            _, _, usage = os.wait4(process.pid, 0)
            wall = os.times().elapsed - started
            out.seek(0)
            report = json.load(out)["report"]
    return usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024, report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("network")
    parser.add_argument("--copies", default="1,2,4")
    parser.add_argument("--other", action="append", default=[])
    parser.add_argument("--program", default="target/release/anastomesh")
    parser.add_argument("--iterations", type=int, default=200)
    args = parser.parse_args()
    print("| network | edges | iterations | CPU s | wall s | µs per iteration and edge | peak MB |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        networks = list(args.other)
        for n in args.copies.split(","):
            name = os.path.join(folder, f"{n} of {os.path.basename(args.network)}.swc")
            copies(args.network, int(n), name)
            networks.append(name)
        for network in networks:
            nothing, *_ = run(args.program, network, 0)
            cpu, wall, memory, report = run(args.program, network, args.iterations)
            # Nothing is sampled in between: the last sample is that of the last iteration.
            steps, edges = report["history"][-1]["iteration"], report["size_after"][1]
            each = 1e6 * (cpu - nothing) / steps / edges
            name = os.path.splitext(os.path.basename(network))[0]
            print(f"| {name} | {edges} | {steps} | {cpu:.1f} | {wall:.1f} | {each:.2f} | {memory:.0f} |", flush=True)


if __name__ == "__main__":
    main()
