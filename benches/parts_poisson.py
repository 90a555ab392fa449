#!/usr/bin/env python3
"""A Poisson problem in FEniCSx on several processes: each reads its part of a mesh, compared with one file.

    /usr/bin/python3 benches/parts_poisson.py FOLDER NETWORK [--program PATH] [--parts 4] [--bar 1e-9] [--options=--refine]

The network is meshed as one VTU, and as PVTU with `--parts N`. dolfinx solves -div grad u = 1 with u = 0 on the wall, with linear
elements, conjugate gradients and the Jacobi preconditioner. Three runs: one process with the VTU, N processes of which the first reads
the VTU and dolfinx divides it, and N processes that read one piece each and keep its tetrahedra. Integrals, maximum and the values of
all points are compared with the first run. Exit code 1 if they differ by more than the bar, relative to the largest value.
Needs Debian's python3-dolfinx-real (0.5), python3-meshio and openmpi-bin."""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

WALL = 1  # patch number of the vessel wall


class Blocks:
    """Points of all processes: process r holds the r-th of equal ranges of global ids."""

    def __init__(self, comm, count):
        self.comm, self.starts = comm, np.arange(comm.size + 1) * count // comm.size
        self.size = int(np.diff(self.starts)[comm.rank])

    def ranks(self, ids):
        return np.searchsorted(self.starts, ids, "right") - 1

    def send(self, ids, values):
        """Sends values to the holders of their ids; returns local numbers and values that came here."""
        ranks = self.ranks(ids)
        chosen = [ranks == rank for rank in range(self.comm.size)]
        found = self.comm.alltoall([(ids[here], values[here]) for here in chosen])
        return np.concatenate([f[0] for f in found]) - self.starts[self.comm.rank], np.concatenate([f[1] for f in found])

    def ask(self, ids, held):
        """Values of any ids, from an array with the values held by each process."""
        ranks = self.ranks(ids)
        chosen = [ranks == rank for rank in range(self.comm.size)]
        asked = self.comm.alltoall([ids[here] for here in chosen])
        answers = self.comm.alltoall([held[wanted - self.starts[self.comm.rank]] for wanted in asked])
        values = np.empty(len(ids), held.dtype)
        for here, answer in zip(chosen, answers):
            values[here] = answer
        return values


def read(path, comm):
    """Reads a VTU, or one piece of it, with meshio: points of this process with their ids, its tetrahedra, and points on the wall."""
    import meshio

    data = meshio.read(path)
    tets, triangles = data.cells_dict["tetra"], data.cells_dict["triangle"]
    wall = np.unique(triangles[data.cell_data_dict["patch"]["triangle"] == WALL])
    if "GlobalPointIds" not in data.point_data:
        return np.arange(len(data.points)), data.points, tets.astype(np.int64), wall
    ids = data.point_data["GlobalPointIds"].astype(np.int64)
    tets = tets[data.cell_data_dict["vtkGhostType"]["tetra"] == 0]
    own = data.point_data["vtkGhostType"] == 0
    return ids[own], data.points[own], ids[tets], ids[wall]


def stay(comm, processes, graph, ghosting):
    """Partitioner of dolfinx that leaves each cell on its process. Neighbours of other processes get a copy of it.

    dolfinx 0.5 finds the points that processes share through these copies, whatever the ghost mode."""
    from dolfinx import cpp

    starts = np.cumsum([0, *comm.allgather(graph.num_nodes)])
    cells = np.repeat(np.arange(graph.num_nodes), np.diff(graph.offsets))
    ranks = np.searchsorted(starts, graph.array, "right") - 1
    outside = ranks != comm.rank
    copies = np.unique(np.stack([cells[outside], ranks[outside]], 1), axis=0)
    # The owner comes first among the processes of a cell.
    at = np.searchsorted(copies[:, 0], np.arange(graph.num_nodes))
    targets = np.insert(copies[:, 1], at, comm.rank).astype(np.int32)
    offsets = np.append(at, len(copies)) + np.arange(graph.num_nodes + 1)
    return cpp.graph.AdjacencyList_int32(targets, offsets.astype(np.int32))


