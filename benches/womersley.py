#!/usr/bin/env python3
"""Womersley flow in a straight tube by pimpleFoam, against the analytic solution.

usage: womersley.py [--anastomesh PROGRAM] [--rho 8] [--layers N] [--case FOLDER]
needs: OpenFOAM (v1912 or later of openfoam.com) and numpy

The tube has radius 5 mm and length 30 mm, the fluid is blood, and the flow rate 3e-6 (1 + 0.9 sin 2 pi t) m3/s of period
1 s (Womersley number 6.9). Its profile is set at the inlet. The velocity of the cells near the axis, in the middle
fifth of the length, is compared over the second period."""
import argparse, json, os, re, subprocess, tempfile
import numpy as np

RADIUS, LENGTH, RATE, SWING, PERIOD, NU = 5e-3, 30e-3, 3e-6, 0.9, 1.0, 3.5e-3 / 1060
OMEGA = 2 * np.pi / PERIOD


def bessel(z):
    """Bessel function J0 of complex numbers, by its power series."""
    term = total = np.ones_like(z)
    for k in range(1, 200):
        term = term * (-z * z / 4) / k**2
        total = total + term
    return total


def analytic(r, t):
    """Axial velocity at radius r (an array) and time t."""
    area, alpha = np.pi * RADIUS**2, RADIUS * np.sqrt(OMEGA / NU)
    z = np.exp(0.75j * np.pi) * alpha
    share = np.asarray(r, dtype=complex) / RADIUS
    # Mean of 1 - J0(z s) / J0(z) over the section, by Gauss-Legendre in s.
    s, w = np.polynomial.legendre.leggauss(60)
    s, w = (s + 1) / 2, w / 2
    mean = np.sum(2 * s * w * (1 - bessel(z * s) / bessel(z)))
    pulse = SWING * (1 - bessel(z * share) / bessel(z)) / mean * np.exp(1j * (OMEGA * t - np.pi / 2))
    return RATE / area * (2 * (1 - share.real**2) + pulse.real)


def make(program, case, rho, layers):
    """Writes the case and runs pimpleFoam."""
    folder = os.path.dirname(case)
    with open(f"{folder}/tube.swc", "w") as file:
        file.writelines(f"{i + 1} 3 0 0 {5 * i} 5 {i or -1}\n" for i in range(7))
    with open(f"{folder}/pulse.csv", "w") as file:
        file.write("time,flow\n")
        for i in range(101):
            t = PERIOD * i / 100
            file.write(f"{t!r},{float(RATE * (1 + SWING * np.sin(OMEGA * (t % PERIOD))))!r}\n")
    command = [program, "mesh", f"{folder}/tube.swc", "--units", "mm:m", "--rho", str(rho), "-o", case, "-q"]
    command += ["--inflow", f"{folder}/pulse.csv", "--inlet-profile", "womersley", "--periods", "2"]
    subprocess.run(command + (["--layers", str(layers)] if layers else []), check=True)
    subprocess.run(["pimpleFoam", "-case", case], check=True, stdout=open(f"{folder}/log", "w"))


def binary_list(path, kind, width, key=b""):
    """Values of a list in a binary file, after a key."""
    data = open(path, "rb").read()
    start = data.index(b"}") if not key else data.index(key)
    found = re.compile(rb"(\d+)\s*\(").search(data, start + len(key))
    count = int(found.group(1)) * width
    return np.frombuffer(data, kind, count, found.end()), found.end() + count * np.dtype(kind).itemsize


def centres(case):
    """Centres of the cells, as means of their vertices."""
    mesh = f"{case}/constant/polyMesh"
    points = binary_list(f"{mesh}/points", "<f8", 3)[0].reshape(-1, 3)
    offsets, end = binary_list(f"{mesh}/faces", "<i4", 1)
    data = open(f"{mesh}/faces", "rb").read()
    found = re.compile(rb"(\d+)\s*\(").search(data, end)
    corners = np.frombuffer(data, "<i4", int(found.group(1)), found.end())
    owner = binary_list(f"{mesh}/owner", "<i4", 1)[0]
    neighbour = binary_list(f"{mesh}/neighbour", "<i4", 1)[0]
    face = np.repeat(np.arange(len(owner)), np.diff(offsets))
    pairs = [np.stack([owner[face], corners], 1)]
    inner = face < len(neighbour)
    pairs.append(np.stack([neighbour[face[inner]], corners[inner]], 1))
    cell, vertex = np.unique(np.concatenate(pairs), axis=0).T
    count = np.bincount(cell)
    return np.stack([np.bincount(cell, points[vertex, axis]) / count for axis in range(3)], 1)


def compare(case):
    """Errors of the mean velocity near the axis, relative to its maximum over a period."""
    middle = centres(case)
    r = np.hypot(middle[:, 0], middle[:, 1])
    near = (r < 0.2 * RADIUS) & (abs(middle[:, 2] - LENGTH / 2) < LENGTH / 10)
    rows = []
    for name in os.listdir(case):
        if re.fullmatch(r"[\d.]+", name) and float(name) > PERIOD * 1.001:
            velocity = binary_list(f"{case}/{name}/U", "<f8", 3, b"nonuniform List<vector>")[0].reshape(-1, 3)
            t = float(name)
            rows.append((t, velocity[near, 2].mean(), analytic(r[near], t).mean()))
    rows.sort()
    t, found, exact = np.array(rows).T
    return dict(cells=len(middle), near_axis=int(near.sum()), times=len(t), largest=float(exact.max()),
                error=float(abs(found - exact).max() / exact.max()), rms=float(np.sqrt(np.mean((found - exact) ** 2)) / exact.max()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--anastomesh", default="anastomesh")
    parser.add_argument("--rho", type=float, default=8)
    parser.add_argument("--layers", type=int)
    parser.add_argument("--case", help="a finished case instead of a new one")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        case = args.case or f"{folder}/tube.foam"
        if not args.case:
            make(args.anastomesh, case, args.rho, args.layers)
        print(json.dumps(compare(case), indent=1))


if __name__ == "__main__":
    main()
