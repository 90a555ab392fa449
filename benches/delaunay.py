#!/usr/bin/env python3
"""Delaunay tetrahedralization of points beside TetGen's, as a table in Markdown.

    cargo build --release -p anastomesh-tet --example delaunay
    python3 benches/delaunay.py [--kind cube|grid|sphere|cylinder] [--points N] [--runs K] [--program PATH] [--tetgen PATH]

cube      random points in the unit cube
grid      a cubic grid with a step of 0.1
sphere    random points on the unit sphere, as nearly as coordinates allow
cylinder  rings of 100 points each round an axis

Each run takes all in turn: TetGen on the points alone, without files to write (-NEF), then ours on one thread and on two.
The median of the runs is shown. CPU is user time of the whole process, reading included; behind it in brackets that of the
tetrahedralization alone: by ours' own clock, and TetGen's line 'Delaunay seconds', which is user and system time.
"""

import argparse
import math
import os
import random
import re
import statistics
import subprocess
import tempfile
import time


def points_of(kind, count):
    unit = random.Random(1).random
    if kind == "grid":
        side = round(count ** (1 / 3))
        return [(x * 0.1, y * 0.1, z * 0.1) for x in range(side) for y in range(side) for z in range(side)]
    if kind == "cylinder":
        angles = [math.tau * i / 100 for i in range(100)]
        return [(math.cos(w), math.sin(w), 0.06 * z) for z in range(count // 100) for w in angles]
    if kind == "cube":
        return [(unit(), unit(), unit()) for _ in range(count)]

    def on_sphere():
        z, w = 2 * unit() - 1, math.tau * unit()
        return math.sqrt(1 - z * z) * math.cos(w), math.sqrt(1 - z * z) * math.sin(w), z

    return [on_sphere() for _ in range(count)]


def run(command, folder, threads):
    """What one run took; `own` and `inner` are CPU and wall-clock seconds of the tetrahedralization alone."""
    out = os.path.join(folder, "out")
    with open(out, "w") as stdout:
        environment = dict(os.environ, RAYON_NUM_THREADS=str(threads))
        start = time.monotonic()
        process = subprocess.Popen(command, cwd=folder, stdout=stdout, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{command}: exit code {process.returncode}")
    with open(out) as stdout:
        text = stdout.read()

    def number(*patterns):
        found = next(filter(None, (re.search(pattern, text) for pattern in patterns)), None)
        return float(found[1]) if found else math.nan

    inner = number(r"wall ([\d.]+) s")
    return {
        "user": usage.ru_utime,
        "sys": usage.ru_stime,
        "mb": usage.ru_maxrss / 1024,
        "tets": number(r"(\d+) tetrahedra\b", r"Mesh tetrahedra: +(\d+)"),
        "own": number(r"user ([\d.]+) s", r"Delaunay seconds: +([\d.]+)"),
        "inner": wall if math.isnan(inner) else inner,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kind", choices=["cube", "grid", "sphere", "cylinder"], default="cube")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--program", default="target/release/examples/delaunay")
    parser.add_argument("--tetgen", default="tetgen")
    args = parser.parse_args()
    program = os.path.abspath(args.program)
    points = points_of(args.kind, args.points)
    with tempfile.TemporaryDirectory() as folder:
        file = f"{args.kind}.node"
        with open(os.path.join(folder, file), "w") as node:
            node.write(f"{len(points)} 3 0 0\n")
            node.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(points))
        kinds = {
            "TetGen": ([args.tetgen, "-NEF", file], 1),
            "ours, 1 thread": ([program, file], 1),
            "ours, 2 threads": ([program, file], 2),
        }
        results = {name: [] for name in kinds}
        for _ in range(args.runs):
            for name, (command, threads) in kinds.items():
                results[name].append(run(command, folder, threads))
    middle = {name: {k: statistics.median(r[k] for r in rows) for k in rows[0]} for name, rows in results.items()}
    tets = int(middle["TetGen"]["tets"])
    print(f"{args.kind}: {len(points):,} points, {tets:,} tetrahedra; median of {args.runs} runs\n")
    print("| | user CPU (tetrahedralization) | its wall clock | CPU over TetGen's (range) | tetrahedra/s | peak memory |")
    print("|---|---|---|---|---|---|")
    for name, m in middle.items():
        ratios = [r["user"] / t["user"] for r, t in zip(results[name], results["TetGen"])]
        print(
            f"| {name} | {m['user']:.2f} s ({m['own']:.2f}) | {m['inner']:.2f} s "
            f"| {statistics.median(ratios):.2f} ({min(ratios):.2f}–{max(ratios):.2f}) | {m['tets'] / m['own'] / 1e6:.2f} M "
            f"| {m['mb']:.0f} MB, {m['mb'] * 2**20 / m['tets']:.0f} bytes/tetrahedron |"
        )


if __name__ == "__main__":
    main()
