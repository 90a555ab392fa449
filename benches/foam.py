#!/usr/bin/env python3
"""Results of OpenFOAM cases written by anastomesh: flow rates and pressures at inlets and outlets.

usage: foam.py CASE [--compare OTHER_CASE] [--stokes STOKES.json]

Prints, over all results but those of the first half of the time: the inflow, outlet fractions (means over time), and the
largest difference of P + R Q from the pressure of an outlet with a resistance, relative to the pressure. Fractions are
compared with those of another case, and of ../shared/judge/stokes.py."""
import argparse, json, os, re, struct


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
    flows, error = {name: 0.0 for name in names}, None
    for time in late:
        phi, p = boundary(f"{case}/{time}/phi", names), boundary(f"{case}/{time}/p", outlets)
        for name in names:
            flows[name] += sum(phi[name]) / len(late)
        for name, (beyond, resistance) in models.items():
            pressure = sum(p[name]) / len(p[name])
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