def solve(source, target):
    """One process of a run. `source` is a VTU for the first process, or has `%04d` for the piece of each."""
    import ufl
    from dolfinx import fem, mesh
    from mpi4py import MPI
    from petsc4py import PETSc

    comm, clock, times = MPI.COMM_WORLD, [time.perf_counter(), time.process_time()], {}

    def lap(name):
        now = [time.perf_counter(), time.process_time()]
        times[name] = [now[0] - clock[0], now[1] - clock[1]]
        clock[:] = now

    in_parts = "%" in source
    if in_parts:
        ids, points, cells, wall = read(source % comm.rank, comm)
    elif comm.rank == 0:
        ids, points, cells, wall = read(source, comm)
    else:
        ids, points, cells, wall = np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 4), np.int64), np.empty(0, np.int64)
    lap("read")

    # dolfinx takes points in the order of their ids, from each process a range of them.
    total = comm.allreduce(len(ids))
    blocks = Blocks(comm, total)
    numbers, values = blocks.send(ids, points)
    if len(numbers) != blocks.size or len(np.unique(numbers)) != blocks.size:
        raise RuntimeError("a point has no owner, or several")
    x = np.empty((blocks.size, 3))
    x[numbers] = values
    # A part can contain a point of the wall without a triangle of the wall, so that all parts exchange ids.
    held = np.zeros(blocks.size, bool)
    held[blocks.send(wall, wall)[0]] = True
    del numbers, values, points
    lap("exchange")

    partitioner = mesh.create_cell_partitioner(stay) if in_parts else mesh.create_cell_partitioner()
    element = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1))
    domain = mesh.create_mesh(comm, cells, x, element, mesh.GhostMode.none, partitioner)
    del cells, x
    lap("create_mesh")

    space = fem.FunctionSpace(domain, ("Lagrange", 1))
    owned = space.dofmap.index_map.size_local
    # Global id of each unknown, through the corners of the tetrahedra.
    index = np.empty(owned + space.dofmap.index_map.num_ghosts, np.int64)
    index[space.dofmap.list.array] = np.asarray(domain.geometry.input_global_indices)[domain.geometry.dofmap.array]
    fixed = np.flatnonzero(blocks.ask(index, held)).astype(np.int32)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    one = fem.Constant(domain, PETSc.ScalarType(1))
    ends = [fem.dirichletbc(PETSc.ScalarType(0), fixed, space)]
    matrix = fem.petsc.assemble_matrix(fem.form(ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx), ends)
    matrix.assemble()
    right = fem.petsc.assemble_vector(fem.form(one * v * ufl.dx))
    right.ghostUpdate(PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)
    fem.petsc.set_bc(right, ends)
    lap("assembly")

    found = fem.Function(space)
    solver = PETSc.KSP().create(comm)
    solver.setOperators(matrix)
    solver.setType("cg")
    solver.getPC().setType("jacobi")
    solver.setTolerances(rtol=1e-13, max_it=100_000)
    solver.solve(right, found.vector)
    found.x.scatter_forward()
    lap("solve")

    integral = lambda form: comm.allreduce(fem.assemble_scalar(fem.form(form * ufl.dx)))
    values = found.x.array[:owned]
    on_wall = comm.allreduce(int((fixed < owned).sum()))
    np.savez(f"{target}_{comm.rank}.npz", ids=index[:owned], values=values)
    here = dict(tets=domain.topology.index_map(3).size_local, points=owned, shared=space.dofmap.index_map.num_ghosts,
                mb=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, times=times)
    report = dict(tets=domain.topology.index_map(3).size_global, points=total, on_wall=on_wall, volume=integral(one), integral=integral(found),
                  energy=integral(ufl.inner(ufl.grad(found), ufl.grad(found))), norm=integral(found**2) ** 0.5,
                  max=comm.allreduce(values.max(), MPI.MAX), iterations=solver.getIterationNumber(), reason=solver.getConvergedReason())
    ranks = comm.gather(here)
    if comm.rank == 0:
        Path(f"{target}.json").write_text(json.dumps(report | dict(ranks=ranks)))


