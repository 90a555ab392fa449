"""Difficult generated networks, meshed within a limit of CPU time. Prints CPU seconds, exit code and last line of each run.

    python3 benches/difficult.py [--program PATH] [--limit SECONDS] [--only TEXT] [--keep DIR] [FILE ...]

Without files, the networks are generated: lattices, planar trees, neurons, vessels wider than long, noisy radii, saws,
concentric and parallel vessels. Each is meshed as it is and with `--refine`. A run that exceeds the limit is killed and
shown as `killed`: blocks have budgets, so that none should.
"""

import argparse
import math
import os
import random
import resource
import subprocess
import tempfile
from pathlib import Path


def vtk(path, points, radii, edges):
    """Writes a network as a legacy VTK file."""
    lines = ["# vtk DataFile Version 3.0", "network", "ASCII", "DATASET POLYDATA", f"POINTS {len(points)} double"]
    lines += [" ".join(f"{x:.9g}" for x in p) for p in points]
    lines.append(f"LINES {len(edges)} {3 * len(edges)}")
    lines += [f"2 {a} {b}" for a, b in edges]
    lines += [f"POINT_DATA {len(points)}", "SCALARS Radius double 1", "LOOKUP_TABLE default"]
    lines += [f"{r:.9g}" for r in radii]
    path.write_text("\n".join(lines) + "\n")


def lattice(edges, step, radius, noise=0.0):
    """Cubic lattice with about so many edges, and the radius and noise of positions in units of length."""
    rng = random.Random(1)
    n = max(2, round((edges / 3) ** (1 / 3)))
    number = {}
    points, links = [], []
    for i in range(n):
        for j in range(n):
            for k in range(n):
                number[i, j, k] = len(points)
                points.append([step * x + noise * rng.uniform(-1, 1) for x in (i, j, k)])
    for (i, j, k), a in number.items():
        links += [(a, number[b]) for b in ((i + 1, j, k), (i, j + 1, k), (i, j, k + 1)) if b in number]
    return points, [radius] * len(points), links


def planar_tree(levels, ratio=0.8, spread=0.55):
    """Binary tree in a plane, whose outer vessels cross each other."""
    points, radii, edges = [[0.0, 0.0, 0.0]], [4.0], []

    def grow(start, angle, length, radius, level):
        p = points[start]
        points.append([p[0] + length * math.cos(angle), p[1] + length * math.sin(angle), 0.0])
        radii.append(radius)
        end = len(points) - 1
        edges.append((start, end))
        if level:
            for side in (-1, 1):
                grow(end, angle + side * spread, ratio * length, 0.79 * radius, level - 1)

    grow(0, 0.0, 30.0, 4.0, levels)
    return points, radii, edges


def neuron(branches, seed):
    """Soma of a large radius with thin winding branches, whose segments are shorter than their radius."""
    rng = random.Random(seed)
    points, radii, edges = [[0.0, 0.0, 0.0]], [8.0], []
    for _ in range(branches):
        direction = [rng.gauss(0, 1) for _ in range(3)]
        at, r = 0, 1.5
        for k in range(60):
            length = math.sqrt(sum(x * x for x in direction))
            direction = [x / length + rng.gauss(0, 0.25) for x in direction]
            step = 9.0 if k == 0 else 0.8
            points.append([p + step * d for p, d in zip(points[at], direction)])
            r = max(0.4, r * 0.985)
            radii.append(r)
            edges.append((at, len(points) - 1))
            at = len(points) - 1
    return points, radii, edges


def polyline(points, radii):
    return points, radii, [(i, i + 1) for i in range(len(points) - 1)]


def wide(count, ratio):
    """Chain of vessels that are wider than long, with one thin vessel at its end."""
    points = [[float(i), 0.3 * (i % 2), 0.0] for i in range(count)] + [[count + 3.0 * ratio, 0.0, 0.0]]
    return polyline(points, [float(ratio)] * count + [1.0])


def noisy(count, noise):
    """Straight vessel whose radius is noise."""
    rng = random.Random(3)
    radii = [math.exp(rng.gauss(0, noise)) for _ in range(count)]
    return polyline([[0.7 * i, 0.0, 0.0] for i in range(count)], radii)


def saw(amplitude, count=120):
    """Zigzag with teeth of a height in radii, closer to each other than the vessel is wide."""
    return polyline([[0.3 * i, amplitude * (i % 2), 0.0] for i in range(count)], [1.0] * count)


def joined(parts, link=None):
    """Networks side by side, and optional edges between their nodes."""
    points, radii, edges = [], [], list(link or [])
    for p, r, e in parts:
        first = len(points)
        points += p
        radii += r
        edges += [(first + a, first + b) for a, b in e]
    return points, radii, edges


