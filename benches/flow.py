#!/usr/bin/env python3
"""Stokes flow through our meshes beside that through the lumen as a CAD kernel makes it, as tables in Markdown.

    python3 benches/flow.py NETWORK.swc --judge DIR [--rho 3,5] [--sizes 0.45,0.33] [--program PATH] [--folder DIR]
    python3 benches/flow.py --tubes --judge DIR [--rho 5]

DIR holds cad_lumen.py (union of cones and spheres, meshed by gmsh), stokes.py (P2-P1 elements of NGSolve, unit pressure) and
swc_flow.py (Poiseuille in cones). Outlets are matched by where their caps are. Conductances are in the units of the network
for a viscosity of 1. What --folder keeps is not made again.

Edges of the CAD mesh are chords of its wall: it has less volume than the CAD body, and less conductance. Of two sizes the
script extrapolates to a size of 0, errors going with the square of the size (row `CAD, size → 0`), and holds ours against that,
too. --tubes: straight and tapered tubes against Poiseuille's law, no CAD.
"""

import argparse
import contextlib
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile


def said(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{command}: {(done.stderr or done.stdout)[-2000:]}")
    return done.stdout


def kept(path, make):
    """The text of a file, made if it is not there."""
    if not path.exists():
        path.write_text(make())
    return path.read_text()


def solved(mesh, given):
    """Flow through each outlet, the place of its cap, and the volume."""
    import numpy as np

    sys.path.insert(0, given.judge)
    import vmesh

    flow = json.loads(kept(mesh.with_suffix(".json"),
                           lambda: said([sys.executable, f"{given.judge}/stokes.py", mesh, "--order", "2"])))
    with contextlib.redirect_stdout(None):  # meshio prints an empty line.
        loaded = vmesh.load(str(mesh))
    points, tets = loaded["pts"], loaded["tets"]
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    places = {}
    for label, name in loaded["names"].items():
        if name in flow["fraction"]:
            corners = points[loaded["tris"][loaded["lab"] == label]]
            weights = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
            places[name] = (corners.mean(axis=1) * weights[:, None]).sum(axis=0) / weights.sum()
    volume = float(np.linalg.det(edges).sum() / 6)
    total = sum(flow["flow"][name] for name in places)
    return dict(tets=len(tets), total=total, fraction=flow["fraction"], places=places, volume=abs(volume))


def nodes(network):
    import numpy as np

    rows = [[float(word) for word in line.split()] for line in open(network) if line.strip() and line[0] != "#"]
    return np.array(rows)


def cad(network, size, folder, given):
    """Flow through the CAD lumen, brought back to the units and places of the network."""
    import numpy as np

    mesh = folder / f"cad_{size}.msh"
    log = kept(folder / f"cad_{size}.log",
               lambda: said([sys.executable, f"{given.judge}/cad_lumen.py", network, mesh, size]))
    table = nodes(network)
    unit, middle = float(np.median(table[:, 5])), table[:, 2:5].mean(axis=0)
    found = solved(mesh, given)
    body = float(re.search(r"volumes \[.*?\] \[([0-9.e+]+)", log)[1])
    return found | dict(total=found["total"] * unit**3, volume=found["volume"] * unit**3, body=body * unit**3,
                        places={name: place * unit + middle for name, place in found["places"].items()})


def ours(network, rho, folder, given):
    mesh = folder / f"ours_{rho}.msh"
    if not mesh.exists():
        said([given.program, "mesh", network, "-o", mesh, "--rho", rho, "-q"])
    return solved(mesh, given)


def beside(found, reference):
    """Fractions of one's outlets beside those of the reference: pairs, by the place of the cap."""
    import numpy as np

    pairs = []
    for name, place in found["places"].items():
        distance, other = min((float(np.linalg.norm(place - at)), other) for other, at in reference["places"].items())
        pairs.append((found["fraction"][name], reference["fraction"][other], other, distance))
    assert len({pair[2] for pair in pairs}) == len(pairs) == len(reference["places"])
    return pairs


def row(name, found, reference):
    pairs = beside(found, reference)
    most = max(pairs, key=lambda pair: abs(pair[0] - pair[1]))
    large = [(abs(a / b - 1), b, outlet) for a, b, outlet, _ in pairs if b > 0.02]
    worst = max(large)
    over = sum(1 for difference, *_ in large if difference > 0.06)
    print(f"| {name} | {found.get('tets', ''):,} | {found['volume'] / reference['body'] - 1:+.1%} "
          f"| {found['total'] / reference['total'] - 1:+.1%} | {abs(most[0] - most[1]):.4f} ({most[2]}) "
          f"| {worst[0]:.1%} ({worst[2]}, {worst[1]:.1%} of the flow) | {over} of {len(large)} |", flush=True)


def limit(coarse, fine, sizes):
    """Two sizes extrapolated to 0, the error going with the square."""
    a, b = (size**2 for size in sizes)
    value = lambda x, y: (y * a - x * b) / (a - b)
    other = {pair[2]: pair[0] for pair in beside(coarse, fine)}
    fraction = {name: value(other[name], share) for name, share in fine["fraction"].items()}
    volume = value(coarse["volume"], fine["volume"])
    return fine | dict(tets=0, fraction=fraction, total=value(coarse["total"], fine["total"]), volume=volume)


def network(path, folder, given):
    sizes = [float(word) for word in given.sizes.split(",")]
    lumens = [cad(path, size, folder, given) for size in sizes]
    line = json.loads(kept(folder / "line.json", lambda: said([sys.executable, f"{given.judge}/swc_flow.py", path])))
    table = {str(int(entry[0])): entry[2:5] for entry in nodes(path)}
    line = dict(total=line["total"], fraction=line["fraction"], places={name: table[name] for name in line["fraction"]},
                volume=math.nan, tets=0)
    meshes = [(f"ours, ρ = {rho}", ours(path, rho, folder, given)) for rho in given.rho.split(",")]
    references = list(zip([f"CAD, size {size}" for size in sizes], lumens))
    if len(sizes) == 2:
        references.append(("CAD, size → 0", limit(*lumens, sizes)))
    for name, reference in references:
        print(f"\nBeside {name} (conductance {reference['total']:.5g}, volume of its mesh "
              f"{reference['volume'] / reference['body'] - 1:+.1%} of the body's):\n")
        print("| | tetrahedra | volume beside the CAD body | conductance | fraction differs by at most (outlet) "
              "| of outlets above 2 %: by at most | above 6 % |\n|---|---|---|---|---|---|---|")
        for other, found in [*((n, r) for n, r in references if n != name and r["tets"]), *meshes, ("one-dimensional", line)]:
            row(other, found, reference)


def tubes(folder, given):
    print("| tube | ρ | tetrahedra | conductance beside Poiseuille's law |\n|---|---|---|---|")
    for name, ends in [("straight, 20 radii", (1.0, 1.0)), ("1 to 0.7 in 20", (1.0, 0.7)), ("1 to 0.5 in 20", (1.0, 0.5))]:
        swc = folder / "tube.swc"
        swc.write_text(f"1 0 0 0 0 {ends[0]} -1\n2 0 6 3 18.734994 {ends[1]} 1\n")
        law = json.loads(said([sys.executable, f"{given.judge}/swc_flow.py", swc]))["total"]
        for rho in given.rho.split(","):
            mesh = folder / "tube.msh"
            said([given.program, "mesh", swc, "-o", mesh, "--rho", rho, "-q"])
            found = solved(mesh, given)
            mesh.with_suffix(".json").unlink()
            print(f"| {name} | {rho} | {found['tets']:,} | {found['total'] / law - 1:+.2%} |", flush=True)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("network", nargs="?")
    options.add_argument("--tubes", action="store_true")
    options.add_argument("--judge", required=True)
    options.add_argument("--rho", default="3,5")
    options.add_argument("--sizes", default="0.45,0.33")
    options.add_argument("--program", default="target/release/anastomesh")
    options.add_argument("--folder")
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(given.folder or folder).resolve()
        if given.tubes:
            tubes(folder, given)
        else:
            network(given.network, folder, given)


if __name__ == "__main__":
    main()
