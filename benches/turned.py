#!/usr/bin/env python3
"""Surfaces turned in space and subdivided, through `anastomesh tetrahedralize --no-refine` and `tetgen -pY`.

    python3 benches/turned.py FOLDER [--seeds 5] [--forms turned,float,split] [--only PART]... [--limit 61]
        [--save FOLDER] [--tetgen PATH|none]

Each surface of the folder (OFF), consistently oriented by --repair where needed, comes in these forms (needs numpy):

turned  by a random rotation about the origin, vertices rounded to doubles, once for each seed
float   the same rotations, vertices rounded to floats
split   each triangle split in four at the midpoints of its edges, once and twice, straight and turned (seed 1)

Forms that meet themselves after rounding are told by `tetrahedralize --check-only`, which tests all pairs exactly; they
count as refused, and no program is asked for them. Of the rest, each has to be kept: the exit code is 0 and the
certificate has passed. One line per surface and form, the sum at the end. Needs numpy.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

from surfaces import faces_of_tetgen, run


def read_off(path):
    words = [w for line in open(path) for w in line.split("#")[0].split()]
    points, faces = int(words[1]), int(words[2])
    corners = np.array(words[4 : 4 + 3 * points], float).reshape(-1, 3)
    triangles = np.array(words[4 + 3 * points : 4 + 3 * points + 4 * faces], int).reshape(-1, 4)
    assert (triangles[:, 0] == 3).all()
    return corners, triangles[:, 1:]


def write_off(path, points, triangles):
    with open(path, "w") as f:
        f.write(f"OFF\n{len(points)} {len(triangles)} 0\n")
        f.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        f.writelines(f"3 {a} {b} {c}\n" for a, b, c in triangles.tolist())


def rotation(seed):
    """Uniform over all rotations: a random quaternion."""
    q = np.random.default_rng(seed).normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def split(points, triangles):
    """Every triangle in four, at the midpoints of its edges, rounded."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, which = np.unique(ends, axis=0, return_inverse=True)
    middle = 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])
    a, b, c = triangles.T
    ab, bc, ca = (len(points) + which.reshape(3, -1)[k] for k in range(3))
    quarters = [np.stack(t, axis=1) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return np.concatenate([points, middle]), np.concatenate(quarters)


def forms(args, points, triangles):
    """Pairs of a name and a surface."""
    kinds = args.forms.split(",")
    for seed in range(1, args.seeds + 1):
        turned = points @ rotation(seed).T
        if "turned" in kinds:
            yield f"turned {seed}", (turned, triangles)
        if "float" in kinds:
            yield f"float {seed}", (turned.astype(np.float32).astype(float), triangles)
    if "split" in kinds:
        fine = (points, triangles)
        for times in ("once", "twice"):
            if 4 * len(fine[1]) > args.max_triangles:
                break
            fine = split(*fine)
            yield f"split {times}", fine
            yield f"split {times}, turned", (fine[0] @ rotation(1).T, fine[1])


def oriented(args, path):
    """A surface as it is, or as --repair makes it where that is needed."""
    points, triangles = read_off(path)
    kind = ["--plc"] if path.stem.startswith("plc_") else []
    command = [args.program, "tetrahedralize", str(path), "-q", *kind]
    if subprocess.run([*command, "--check-only"], capture_output=True).returncode == 0:
        return points, triangles
    with tempfile.TemporaryDirectory() as folder:
        done = os.path.join(folder, "mesh.ele")
        subprocess.run([*command, "-o", done, "--no-refine", "--repair"], check=True)
        rows = [line.split()[1:4] for line in list(open(os.path.join(folder, "mesh.face")))[1:] if line[0] != "#"]
        assert len(rows) == len(triangles), f"{path}: repaired, but not only turned"
        return points, np.array(rows, int)


def tetgen(args, surface, triangles, folder):
    code, cpu, _, _, _ = run([args.tetgen, "-pYQ", surface], args.limit, folder)
    if code != 0 or not os.path.exists(os.path.join(folder, "surface.1.face")):
        return cpu, "too long" if code is None else f"exit {code}"
    there = faces_of_tetgen(os.path.join(folder, "surface.1.face"))
    lost = sum(frozenset(t) not in there for t in triangles.tolist())
    return cpu, f"{lost} lost" if lost else "yes"


def case(args, name, form, surface):
    """What became of one surface: valid, kept, CPU, what was said; the same of TetGen."""
    points, triangles = surface
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "surface.off")
        write_off(path, points, triangles)
        plain = [args.program, "tetrahedralize", path, "-j", "1"] + (["--plc"] if name.startswith("plc_") else [])
        code, cpu, _, out, err = run(plain + ["-o", "ours.ele", "--no-refine", "--json"], args.limit, folder)
        row = {"surface": name, "form": form, "triangles": len(triangles), "cpu": round(cpu, 2), "kept": code == 0}
        if code == 0:
            row["tets"] = json.loads(out)["report"]["mesh"]["tets"]
            row["steiner"] = json.loads(out)["report"].get("recovery", {}).get("steiner_points")
        else:
            row["said"] = "too long" if code is None else err.strip().splitlines()[0][:160] if err.strip() else f"exit {code}"
            check, row["check_cpu"], _, _, why = run(plain + ["--check-only"], args.limit, folder)
            row["valid"] = check == 0
            if check != 0:
                row["why"] = why.strip().splitlines()[0][:160] if why.strip() else f"exit {check}"
            if args.save:
                shutil.copy(path, os.path.join(args.save, f"{name} {form}.off".replace(" ", "_").replace(",", "")))
        if args.tetgen != "none" and row.get("valid", True):
            row["tetgen_cpu"], row["tetgen"] = tetgen(args, path, triangles, folder)
        return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--forms", default="turned,float,split")
    parser.add_argument("--only", action="append", default=[], help="surfaces whose name has this part")
    parser.add_argument("--max-triangles", type=int, default=10**9, help="of a form")
    parser.add_argument("--program", default="target/release/anastomesh")
    parser.add_argument("--tetgen", default=shutil.which("tetgen") or "none")
    parser.add_argument("--limit", type=int, default=61, help="CPU seconds after which a run is ended")
    parser.add_argument("--jobs", type=int, default=2, help="cases at a time")
    parser.add_argument("--save", help="folder for the surfaces that are not kept")
    parser.add_argument("--out", help="file for one line of JSON per case")
    args = parser.parse_args()
    args.program = os.path.abspath(args.program)
    if args.tetgen != "none":
        args.tetgen = os.path.abspath(args.tetgen)
    if args.save:
        os.makedirs(args.save, exist_ok=True)
    out = open(args.out, "w") if args.out else None
    rows = []

    def cases():
        for path in sorted(args.folder.glob("*.off")):
            if args.only and not any(part in path.name for part in args.only):
                continue
            points, triangles = oriented(args, path)
            for form, surface in forms(args, points, triangles):
                if len(surface[1]) <= args.max_triangles:
                    yield path.stem, form, surface

    def done():
        """Rows in the order of the cases. Few wait at a time, since they are large when split twice."""
        waiting = []
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            for one in cases():
                waiting.append(pool.submit(case, args, *one))
                if len(waiting) > 4 * args.jobs:
                    yield waiting.pop(0).result()
            yield from (row.result() for row in waiting)

    for row in done():
        rows.append(row)
        if out:
            out.write(json.dumps(row) + "\n")
            out.flush()
        if not row["kept"]:
            print(row, flush=True)
    print("\n| form | cases | refused: meets itself | kept | TetGen kept | CPU s | TetGen CPU s | longest CPU s |\n|---|---|---|---|---|---|---|---|")
    names = dict.fromkeys(r["form"].split(" ")[0] if "split" not in r["form"] else r["form"] for r in rows)
    for name in [*names, "all"]:
        some = [r for r in rows if name == "all" or r["form"] == name or r["form"].split(" ")[0] == name]
        valid = [r for r in some if r.get("valid", True)]
        kept = [r for r in valid if r["kept"]]
        both = [r for r in kept if r.get("tetgen") == "yes"]
        figures = [len(some), len(some) - len(valid), len(kept), sum(r.get("tetgen") == "yes" for r in valid),
                   f"{sum(r['cpu'] for r in both):.1f}", f"{sum(r['tetgen_cpu'] for r in both):.1f}",
                   f"{max((r['cpu'] for r in kept), default=0):.1f}"]
        print(f"| {name} | " + " | ".join(map(str, figures)) + " |")
    print("\nCPU is that of the surfaces that both keep.")


if __name__ == "__main__":
    main()
