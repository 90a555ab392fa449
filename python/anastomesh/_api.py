"""The verbs of the program."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar, Union

import numpy as np

from . import _arrays
from ._errors import Error
from ._mesh import Mesh
from ._network import Network, NetworkLike
from ._progress import ProgressLike
from ._report import CheckReport
from ._run import Done, arguments, run, work_folder

_Path = Union[str, "os.PathLike[str]"]


def tetrahedralize(
    points: Any,
    triangles: Any = None,
    *,
    markers: Any = None,
    segments: Any = None,
    holes: Any = None,
    regions: Any = None,
    progress: ProgressLike = None,
    **options: Any,
) -> Mesh:
    """Fills a closed surface with tetrahedra; every triangle stays as it is, a face of the mesh.

    ``points`` (n, 3) and ``triangles`` (m, 3), whose corners are rows of ``points``; or a ``pyvista.PolyData``, or the path of a
    file (.off, .ply, .stl, .obj, .poly, .smesh, .node) instead of both. Without triangles points become their Delaunay
    tetrahedralization. ``markers`` (m,) are handed on to ``Mesh.markers``. With ``plc=True`` facets may lie inside, ``segments``
    (k, 2) are kept, ``holes`` (h, 3) are points in parts that stay empty, ``regions`` a sequence of ``(point, id)`` or
    ``(point, id, max_volume)``.

    ``options`` are those of ``anastomesh tetrahedralize``: ``refine=False``, ``max_radius_edge=1.4``, ``min_dihedral=``,
    ``max_volume=``, ``size=``, ``plc=``, ``split=``, ``repair=``, ``strict=``, ``tetgen="pYq1.4"``, ``threads=``.

    Raises ``ValueError`` with the row that is wrong; :class:`InputError` (a ``ValueError``, too) where the surface is open, meets
    itself, or is otherwise at fault; :class:`InvalidError` where a bound is not met, with the mesh as ``result``.
    """
    words = arguments(_unrefined(options))
    with work_folder() as folder:
        if isinstance(points, (str, os.PathLike)):
            given = {"triangles": triangles, "markers": markers, "segments": segments, "holes": holes, "regions": regions}
            for name, value in given.items():
                if value is not None:
                    raise TypeError(f"{name} stand in the file: give them with arrays only")
            path = os.fspath(points)
        else:
            points, triangles = _surface(points, triangles)
            path = _write_surface(folder, points, triangles, markers, segments, holes, regions)
        out = os.path.join(folder, "mesh.npyd")
        done = run("tetrahedralize", [path, f"--output={out}", *words], progress, folder=folder)
        return _made(done, out)


def mesh(network: NetworkLike, *, roots: Sequence[Any] | None = None, progress: ProgressLike = None, **options: Any) -> Mesh:
    """Meshes a network of vessels: one valid tetrahedral mesh, its boundary labelled as wall, inlets and outlets.

    ``network`` is a :class:`Network`, a tuple ``(nodes, edges, radii)``, a dict of its arrays, a graph of networkx, or the path
    of a file. ``roots`` are the nodes that become inlets, as the network calls them (default: in each component the terminal of
    largest radius).

    ``options`` are those of ``anastomesh mesh``: ``rho=3``, ``refine=True`` or a number of iterations, ``data=["radius"]``,
    ``keep_going=``, ``memory="4GiB"``, ``work_dir=``, ``inflow=``, ``units="um:m"``, ``threads=`` and all others.

    Raises :class:`InvalidError` where the mesh is not valid, as where vessels overlap: it is the error's ``result`` then.
    """
    options = dict(options)
    if isinstance(options.get("data"), Sequence) and not isinstance(options["data"], str):
        options["data"] = ",".join(options["data"])
    with work_folder() as folder:
        path = _write_network(folder, network, options, roots)
        out = os.path.join(folder, "mesh.npyd")
        done = run("mesh", [path, f"--output={out}", *arguments(options)], progress, folder=folder)
        return _made(done, out)


def refine(network: NetworkLike, *, progress: ProgressLike = None, **options: Any) -> Network:
    """Moves the nodes of a network until its vessels do not overlap and can be cut; ``original_node`` and ``displacement``
    of what comes back say where each node was.

    ``options`` are those of ``anastomesh refine``: ``iterations=200``, ``residual="shrink"``, ``free_terminals=``, ``max_move=``
    and so on. Raises :class:`InvalidError` where vessels overlap in the end, with the network as ``result``.
    """
    with work_folder() as folder:
        given = None if isinstance(network, (str, os.PathLike)) else Network.of(network)
        path = _write_network(folder, network if given is None else given, {}, None)
        out = os.path.join(folder, "refined.npyd")
        done = run("refine", [path, f"--output={out}", *arguments(options)], progress, folder=folder)
        made = Network.load(out, done.report, given) if os.path.isdir(out) else None
        return _or_raise(done, made)


def check(mesh: Mesh | _Path, **options: Any) -> CheckReport:
    """Verifies a mesh, or the file of one, line by line; what is not valid is no error. ``options``: ``memory=``."""
    with work_folder() as folder:
        path = mesh._write(folder) if isinstance(mesh, Mesh) else os.fspath(mesh)
        done = run("check", [path, *arguments(options)], folder=folder, tells=False)
        if done.report is None or done.code not in (0, 1):
            raise done.error()
        return CheckReport(done.code == 0, done.report)


def _made(done: Done, out: str) -> Mesh:
    return _or_raise(done, Mesh._read(out, done.report) if os.path.isdir(out) else None)


_Made = TypeVar("_Made", Mesh, Network)


def _or_raise(done: Done, result: _Made | None) -> _Made:
    if done.code:
        raise done.error(result)
    if result is None:
        raise Error("the program has ended well and written nothing", report=done.report, messages=done.messages)
    return result


def _unrefined(options: Mapping[str, Any]) -> dict[str, Any]:
    """``refine=False`` is the program's ``--no-refine``."""
    rest = dict(options)
    wanted = rest.pop("refine", True)
    if wanted not in (True, False):
        raise TypeError(f"refine is {wanted!r}; give True or False")
    return rest if wanted else {**rest, "no_refine": True}


