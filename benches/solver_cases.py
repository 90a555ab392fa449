#!/usr/bin/env python3
"""Runs OpenFOAM on cases of anastomesh, as tables in Markdown.

    python3 benches/solver_cases.py FOLDER [--steady] [--pulsatile] [--resistance] [--program PATH] [--reynolds 1,10,100,1000] [NETWORK ...]

Each network is meshed plain, with `--stretch 4`, with `--layers 3`, and with both. A network `y` is written by this script.
Steady cases run at each Reynolds number of the inlet. Pulsatile cases have two periods at a mean Reynolds number of 1, with
inflow 1 + 0.5 sin and a Womersley number of 2. Fractions are compared with ../shared/judge/stokes.py on the plain mesh, where
it runs, and pulsatile ones also with the steady case of the same mesh. Rows are printed as they come."""

import argparse
import csv
import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

BENCHES = Path(__file__).resolve().parent
SHARED = BENCHES.parent.parent / "shared"
VISCOSITY = 3.5e-3 / 1060.0
OPTIONS = {"plain": [], "stretch": ["--stretch", "4"], "layers": ["--layers", "3"], "both": ["--stretch", "4", "--layers", "3"]}
Y = """1 3 0 0 0 1 -1
2 3 0 0 8 1 1
3 3 6 0 14 0.8 2
4 3 -5 0 13 0.7 2
"""


def run(command, log):
    """Exit code; output goes to a file."""
    with open(log, "w") as file:
        environment = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
        return subprocess.run([str(word) for word in command], stdout=file, stderr=subprocess.STDOUT, env=environment).returncode


def mesh(args, network, options, target):
    units = "um:m" if "subtree" in network.name else "mm:m"
    log = target.with_suffix(".log")
    shutil.rmtree(target, ignore_errors=True)
    if run([args.program, "mesh", network, "--units", units, "-o", target, "-q", *options], log) != 0:
        sys.exit(log.read_text())


def inlet(table):
    """Flow rate and radius of the first inlet."""
    with open(table) as file:
        row = next(row for row in csv.DictReader(file) if row["name"].startswith("inlet"))
    return float(row["flow"]), math.sqrt(float(row["area"]) / math.pi)


def stokes(args, network):
    """Fractions of flow on the plain mesh, by quadratic elements."""
    result = args.folder / f"{network.stem}.stokes.json"
    if not result.exists():
        mesh(args, network, [], args.folder / f"{network.stem}.vtu")
        run([sys.executable, SHARED / "judge/stokes.py", args.folder / f"{network.stem}.vtu", "--order", "2"], result)
    try:
        return json.loads(result.read_text())["fraction"]
    except ValueError:
        return {}


def summary(case):
    sys.path.insert(0, str(BENCHES))
    import foam

    return foam.summary(str(case))


def apart(found, other):
    return f"{max(abs(found[name] - other[name]) for name in other):.4f}" if other else ""


def checked(case):
    """Verdict of checkMesh: its complaints, and the number of cells."""
    run(["checkMesh", "-case", case, "-allGeometry", "-allTopology"], case / "check.log")
    text = (case / "check.log").read_text()
    complaints = re.findall(r"^ *\*+(.*)", text, re.M)
    cells = re.search(r"cells: +(\d+)", text).group(1)
    return cells, "; ".join(re.sub(r"\s+", " ", line).strip(" *") for line in complaints) or "OK"


def solved(case, solver):
    code = run([solver, "-case", case], case / "solver.log")
    text = (case / "solver.log").read_text()
    steps = len(re.findall(r"^Time = ", text, re.M))
    seconds = re.findall(r"ExecutionTime = ([\d.]+)", text)
    residuals = {name: float(value) for name, value in re.findall(r"Solving for (\w+), Initial residual = (\S+),", text)}
    return dict(ok=code == 0, text=text, steps=steps, seconds=float(seconds[-1]) if seconds else math.nan, residuals=residuals)


