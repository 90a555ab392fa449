"""Share of a command's CPU time in which only one of its threads runs (Linux).

    python3 benches/serial.py target/release/anastomesh mesh NETWORK -o m.vtu -j 2
"""

import glob
import os
import subprocess
import sys
import time

STEP = 0.02
# CPU time of all other threads, per second, below which a thread counts as alone.
ALONE = 0.1


def cpu_of_threads(pid):
    """CPU seconds of each thread."""
    used = {}
    for path in glob.glob(f"/proc/{pid}/task/*/schedstat"):
        try:
            with open(path) as file:
                used[path.split("/")[4]] = int(file.read().split()[0]) / 1e9
        except OSError:
            pass  # The thread has ended.
    return used


def main():
    process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
    start = at = time.monotonic()
    before, total, alone, stretches = {}, 0.0, 0.0, []
    while process.poll() is None:
        time.sleep(STEP)
        now, then, at = cpu_of_threads(process.pid), at, time.monotonic()
        used = sorted(seconds - before.get(thread, 0.0) for thread, seconds in now.items()) or [0.0]
        total += sum(used)
        if sum(used[:-1]) < ALONE * (at - then):
            alone += sum(used)
            stretches.append((then - start, at - start))
        before = now
    print(f"{total:.1f} s of CPU time, {at - start:.1f} s of wall; one thread alone: {100 * alone / total:.1f} %")
    joined = []
    for begin, end in stretches:
        if joined and begin - joined[-1][1] < STEP / 2:
            joined[-1][1] = end
        else:
            joined.append([begin, end])
    for begin, end in joined:
        if end - begin > 10 * STEP:
            print(f"  from {begin:.1f} to {end:.1f} s")
    return process.returncode


if __name__ == "__main__":
    sys.exit(main())
