#!/usr/bin/env python3
"""Writes a closed surface inside a box as one complex of facets (.off), for `tetrahedralize --plc` and TetGen.

    python3 benches/boxed.py SURFACE.off BOX.off [--margin 0.2] [--divisions 1]

The box is larger than the surface by `--margin` times the longest side. Each of its sides has 2 · divisions² triangles.
"""

import argparse


def read_off(path):
    """Points and triangles."""
    words = [word for line in open(path) for word in line.split("#")[0].split()]
    count, faces = int(words[1]), int(words[2])
    points = [tuple(map(float, words[4 + 3 * i : 7 + 3 * i])) for i in range(count)]
    at = 4 + 3 * count
    return points, [tuple(map(int, words[at + 4 * i + 1 : at + 4 * i + 4])) for i in range(faces)]


def box(low, high, divisions):
    """Points and triangles of a box, facing outwards."""
    index, triangles = {}, []

    def corner(place):
        return index.setdefault(place, len(index))

    for axis in range(3):
        for side in (0, divisions):
            for i in range(divisions):
                for j in range(divisions):
                    def at(u, v):
                        place = [0, 0, 0]
                        place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = side, u, v
                        return corner(tuple(place))

                    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
                    triangles += [(a, b, c), (a, c, d)] if side else [(a, c, b), (a, d, c)]
    points = [tuple(low[k] + (high[k] - low[k]) * place[k] / divisions for k in range(3)) for place in index]
    return points, triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("surface")
    parser.add_argument("output")
    parser.add_argument("--margin", type=float, default=0.2)
    parser.add_argument("--divisions", type=int, default=1)
    args = parser.parse_args()
    points, triangles = read_off(args.surface)
    low, high = ([pick(p[k] for p in points) for k in range(3)] for pick in (min, max))
    margin = args.margin * max(b - a for a, b in zip(low, high))
    low, high = [x - margin for x in low], [x + margin for x in high]
    more, sides = box(low, high, args.divisions)
    sides = [tuple(v + len(points) for v in t) for t in sides]
    with open(args.output, "w") as out:
        out.write(f"OFF\n{len(points) + len(more)} {len(triangles) + len(sides)} 0\n")
        out.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in points + more)
        out.writelines(f"3 {a} {b} {c}\n" for a, b, c in triangles + sides)


if __name__ == "__main__":
    main()