def steady(args, network, kind, reynolds):
    case = args.folder / f"{network.stem}_{kind}_{reynolds:g}.foam"
    mesh(args, network, OPTIONS[kind], case)
    if reynolds != 1:
        rate, _ = inlet(case.parent / f"{case.stem}_patches.csv")
        mesh(args, network, [*OPTIONS[kind], "--inflow", f"{rate * reynolds:.17e}"], case)
    cells, complaints = checked(case)
    end = solved(case, "simpleFoam")
    converged = "SIMPLE solution converged" in end["text"]
    worst = max(end["residuals"].values(), default=math.nan)
    verdict = f"{end['steps']}" if converged else f"not in {end['steps']}"
    fractions = apart(summary(case)["fractions"], stokes(args, network)) if converged else ""
    row = [network.stem, kind, f"{reynolds:g}", cells, complaints, verdict, f"{worst:.1e}", f"{end['seconds']:.0f} s", fractions]
    print("| " + " | ".join(row) + " |", flush=True)


def pulsatile(args, network, kind):
    case = args.folder / f"{network.stem}_{kind}_pulse.foam"
    still = args.folder / f"{network.stem}_{kind}_1.foam"
    if not (still / "solver.log").exists():
        steady(args, network, kind, 1.0)
    rate, radius = inlet(args.folder / f"{still.stem}_patches.csv")
    period = 2 * math.pi * radius**2 / (VISCOSITY * 2.0**2)
    wave = args.folder / f"{network.stem}_{kind}.csv"
    times = [step / 200 for step in range(201)]
    values = [rate * (1 + 0.5 * math.sin(2 * math.pi * time)) for time in times]
    wave.write_text("time,flow\n" + "".join(f"{t * period:.17e},{v:.17e}\n" for t, v in zip(times, values)))
    more = ["--inflow", wave, "--periods", "2", "--outputs", "20"]
    mesh(args, network, [*OPTIONS[kind], *more], case)
    end = solved(case, "pimpleFoam")
    if not end["ok"]:
        print(f"| {network.stem} | {kind} | diverged in step {end['steps']} |", flush=True)
        return
    found, calm = summary(case), summary(still)
    error = abs(found["inflow"] / calm["inflow"] - 1)
    row = [network.stem, kind, f"{end['steps']}", f"{end['seconds']:.0f} s", f"{error:.1e}"]
    row += [apart(found["fractions"], calm["fractions"]), apart(found["fractions"], stokes(args, network))]
    print("| " + " | ".join(row) + " |", flush=True)


def resistance(args, network, kind):
    case = args.folder / f"{network.stem}_{kind}_r.foam"
    mesh(args, network, OPTIONS[kind], case)
    with open(case.parent / f"{case.stem}_patches.csv") as file:
        rows = list(csv.DictReader(file))
    pressure = 2 * max(float(row["pressure"]) for row in rows if row["name"].startswith("inlet"))
    mesh(args, network, [*OPTIONS[kind], "--outlet-model", "resistance", "--mean-pressure", f"{pressure:e}"], case)
    end = solved(case, "simpleFoam")
    converged = "SIMPLE solution converged" in end["text"]
    error = f"{summary(case)['model_error']:.2%}" if converged else ""
    print(f"| {network.stem} | {kind} | {end['steps'] if converged else 'not converged'} | {error} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("networks", nargs="+")
    for name in ("steady", "pulsatile", "resistance"):
        parser.add_argument(f"--{name}", action="store_true")
    parser.add_argument("--program", default="anastomesh")
    parser.add_argument("--reynolds", default="1,10,100,1000")
    parser.add_argument("--kinds", default=",".join(OPTIONS))
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    for name in args.networks:
        network = Path(name)
        if name == "y":
            network = args.folder / "y.swc"
            network.write_text(Y)
        for kind in args.kinds.split(","):
            if args.steady:
                for reynolds in args.reynolds.split(","):
                    steady(args, network, kind, float(reynolds))
            if args.resistance:
                resistance(args, network, kind)
            if args.pulsatile:
                pulsatile(args, network, kind)


if __name__ == "__main__":
    main()
