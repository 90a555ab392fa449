#!/usr/bin/env python3
"""Results of OpenFOAM cases written by anastomesh: flow rates and pressures at inlets and outlets.

usage: foam.py CASE [--compare OTHER_CASE] [--stokes STOKES.json]

Prints, over all results but those of the first half of the time: the inflow, outlet fractions (means over time), and the
largest difference of P + R Q from the mean pressure of an outlet with a resistance, relative to the pressure. Fractions are
compared with those of another case, and of ../shared/judge/stokes.py."""
import argparse, json, os, re, struct

import numpy as np


def patches(case):
    """Names of the patches."""
    text = open(f"{case}/constant/polyMesh/boundary").read()
    return re.findall(r"(\S+) \{ type", text)


def times(case):
    """Names of the folders with results, by time."""
    names = [name for name in os.listdir(case) if re.fullmatch(r"[\d.]+(e-\d+)?", name) and float(name) > 0]
    return sorted(names, key=float)


def boundary(path, names):
    """Values on the faces of patches in a scalar field."""
    data, at, values = open(path, "rb").read(), 0, {}
    at = data.index(b"boundaryField")
    for name in names:
        start = re.compile(rb"\n\s*" + re.escape(name.encode()) + rb"\s*\n\s*\{").search(data, at)
        found = re.compile(rb"\n\s*value\s+(uniform|nonuniform List<scalar>)\s+([\d.e+-]*)").search(data, start.end())
        if found.group(1) == b"uniform":
            values[name] = [float(found.group(2))]
        else:
            begin = data.index(b"(", found.end(1)) + 1
            values[name] = struct.unpack_from(f"<{int(found.group(2))}d", data, begin)
    return values


def binary_list(data, kind, start):
    """Values of the list in binary data that begins after a position, and its end."""
    found = re.compile(rb"(\d+)\s*\(").search(data, start)
    values = np.frombuffer(data, kind, int(found.group(1)) * (3 if kind == "<f8" else 1), found.end())
    return values, found.end() + values.nbytes


def areas(case, names):
    """Areas of the faces of patches."""
    mesh = f"{case}/constant/polyMesh"
    data = open(f"{mesh}/points", "rb").read()
    points = binary_list(data, "<f8", data.index(b"}"))[0].reshape(-1, 3)
    data = open(f"{mesh}/faces", "rb").read()
    offsets, end = binary_list(data, "<i4", data.index(b"}"))
    corners, _ = binary_list(data, "<i4", end)
    text, found = open(f"{mesh}/boundary").read(), {}
    for name in names:
        count, start = re.search(rf"\b{name} \{{.*nFaces (\d+); startFace (\d+);", text).groups()
        faces = [points[corners[offsets[i] : offsets[i + 1]]] for i in range(int(start), int(start) + int(count))]
        found[name] = np.array([np.linalg.norm(np.cross(f, np.roll(f, -1, 0)).sum(0)) / 2 for f in faces])
    return found


def resistances(case):
    """Pressure and resistance of outlets with a model, by density."""
    line = re.compile(r"^\s*(\S+) \{ \$outletModel; Rp (\S+); Rd (\S+); tau (\S+); P (\S+);", re.M)
    found = line.findall(open(f"{case}/0/p").read())
    return {name: (float(p), float(rp) + float(rd)) for name, rp, rd, tau, p in found if float(tau) == 0}


def summary(case):
    """Mean flow rates and pressures of the last half of the results."""
    names = [name for name in patches(case) if name.startswith(("inlet", "outlet"))]
    outlets = [name for name in names if name.startswith("outlet")]
    models, listed = resistances(case), times(case)
    late = [name for name in listed if float(name) > 0.5001 * float(listed[-1])] or listed[-1:]
    flows, error, area = {name: 0.0 for name in names}, None, areas(case, models)
    for time in late:
        phi, p = boundary(f"{case}/{time}/phi", names), boundary(f"{case}/{time}/p", outlets)
        for name in names:
            flows[name] += sum(phi[name]) / len(late)
        for name, (beyond, resistance) in models.items():
            pressure = np.average(np.broadcast_to(p[name], area[name].shape), weights=area[name])
            apart = abs(beyond + resistance * sum(phi[name]) - pressure) / abs(pressure)
            error = max(error or 0.0, apart)
    inflow = -sum(rate for name, rate in flows.items() if name.startswith("inlet"))
    return dict(results=len(late), inflow=inflow, fractions={name: flows[name] / inflow for name in outlets}, model_error=error)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case")
    parser.add_argument("--compare")
    parser.add_argument("--stokes")
    args = parser.parse_args()
    found = summary(args.case)
    apart = lambda other: max(abs(found["fractions"][name] - other[name]) for name in other)
    if args.compare:
        found["difference"] = apart(summary(args.compare)["fractions"])
    if args.stokes:
        found["difference_to_stokes"] = apart(json.load(open(args.stokes))["fraction"])
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