def run(processes, source, target):
    """Runs `solve` on several processes; returns its report and the value at each point."""
    command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", str(processes),
               sys.executable, __file__, "--solve", str(source), str(target)]
    subprocess.run(command, check=True, env=os.environ | dict(OMP_NUM_THREADS="1"))
    report = json.loads(Path(f"{target}.json").read_text())
    values = np.full(report["points"], np.nan)
    for rank in range(processes):
        data = np.load(f"{target}_{rank}.npz")
        if not np.isnan(values[data["ids"]]).all():
            raise RuntimeError("two processes own a point")
        values[data["ids"]] = data["values"]
    return report, values


def row(name, report):
    ranks = report["ranks"]
    steps = [f"{max(rank['times'][step][0] for rank in ranks):.1f}" for step in ("read", "exchange", "create_mesh", "assembly", "solve")]
    cpu = sum(seconds for rank in ranks for _, seconds in rank["times"].values())
    memory = " ".join(f"{rank['mb']:,.0f}" for rank in ranks)
    return f"| {name} | {' | '.join(steps)} | {cpu:.0f} | {memory} | {sum(rank['mb'] for rank in ranks):,.0f} |"


def main():
    if sys.argv[1:2] == ["--solve"]:
        return solve(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("network", type=Path)
    parser.add_argument("--program", default="anastomesh")
    parser.add_argument("--parts", type=int, default=4)
    parser.add_argument("--bar", type=float, default=1e-9)
    parser.add_argument("--options", default="", help="options of mesh, as one argument")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    one, parts = args.folder / "one.vtu", args.folder / "parts.pvtu"
    for target, options in ((one, []), (parts, ["--parts", str(args.parts)])):
        subprocess.run([args.program, "mesh", args.network, "-o", target, "-q", *options, *args.options.split()], check=True)
    pieces = args.folder / "parts" / "parts_%04d.vtu"
    runs = {"one file, 1 process": (1, one), f"one file, {args.parts} processes": (args.parts, one),
            f"{args.parts} parts, {args.parts} processes": (args.parts, pieces)}
    print("| run | read, s | exchange | create_mesh | assembly | solve | CPU, all | memory of each process, MB | sum |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    found = {}
    for number, (name, (processes, source)) in enumerate(runs.items()):
        found[name] = run(processes, source, args.folder / f"run_{number}")
        print(row(name, found[name][0]), flush=True)
    print("\n| run | tetrahedra | points shared | volume | integral of u | energy | L2 norm | max | iterations | max difference / max u |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    (first, expected), good = next(iter(found.values())), True
    for name, (report, values) in found.items():
        difference = abs(values - expected).max() / first["max"]
        same = [abs(report[key] / first[key] - 1) for key in ("volume", "integral", "energy", "norm", "max")]
        counts = all(report[key] == first[key] for key in ("tets", "points", "on_wall"))
        # A comparison with NaN, of a point without a value, is false.
        good &= counts and difference < args.bar and max(same) < args.bar and report["reason"] > 0
        numbers = " | ".join(f"{report[key]:.14g}" for key in ("volume", "integral", "energy", "norm", "max"))
        print(f"| {name} | {report['tets']:,} | {sum(rank['shared'] for rank in report['ranks']):,} | {numbers} | {report['iterations']} | "
              f"{difference:.1e} |")
    print(f"\n{first['points']:,} points, {first['on_wall']:,} on the wall; tetrahedra of each part:",
          *(f"{rank['tets']:,}" for rank in report["ranks"]))
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