def _surface(points: Any, triangles: Any) -> tuple[Any, Any]:
    """Arrays, of a PolyData its own."""
    if triangles is None and hasattr(points, "points") and hasattr(points, "faces"):
        if not getattr(points, "is_all_triangles", True):
            raise ValueError("the PolyData has faces that are no triangles: call .triangulate() first")
        return points.points, np.asarray(points.faces).reshape(-1, 4)[:, 1:]
    return points, triangles


def _write_surface(folder: str, points: Any, triangles: Any, markers: Any, segments: Any, holes: Any, regions: Any) -> str:
    points = _arrays.floats("points", points, 3)
    named = ("points", len(points))
    triangles = None if triangles is None else _arrays.indices("triangles", triangles, 3, *named)
    count = 0 if triangles is None else len(triangles)
    path = os.path.join(folder, "surface.npyd")
    os.mkdir(path)
    _arrays.write(
        path,
        points=points,
        triangles=triangles,
        markers=None if markers is None else _arrays.labels("markers", markers, ("triangles", count)),
        segments=None if segments is None else _arrays.indices("segments", segments, 2, *named),
        holes=None if holes is None else _arrays.floats("holes", holes, 3),
        regions=None if regions is None else _regions(regions),
    )
    return path


def _regions(regions: Sequence[Any]) -> _arrays.Floats:
    """Rows of x, y, z, id and the bound on volumes, 0 where there is none."""
    rows = []
    for row, region in enumerate(regions):
        if len(region) not in (2, 3) or np.shape(region[0]) != (3,):
            raise ValueError(f"regions: row {row} is {region!r}, and (point, id) or (point, id, max_volume) is needed")
        point, number, *volume = region
        rows.append([*point, number, *(volume or [0.0])])
    return _arrays.floats("regions", np.array(rows, dtype=np.float64).reshape(-1, 5), 5)


def _write_network(folder: str, network: NetworkLike, options: dict[str, Any], roots: Sequence[Any] | None) -> str:
    """Where the network is; roots become options."""
    if isinstance(network, (str, os.PathLike)):
        if roots is not None:
            options["root"] = [str(root) for root in roots]
        return os.fspath(network)
    given = Network.of(network)
    if roots is not None:
        options["root"] = [str(given.node(root)) for root in roots]
    return given.write(folder)