def parallel(gap):
    """Two tubes that start at one node and run beside each other, with a gap in radii."""
    line = lambda y: [[3.0 * i, y, 0.0] for i in range(14)]
    y = 1.0 + gap / 2
    points = [[-8.0, 0.0, 0.0]] + line(-y) + line(y)
    edges = [(0, 1), (0, 15)] + [(i, i + 1) for i in range(1, 14)] + [(i, i + 1) for i in range(15, 28)]
    return points, [1.0] * len(points), edges


def concentric(count):
    """Tubes within tubes along one axis, joined at one end."""
    parts = [polyline([[2.0 * i, 0.01 * k, 0.0] for i in range(20)], [1.0 + k] * 20) for k in range(count)]
    return joined(parts, [(20 * k, 20 * k + 20) for k in range(count - 1)])


def tree_in_3d(levels, seed):
    """Binary tree in space with well-separated vessels."""
    rng = random.Random(seed)
    points, radii, edges = [[0.0, 0.0, 0.0]], [2.0], []

    def grow(start, direction, length, radius, level):
        points.append([p + length * d for p, d in zip(points[start], direction)])
        radii.append(radius)
        end = len(points) - 1
        edges.append((start, end))
        if level:
            side = [rng.gauss(0, 1) for _ in range(3)]
            dot = sum(a * b for a, b in zip(side, direction))
            side = [a - dot * b for a, b in zip(side, direction)]
            size = math.sqrt(sum(x * x for x in side))
            for sign in (-0.75, 0.75):
                new = [d + sign * s / size for d, s in zip(direction, side)]
                norm = math.sqrt(sum(x * x for x in new))
                grow(end, [x / norm for x in new], 0.8 * length, 0.79 * radius, level - 1)

    grow(0, [1.0, 0.0, 0.0], 40.0, 2.0, levels)
    return points, radii, edges


KINDS = {
    "lattice_1000_free": lambda: lattice(1000, 12.0, 1.0),
    "lattice_1000_tight": lambda: lattice(1000, 2.5, 1.0),
    "lattice_1000_noise": lambda: lattice(1000, 6.0, 1.0, 1.5),
    "lattice_100000_free": lambda: lattice(100_000, 12.0, 1.0),
    "lattice_100000_tight": lambda: lattice(100_000, 2.5, 1.0),
    "planar_8": lambda: planar_tree(8),
    "planar_11": lambda: planar_tree(11),
    "neuron_10": lambda: neuron(10, 5),
    "neuron_40": lambda: neuron(40, 6),
    "wide_10": lambda: wide(30, 10),
    "wide_1000": lambda: wide(5, 1000),
    "noisyR300": lambda: noisy(300, 0.5),
    "noisyR300_strong": lambda: noisy(300, 1.0),
    "saw0.3": lambda: saw(0.3),
    "saw3": lambda: saw(3.0),
    **{f"parallel_{gap}": (lambda gap=gap: parallel(gap)) for gap in (0.001, 0.01, 0.05, 0.1, 0.5)},
    "nested_concentric": lambda: concentric(3),
    "tree_7": lambda: tree_in_3d(7, 2),
}


def run(program, network, options, limit):
    """CPU seconds, exit code and last line of a run."""
    with tempfile.TemporaryDirectory() as folder, open(f"{folder}/output", "w+") as output:
        command = [program, "mesh", str(network), "-o", f"{folder}/mesh.vtu", *options]
        bound = lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
        child = subprocess.Popen(command, stdout=output, stderr=output, preexec_fn=bound)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        code = "killed" if child.returncode < 0 else str(child.returncode)
        output.seek(0)
        lines = [line for line in output.read().splitlines() if line.strip()] or [""]
        return usage.ru_utime + usage.ru_stime, code, lines[-1][:110]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="anastomesh")
    parser.add_argument("--limit", type=int, default=60)
    parser.add_argument("--only", default="")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("files", nargs="*", type=Path)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        files = args.files
        if not files:
            keep = args.keep or Path(folder)
            keep.mkdir(exist_ok=True)
            names = [name for name in KINDS if args.only in name]
            files = [keep / f"{name}.vtk" for name in names]
            for name, file in zip(names, files):
                vtk(file, *KINDS[name]())
        print("| network | options | CPU s | exit | last line |\n|---|---|---|---|---|")
        for file in files:
            for options in ([], ["--refine"]):
                seconds, code, line = run(args.program, file, options, args.limit)
                row = (file.stem, " ".join(options) or "plain", f"{seconds:.1f}", code, line)
                print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
