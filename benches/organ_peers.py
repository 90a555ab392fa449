#!/usr/bin/env python3
"""What else makes a surface or a mesh of a whole network, on the same machine: time and memory until it fails.

  organ_peers.py NETWORK.vtp... [--program PATH] [--limit SECONDS] [--memory 20GiB]

  ours      `mesh`, as it is
  global    `mesh --joint none --follow 0`: one convolution grid for all of the network, no vessel cut
  FEQ       PyGEL's face extrusion quad meshes (PyGEL3D of PyPI): a surface only, nothing inside, no caps

Needs pyvista and PyGEL3D. CPU is user and system time of the process; FEQ's without starting Python and reading.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))


def feq(path):
    """Runs in a process of its own; prints what it did as JSON."""
    import pyvista
    from pygel3d import graph, hmesh

    network = pyvista.read(path)
    g = graph.Graph()
    nodes = [g.add_node(p) for p in network.points]
    for a, b in network.lines.reshape(-1, 3)[:, 1:]:
        g.connect_nodes(nodes[a], nodes[b])
    start = time.process_time()
    surface = hmesh.graph_to_feq(g, list(map(float, network["Radius"])), True)
    seconds = time.process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps({"seconds": seconds, "peak": peak, "faces": surface.no_allocated_faces(),
                      "valid": bool(hmesh.valid(surface)), "closed": bool(hmesh.closed(surface))}))


def measured(command, limit):
    """Output, exit code (or why it was stopped), CPU seconds, peak bytes."""
    with tempfile.TemporaryFile() as out:
        child = subprocess.Popen(command, stdout=out, stderr=subprocess.DEVNULL)
        deadline, stopped = time.monotonic() + limit, None
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > deadline and stopped is None:
                stopped = "too long"
                child.kill()
            time.sleep(0.05)
        out.seek(0)
        return out.read(), stopped or os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def ours(options, network, *more):
    with tempfile.TemporaryDirectory() as folder:
        command = [options.program, "mesh", network, "-o", os.path.join(folder, "m.vtu"), "--json", "-q", "-j", "1",
                   "--memory", options.memory, *more]
        out, code, seconds, peak = measured(command, options.limit)
        if not out.startswith(b"{"):
            return f"exit {code} after {seconds:.1f} s, {peak / 2**20:.0f} MiB"
        report = json.loads(out)
        tets = report["run"]["mesh"]["tets"]
        verdict = (report["check"] or {}).get("verdict", "none")
        return f"{seconds:.1f} s, {peak / 2**20:.0f} MiB, {tets / 1e6:.2f} M tetrahedra, {verdict}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("networks", nargs="+")
    parser.add_argument("--program", default=os.path.join(HERE, "..", "target", "release", "anastomesh"))
    parser.add_argument("--limit", type=float, default=600)
    parser.add_argument("--memory", default="20GiB")
    parser.add_argument("--feq", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.feq:
        return feq(options.networks[0])
    print("| network | ours | global | FEQ |\n|---|---|---|---|", flush=True)
    for network in options.networks:
        out, code, _, _ = measured([sys.executable, __file__, "--feq", network], options.limit)
        cell = f"exit {code}"
        if out.strip().endswith(b"}"):
            made = json.loads(out.strip().splitlines()[-1])
            sound = "closed" if made["closed"] and made["valid"] else "not closed"
            cell = f"{made['seconds']:.1f} s, {made['peak'] / 2**20:.0f} MiB, {made['faces'] / 1e3:.0f} k quads, {sound}"
        print(f"| {os.path.basename(network)} | {ours(options, network)} | "
              f"{ours(options, network, '--joint', 'none', '--follow', '0')} | {cell} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
