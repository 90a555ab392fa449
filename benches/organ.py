#!/usr/bin/env python3
"""Whole organs: time, memory, failures. Needs a release build; networks are named or grown by the program itself.

  organ.py mesh NETWORK... [--rho 3,4,5] [--refine]    one row per network and rho
  organ.py grow SEED...   [--terminals 30000]           grown networks, refined and meshed: what failed, what was retried
  organ.py scale EDGES... [--seed 0]                    grown networks of so many edges: cost per edge
  organ.py threads NETWORK [--pairs 7]                  one thread against two, interleaved
  organ.py kills NETWORK [--kills 20]                   killed at random moments, then the same bytes

With --read-back meshes are read from their files again and verified by `check` (one row more for each).

Meshes go into --folder (default: a temporary one) and are removed at once. Times are of the whole process, with CPU time of
user and system; "blocks" and "check" are wall clock.
"""
import argparse
import filecmp
import json
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import time

PROGRAM = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "target", "release", "anastomesh")


def run(arguments):
    """Runs the program; its JSON (if it printed some), exit code, wall, user and system seconds, peak bytes."""
    start = time.monotonic()
    with tempfile.TemporaryFile() as out:
        child = subprocess.Popen([OPTIONS.program, *arguments], stdout=out, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        out.seek(0)
        text = out.read()
    report = json.loads(text) if text.startswith(b"{") else None
    wall = time.monotonic() - start
    return report, os.waitstatus_to_exitcode(status), wall, usage.ru_utime, usage.ru_stime, usage.ru_maxrss * 1024


def mesh(network, *options):
    out = os.path.join(OPTIONS.folder, "mesh.vtu")
    result = run(["mesh", network, "-o", out, "--json", "-q", "--keep-going", *options])
    size = os.path.getsize(out) if os.path.exists(out) else 0
    if OPTIONS.read_back and size > 0:
        read_back(out)
    if os.path.exists(out):
        os.remove(out)
    return result, size


def read_back(path):
    report, code, wall, user, system, peak = run(["check", path, "--json"])
    verdict = report["verdict"] if report else f"exit {code}"
    row("read back", verdict, f"{user + system:.0f} s CPU", f"{wall:.0f} s", f"{peak / 2**20:.0f} MiB")


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def heading(*cells):
    row(*cells)
    row(*["---"] * len(cells))


def describe(name, rho, result, size):
    report, code, wall, user, system, peak = result
    if report is None:
        return row(name, rho, f"exit {code}", *[""] * 9)
    done, stages = report["run"], {s["stage"]: s["seconds"] for s in report["run"]["stages"]}
    quality = (report.get("check") or {}).get("quality") or {}
    blocks = done["blocks"]["clusters"] + done["blocks"]["connectors"]
    verdict = (report.get("check") or {}).get("verdict", "none")
    row(name, rho, f"{done['network'][1]:,}", f"{done['mesh']['tets'] / 1e6:.1f} M",
        f"{len(done['failed'])} / {len(done['retries'])} of {blocks:,}", verdict,
        f"{quality.get('mean', 0):.4f} / {quality.get('percentile_1', 0):.3f} / {quality.get('min', 0):.3f}",
        f"{quality.get('dihedral_min', 0):.1f}°", f"{user + system:.0f} s", f"{wall:.0f} s",
        " + ".join(f"{stages.get(s, 0):.0f}" for s in ["partition", "blocks", "check", "write"]),
        f"{peak / 2**20:.0f} MiB", f"{size / 1e9:.1f} GB")


COLUMNS = ["network", "ρ", "edges", "tetrahedra", "failed / retried", "check", "radius ratio mean / 1 % / min", "dihedral",
           "CPU", "wall", "partition + blocks + check + write", "peak", "VTU"]


def refined():
    return ["--refine", "--crowded-terminals", "part"] if OPTIONS.refine else []


def command_mesh():
    heading(*COLUMNS)
    for network in OPTIONS.items:
        for rho in OPTIONS.rho.split(","):
            describe(os.path.basename(network), rho, *mesh(network, "--rho", rho, *refined()))


def grown(terminals, seed):
    path = os.path.join(OPTIONS.folder, f"grown_{terminals}_{seed}.vtp")
    run(["generate", "--terminals", str(terminals), "--organ", OPTIONS.organ, "--seed", str(seed), "-o", path, "-q"])
    return path


def command_grow():
    heading(*COLUMNS)
    OPTIONS.refine = True
    for seed in OPTIONS.items:
        network = grown(OPTIONS.terminals, seed)
        describe(f"{OPTIONS.organ}, seed {seed}", 3, *mesh(network, *refined()))
        os.remove(network)


def command_scale():
    heading("edges", "tetrahedra", "failed / retried", "CPU per edge", "wall per edge", "peak", "check")
    for edges in map(int, OPTIONS.items):
        network = grown((edges + 1) // 2, OPTIONS.seed)
        fit = os.path.join(OPTIONS.folder, "refined.vtp")
        run(["refine", network, "-o", fit, "--crowded-terminals", "part", "-q"])
        (report, code, wall, user, system, peak), _ = mesh(fit)
        os.remove(network)
        if report is None:
            row(edges, f"exit {code}")
            continue
        done = report["run"]
        count = done["network"][1]
        row(f"{count:,}", f"{done['mesh']['tets'] / 1e6:.2f} M", f"{len(done['failed'])} / {len(done['retries'])}",
            f"{(user + system) / count * 1e3:.2f} ms", f"{wall / count * 1e3:.2f} ms", f"{peak / 2**20:.0f} MiB",
            report["check"]["verdict"])


def command_threads():
    ratios = []
    for _ in range(OPTIONS.pairs):
        one = mesh(OPTIONS.items[0], "-j", "1")[0][2]
        two = mesh(OPTIONS.items[0], "-j", "2")[0][2]
        ratios.append(one / two)
        print(f"one {one:.2f} s, two {two:.2f} s: {one / two:.2f}", flush=True)
    print(f"median {statistics.median(ratios):.2f}")


def command_kills():
    plain, out = (os.path.join(OPTIONS.folder, name) for name in ["plain.vtu", "out.vtu"])
    work = os.path.join(OPTIONS.folder, "work")
    arguments = ["mesh", OPTIONS.items[0], "-q"]
    wall = run([*arguments, "-o", plain])[2]
    dice, finished = random.Random(1), 0
    for kill in range(OPTIONS.kills):
        # Together these take somewhat longer than one undisturbed run, so the last ones hit its check and its writing.
        moment = dice.uniform(0.0, 2.6) * wall / OPTIONS.kills
        child = subprocess.Popen([OPTIONS.program, *arguments, "-o", out, "--work-dir", work], stderr=subprocess.DEVNULL)
        try:
            child.wait(moment)
            finished += 1
        except subprocess.TimeoutExpired:
            child.send_signal(signal.SIGKILL)
            child.wait()
        kept = os.path.getsize(os.path.join(work, "anastomesh.blocks"))
        print(f"kill {kill + 1} after {moment:.2f} s: {kept / 1e6:.1f} MB kept, mesh there: {os.path.exists(out)}", flush=True)
    run([*arguments, "-o", out, "--work-dir", work])
    same = filecmp.cmp(plain, out, shallow=False)
    print(f"{OPTIONS.kills - finished} kills, {finished} runs ended before; same bytes: {same}")
    return 0 if same else 1


def main():
    global OPTIONS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["mesh", "grow", "scale", "threads", "kills"])
    parser.add_argument("items", nargs="+")
    parser.add_argument("--rho", default="3")
    parser.add_argument("--refine", action="store_true")
    parser.add_argument("--terminals", type=int, default=30000)
    parser.add_argument("--organ", default="kidney")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--read-back", action="store_true")
    parser.add_argument("--pairs", type=int, default=7)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--folder")
    parser.add_argument("--program", default=PROGRAM)
    OPTIONS = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=OPTIONS.folder) as folder:
        OPTIONS.folder = folder
        return globals()[f"command_{OPTIONS.command}"]() or 0


if __name__ == "__main__":
    sys.exit(main())
