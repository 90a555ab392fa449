"""SIGTERM at random moments of a run: prints the time until the end, and what is left.

    python3 benches/stops.py [--program PATH] [--times N] [--longest SECONDS] FILE ...

Each file is meshed N times, plain and with `--refine` in turn, and stopped after a random time of at most SECONDS. The
program must end within two seconds and leave no file.
"""

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BOUND = 2.0


def stopped(program, network, options, after):
    """Seconds until the end after the signal, exit code, files left. `None` seconds: it had ended before."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "mesh", str(network), "-o", f"{folder}/mesh.vtu", "-q", *options]
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            child.wait(timeout=after)
            return None, child.returncode, []
        except subprocess.TimeoutExpired:
            pass
        start = time.time()
        child.send_signal(signal.SIGTERM)
        try:
            child.wait(timeout=60)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        took = time.time() - start
        left = sorted(p.name for p in Path(folder).iterdir())
        # A run that ends by itself before it sees the signal leaves its mesh.
        return took, child.returncode, [] if child.returncode in (0, 1) else left


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="anastomesh")
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--longest", type=float, default=10.0)
    parser.add_argument("files", nargs="+", type=Path)
    args = parser.parse_args()
    rng = random.Random(4)
    all_times, bad = [], 0
    for file in args.files:
        times = []
        for i in range(args.times):
            options = ["--refine"] if i % 2 else []
            took, code, left = stopped(args.program, file, options, rng.uniform(0.05, args.longest))
            if took is None:
                continue
            times.append(took)
            if took > BOUND or left:
                bad += 1
                print(f"{file.name} {' '.join(options)}: {took:.2f} s, exit {code}, left {left}", flush=True)
        worst = f"{max(times):.2f}" if times else "-"
        print(f"{file.name}: {len(times)} of {args.times} stopped, worst {worst} s", flush=True)
        all_times += times
    print(f"{len(all_times)} stopped, worst {max(all_times, default=0.0):.2f} s, {bad} too late or with files left")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
