"""Functions that take or return a network."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

from . import _arrays
from ._arrays import Column, Rows
from ._foreign import has_lines
from ._mesh import Mesh
from ._network import Network, NetworkLike, write_network
from ._progress import ProgressLike
from ._run import Done, work_folder
from ._surface import Surface
from ._verb import Verb
from .options import (
    GenerateOptions,
    MeshOptions,
    NetworkFlowOptions,
    NetworkOptions,
    PrepareOptions,
    RefineOptions,
    StrPath,
    SurfaceOptions,
)

if TYPE_CHECKING:
    from typing_extensions import Unpack

_MESH = Verb("mesh", MeshOptions)
_ESTIMATE = Verb("mesh", MeshOptions, mode="--dry-run")
_SHARD = Verb("mesh", MeshOptions)
_SURFACE = Verb("surface", SurfaceOptions)
_FLOW = Verb("flow", NetworkFlowOptions)
_PREPARE = Verb("prepare", PrepareOptions)
_REFINE = Verb("refine", RefineOptions)
_DUAL = Verb("dual", NetworkOptions, progress=False)
_GENERATE = Verb("generate", GenerateOptions)
_INFO = Verb("info", NetworkOptions, progress=False)


@_MESH.documents
def mesh(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    *,
    progress: ProgressLike = None,
    **options: Unpack[MeshOptions],
) -> Mesh:
    """Meshes a vascular network: tetrahedra with a boundary labelled as wall, inlets and outlets.

    The network is given as three arrays, ``nodes`` (n, 3), ``edges`` (m, 2) and ``radii`` (n,); or as one object: a
    ``Network``, a tuple or dict of its arrays, a graph of networkx, a ``pyvista.PolyData`` with lines, or the path of a file.
    Lengths are in the unit of the network. ``progress`` is True for progress bars, or a function that gets each ``Progress``.

    Raises :class:`InvalidError` if the mesh is not valid, for example because vessels overlap. The mesh is in ``result`` and the
    failed conditions are in ``failed`` of the exception.
    """
    with work_folder() as folder:
        given = _given(network, edges, radii)
        out = os.path.join(folder, "mesh.npyd")
        done = _run_with_roots(_MESH, given, options, [f"--output={out}"], progress, folder)
        return done.made(Mesh._read(out, done.report) if os.path.isdir(out) else None)


@_ESTIMATE.documents
def estimate(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    *,
    progress: ProgressLike = None,
    **options: Unpack[MeshOptions],
) -> dict[str, Any]:
    """Estimates the size of a mesh without making it: blocks, tetrahedra, bytes of memory and of files.

    Arguments are those of :func:`mesh`.
    """
    with work_folder() as folder:
        out = os.path.join(folder, "mesh.npyd")
        done = _run_with_roots(_ESTIMATE, _given(network, edges, radii), options, [f"--output={out}"], progress, folder)
        return done.ensure_success().report or {}


@_SHARD.documents
def mesh_shard(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    *,
    shard: tuple[int, int],
    progress: ProgressLike = None,
    **options: Unpack[MeshOptions],
) -> None:
    """Makes one share of the blocks of a mesh in ``work_dir``; ``shard=(2, 8)`` is the second of eight.

    Shards run at the same time on any number of machines. :func:`mesh` with the same arguments then joins their blocks.
    """
    with work_folder() as folder:
        out = os.path.join(folder, "mesh.npyd")
        words = [f"--output={out}", f"--shard={shard[0]}/{shard[1]}"]
        _run_with_roots(_SHARD, _given(network, edges, radii), options, words, progress, folder).ensure_success()


@_SURFACE.documents
def surface(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    *,
    progress: ProgressLike = None,
    **options: Unpack[SurfaceOptions],
) -> Surface:
    """Makes the wall of a vascular network, with flat caps at inlets and outlets, for pictures and 3D printing.

    The network is given as in :func:`mesh`. Raises :class:`InvalidError` if the surface is not valid, with the surface in
    ``result``.
    """
    with work_folder() as folder:
        path = write_network(folder, _given(network, edges, radii))
        out = os.path.join(folder, "wall.ply")
        done = _SURFACE.run([path, f"--output={out}"], options, progress, folder=folder)
        return done.made(Surface._read(out, done.report) if os.path.isfile(out) else None)


@_FLOW.documents
def flow(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    *,
    output: StrPath | None = None,
    progress: ProgressLike = None,
    **options: Unpack[NetworkFlowOptions],
) -> dict[str, Any]:
    """Solves for the one-dimensional flow through a network: Poiseuille flow in cones, with conserved flow at nodes.

    The network is given as in :func:`mesh`. With ``result``, the three-dimensional result of a solver is mapped onto the vessels
    and compared with the one-dimensional solution. The result holds a summary, and the table of vessels in ``table``: a numpy
    array for each column. ``output`` also writes a file: .json (model for svZeroDSolver), .in (svOneDSolver), .vtp or .csv.
    """
    given = _given(network, edges, radii)
    with work_folder() as folder:
        table = os.path.join(folder, "flow.csv")
        done = _run_with_roots(_FLOW, given, options, [f"--output={table}"], progress, folder)
        report = dict(done.ensure_success().report or {})
        report["table"] = _arrays.columns(table)
    if output is not None:
        with work_folder() as folder:
            words = [f"--output={os.fspath(output)}"]
            _run_with_roots(_FLOW, given, options, words, None, folder).ensure_success()
    return report


@_PREPARE.documents
def prepare(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    *,
    progress: ProgressLike = None,
    **options: Unpack[PrepareOptions],
) -> Network:
    """Repairs a measured network: duplicate lines are merged, spurs removed, radii filled, polylines resampled.

    The network is given as in :func:`mesh`. ``original_node`` of the result tells the node that each of its nodes stems from.
    """
    return _to_network(_PREPARE, _given(network, edges, radii), options, progress)


@_REFINE.documents
def refine(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    *,
    progress: ProgressLike = None,
    **options: Unpack[RefineOptions],
) -> Network:
    """Moves the nodes of a network until its vessels do not overlap and can be cut into blocks.

    The network is given as in :func:`mesh`. ``original_node`` and ``displacement`` of the result tell what was moved. Raises
    :class:`InvalidError` if vessels still overlap, with the network in ``result``.
    """
    return _to_network(_REFINE, _given(network, edges, radii), options, progress)


@_DUAL.documents
def dual(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    **options: Unpack[NetworkOptions],
) -> Network:
    """Adds a second tree that shares the terminals of the first one, as veins do with arteries.

    The network is given as in :func:`mesh`. The two trees overlap in general; :func:`refine` moves them apart.
    """
    return _to_network(_DUAL, _given(network, edges, radii), options, None)


@_GENERATE.documents
def generate(terminals: int, *, progress: ProgressLike = None, **options: Unpack[GenerateOptions]) -> Network:
    """Generates a vascular network with a number of terminals that fills an organ; lengths are in µm."""
    with work_folder() as folder:
        out = os.path.join(folder, "network.npyd")
        done = _GENERATE.run([f"--terminals={terminals}", f"--output={out}"], options, progress, folder=folder)
        return done.made(Network._read(out, done.report) if os.path.isdir(out) else None)


@_INFO.documents
def info(
    network: NetworkLike | Rows,
    edges: Rows | None = None,
    radii: Column | None = None,
    **options: Unpack[NetworkOptions],
) -> dict[str, Any]:
    """Describes a network: numbers of nodes, edges and terminals, statistics of radii and lengths, inlets, and notes.

    The network is given as in :func:`mesh`.
    """
    with work_folder() as folder:
        done = _INFO.run([write_network(folder, _given(network, edges, radii))], options, folder=folder)
        return done.ensure_success().report or {}


def _given(network: NetworkLike | Rows, edges: Rows | None, radii: Column | None) -> NetworkLike:
    """The one object, or the network of three arrays."""
    if edges is None and radii is None:
        return cast(NetworkLike, network)
    if edges is None or radii is None:
        raise TypeError("give nodes, edges and radii, or one object that holds the network")
    return network, edges, radii


def _run_with_roots(
    verb: Verb, network: NetworkLike, options: Mapping[str, object], words: list[str], progress: ProgressLike, folder: str
) -> Done:
    """Runs a verb with roots as the program calls them."""
    network = _with_labels(network)
    options = dict(options)
    roots: Any = options.get("roots")
    if roots is not None:
        if isinstance(roots, str) or not hasattr(roots, "__iter__"):
            raise TypeError(f"roots={roots!r}: give a sequence of nodes")
        options["roots"] = [str(network.node(root) if isinstance(network, Network) else root) for root in roots]
    return verb.run([write_network(folder, network), *words], options, progress, folder=folder)


def _to_network(verb: Verb, network: NetworkLike, options: Mapping[str, object], progress: ProgressLike) -> Network:
    """Runs a verb that makes a network from a network; labels of a graph are kept."""
    with work_folder() as folder:
        network = _with_labels(network)
        given = network if isinstance(network, Network) else None
        out = os.path.join(folder, "result.npyd")
        path = write_network(folder, network)
        done = verb.run([path, f"--output={out}"], options, progress, folder=folder)
        return done.made(Network._read(out, done.report, given) if os.path.isdir(out) else None)


def _with_labels(network: NetworkLike) -> NetworkLike:
    """The path of a file or lines of pyvista as they are; anything else as a :class:`Network`, which knows its labels."""
    return network if isinstance(network, (str, os.PathLike)) or has_lines(network) else Network.of(network)
