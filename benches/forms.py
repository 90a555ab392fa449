#!/usr/bin/env python3
"""Difficult technical surfaces, generated from seeds, as OFF files for `benches/turned.py`'s programs and others.

    python3 benches/forms.py FOLDER [--count 200] [--kinds extrusion,stairs,plate,split]

extrusion   a star-shaped polygon with nearly collinear corners, extruded in layers; caps by random ears, so with needles
stairs      a union of axis-aligned boxes over a grid with thin slices: a staircase in two directions
plate       a plate of squares whose corners are moved in the plane, and by 1e-16 to 1e-6 off it
split       an extrusion, each triangle split in four at the midpoints of its edges

Each is turned by a random rotation; every second one is rounded to floats. `--run PROGRAM` (the example `recovery` of
`crates/tet`) fills each file and prints the sum. Needs numpy.
"""

import argparse
import pathlib
import subprocess

import numpy as np

from turned import rotation, split, write_off


def caps(polygon, rng):
    """Triangles of a polygon (counter-clockwise corners in a plane) by random ears."""
    def area(a, b, c):
        (ax, ay), (bx, by), (cx, cy) = polygon[a], polygon[b], polygon[c]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    left, triangles = list(range(len(polygon))), []
    while len(left) > 3:
        for k in rng.permutation(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            inside = any(
                p not in (a, b, c) and area(a, b, p) >= 0 and area(b, c, p) >= 0 and area(c, a, p) >= 0 for p in left
            )
            if area(a, b, c) > 0 and not inside:
                triangles.append([a, b, c])
                left.pop(k)
                break
        else:
            return None
    return triangles + [left]


def extrusion(rng):
    n, layers = int(rng.integers(12, 90)), int(rng.integers(1, 4))
    angles = np.sort(rng.uniform(0, 2 * np.pi, n))
    radii = np.where(rng.random(n) < 0.5, 1.0, rng.uniform(0.6, 1.0, n))
    polygon = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    top = caps(polygon.tolist(), rng)
    if top is None:
        return None
    heights = np.concatenate([[0.0], np.sort(rng.uniform(0.02, 1.0, layers))])
    points = np.concatenate([np.column_stack([polygon, np.full(n, z)]) for z in heights])
    triangles = [[c, b, a] for a, b, c in top] + [[layers * n + v for v in t] for t in top]
    for layer in range(layers):
        for i in range(n):
            a, b = layer * n + i, layer * n + (i + 1) % n
            c, d = b + n, a + n
            triangles += [[a, b, c], [a, c, d]] if rng.random() < 0.5 else [[a, b, d], [b, c, d]]
    return points, np.array(triangles)


def quads(squares, rng):
    """Points and triangles of squares given by their corners, each with a random diagonal."""
    index, triangles = {}, []
    for square in squares:
        a, b, c, d = (index.setdefault(tuple(p), len(index)) for p in square)
        triangles += [[a, b, c], [a, c, d]] if rng.random() < 0.5 else [[a, b, d], [b, c, d]]
    return np.array(list(index), float), np.array(triangles)


def stairs(rng):
    n, levels = int(rng.integers(4, 12)), int(rng.integers(2, 7))
    height = -np.sort(-np.sort(-rng.integers(1, levels + 1, (n, n)), axis=0), axis=1)
    height = np.minimum.accumulate(np.minimum.accumulate(np.abs(height), axis=0), axis=1)
    lines = [np.cumsum(np.where(rng.random(n + 1) < 0.3, 1e-3, rng.uniform(0.2, 1.0, n + 1))) for _ in range(2)]
    floors = np.cumsum(np.where(rng.random(levels + 1) < 0.3, 1e-3, rng.uniform(0.2, 1.0, levels + 1)))
    at = lambda i, j, k: (lines[0][i], lines[1][j], floors[k])
    solid = lambda i, j, k: 0 <= i < n and 0 <= j < n and 0 <= k < height[i, j]
    squares = []
    for i, j in np.ndindex(n, n):
        for k in range(height[i, j]):
            corner = lambda x, y, z: at(i + x, j + y, k + z)
            faces = {
                (-1, 0, 0): [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)],
                (1, 0, 0): [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
                (0, -1, 0): [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
                (0, 1, 0): [(0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)],
                (0, 0, -1): [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)],
                (0, 0, 1): [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
            }
            for (x, y, z), square in faces.items():
                if not solid(i + x, j + y, k + z):
                    squares.append([corner(*c) for c in square])
    return quads(squares, rng)


def plate(rng):
    n = int(rng.integers(6, 30))
    points, triangles = quads(
        [[(i, j, 1), (i + 1, j, 1), (i + 1, j + 1, 1), (i, j + 1, 1)] for i, j in np.ndindex(n, n)]
        + [[(i, j, 0), (i, j + 1, 0), (i + 1, j + 1, 0), (i + 1, j, 0)] for i, j in np.ndindex(n, n)]
        + [[(i, 0, 0), (i + 1, 0, 0), (i + 1, 0, 1), (i, 0, 1)] for i in range(n)]
        + [[(i, n, 0), (i, n, 1), (i + 1, n, 1), (i + 1, n, 0)] for i in range(n)]
        + [[(0, i, 0), (0, i, 1), (0, i + 1, 1), (0, i + 1, 0)] for i in range(n)]
        + [[(n, i, 0), (n, i + 1, 0), (n, i + 1, 1), (n, i, 1)] for i in range(n)],
        rng,
    )
    inner = ((points[:, :2] > 0) & (points[:, :2] < n)).all(axis=1)
    points[inner, :2] += rng.uniform(-0.3, 0.3, (inner.sum(), 2))
    points[:, 2] += 10.0 ** -rng.uniform(6, 16) * rng.normal(size=len(points))
    return points * [1, 1, rng.choice([0.01, 0.3, 2.0])], triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=200, help="files of each kind")
    parser.add_argument("--kinds", default="extrusion,stairs,plate,split")
    parser.add_argument("--run", help="program that fills each file")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    makers = {"extrusion": extrusion, "stairs": stairs, "plate": plate, "split": extrusion}
    paths = []
    for kind in args.kinds.split(","):
        for seed in range(args.count):
            rng = np.random.default_rng([seed, len(kind)])
            made = makers[kind](rng)
            if made is None:
                continue
            points, triangles = split(*made) if kind == "split" else made
            points = points @ rotation(seed).T
            points = points.astype(np.float32).astype(float) if seed % 2 else points
            paths.append(args.folder / f"{kind}_{seed}.off")
            write_off(paths[-1], points, triangles)
    print(f"{len(paths)} surfaces")
    if args.run:
        out = subprocess.run([args.run, *map(str, paths)], capture_output=True, text=True, check=True).stdout
        rows = [line.split() for line in out.splitlines()]
        failed = [line for line in out.splitlines() if line.split()[2] == "error"]
        done = [row for row in rows if row[2] != "error"]
        print("\n".join(failed))
        print(f"{len(done)} filled, {len(failed)} errors, {sum(int(row[3]) for row in done)} Steiner points, "
              f"{sum(float(row[4]) for row in done):.1f} s, longest {max(float(row[4]) for row in done):.2f} s")


if __name__ == "__main__":
    main()
