"""Vascular networks: nodes with radii, and edges."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays, _files
from ._arrays import Array, Column, Floats, Ints, Rows
from ._foreign import ForeignNetwork, GraphLike, has_lines, is_graph
from .options import ConvertOptions, StrPath

if TYPE_CHECKING:
    import networkx
    from typing_extensions import Unpack

_POSITIONS = ("pos", "position", "coords", "xyz")
_RADII = ("radius", "r", "radii")


class Network:
    """A network: node ``i`` is at ``nodes[i]``, edge ``j`` joins the two nodes ``edges[j]``.

    ``radii`` (n,) belong to nodes, ``edge_radii`` (m,) to edges, or (m, 2) to both ends of each edge; one of them is needed.
    ``roots`` are the nodes of inlets. All lengths have the same unit.
    """

    def __init__(
        self,
        nodes: Rows,
        edges: Rows,
        radii: Column | None = None,
        edge_radii: Column | Rows | None = None,
        roots: Column | None = None,
        *,
        labels: list[Any] | None = None,
        original_node: Ints | None = None,
        displacement: Floats | None = None,
        report: dict[str, Any] | None = None,
    ) -> None:
        if radii is None and edge_radii is None:
            raise ValueError("radii: neither nodes nor edges have radii: give radii or edge_radii")
        self.nodes = _arrays.floats("nodes", nodes, 3)
        of_nodes = ("nodes", len(self.nodes))
        self.edges = _arrays.indices("edges", edges, 2, *of_nodes)
        self.radii = _arrays.optional(_radii, "radii", radii, None, of_nodes)
        columns = 2 if np.ndim(edge_radii) == 2 else None  # type: ignore[arg-type]
        self.edge_radii = _arrays.optional(_radii, "edge_radii", edge_radii, columns, ("edges", len(self.edges)))
        self.roots = _arrays.optional(_arrays.indices, "roots", roots, None, *of_nodes)
        #: Names of the nodes in a graph, or None.
        self.labels = labels
        #: Node of the input that each node stems from (n,), in results of ``prepare``, ``refine`` and ``dual``.
        self.original_node = original_node
        #: Displacement of each node (n, 3), in results of ``refine``.
        self.displacement = displacement
        #: The program's report of the run; empty without one.
        self.report = report or {}

    def __repr__(self) -> str:
        return f"Network({len(self.nodes):,} nodes, {len(self.edges):,} edges)"

    @classmethod
    def of(cls, network: NetworkLike) -> Network:
        """The network itself, or one made from a tuple or mapping of its arrays or from a graph of networkx."""
        if isinstance(network, cls):
            return network
        if is_graph(network):
            return cls.from_networkx(network)
        if isinstance(network, Mapping):
            return cls(**network)
        if isinstance(network, tuple) and len(network) == 3:
            return cls(*network)
        raise TypeError(
            f"a network is needed, not {type(network).__name__}: nodes, edges and radii, a Network, a graph of networkx, "
            "a pyvista.PolyData with lines, or the path of a file"
        )

    @classmethod
    def from_networkx(cls, graph: GraphLike) -> Network:
        """A network from a graph whose nodes have a position (``pos``, ``position``, or ``x``, ``y`` and ``z``) and a ``radius``.

        Edges may have the radii instead. Nodes keep the order of the graph, and their names are ``labels``.
        """
        labels = list(graph.nodes)
        number = {label: i for i, label in enumerate(labels)}
        data = [graph.nodes[label] for label in labels]
        nodes = np.array([_position(label, of) for label, of in zip(labels, data, strict=False)], dtype=np.float64).reshape(-1, 3)
        listed = list(graph.edges(data=True))
        edges = np.array([(number[a], number[b]) for a, b, _ in listed], dtype=np.int64).reshape(-1, 2)
        radii = _attribute("node", list(zip(labels, data, strict=False)), _RADII)
        edge_radii = _attribute("edge", [((a, b), of) for a, b, of in listed], _RADII)
        return cls(nodes, edges, radii, edge_radii, labels=labels)

    def to_networkx(self) -> networkx.Graph:
        """A graph of networkx: nodes with ``pos`` and ``radius``, edges with ``radius``, with the names in ``labels``."""
        import networkx

        labels = self.labels if self.labels is not None else list(range(len(self.nodes)))
        graph = networkx.Graph()
        for i, label in enumerate(labels):
            radius = {} if self.radii is None else {"radius": float(self.radii[i])}
            graph.add_node(label, pos=tuple(map(float, self.nodes[i])), **radius)
        for j, (a, b) in enumerate(self.edges):
            radius = {} if self.edge_radii is None else {"radius": float(np.mean(self.edge_radii[j]))}
            graph.add_edge(labels[a], labels[b], **radius)
        return graph

    def node(self, label: Any) -> int:
        """Number of the node with a label."""
        if self.labels is None:
            return int(label)
        try:
            return self.labels.index(label)
        except ValueError:
            raise ValueError(f"there is no node {label!r} in the graph") from None

    def save(self, path: StrPath, **options: Unpack[ConvertOptions]) -> None:
        """Writes a .vtp or .npyd file, or .swc for a tree; the keyword arguments are those of ``convert``."""
        _files.save(self, path, options)

    @classmethod
    def load(cls, path: StrPath) -> Network:
        """Reads a network in any format that the program reads."""
        if _files.is_folder_of_arrays(path):
            return cls._read(os.fspath(path))
        return _files.load(path, "network.npyd", cls._read)

    def _write(self, folder: str) -> str:
        """Writes it for the program and returns the path."""
        path = os.path.join(folder, "network.npyd")
        os.mkdir(path)
        arrays: dict[str, Array | None] = {"nodes": self.nodes, "edges": self.edges, "radii": self.radii}
        _arrays.write(path, **arrays, edge_radii=self.edge_radii, roots=self.roots)
        return path

    @classmethod
    def _read(cls, folder: str, report: dict[str, Any] | None = None, given: Network | None = None) -> Network:
        """Reads what the program has written."""
        parts = ("nodes", "edges", "radii", "edge_radii", "roots", "original_node", "displacement")
        arrays = {name: _arrays.read(folder, name) for name in parts if os.path.exists(os.path.join(folder, f"{name}.npy"))}
        labels = None
        original = arrays.get("original_node")
        # A node that was split or added has no label of its own.
        if given is not None and given.labels is not None and original is not None and len(np.unique(original)) == len(original):
            labels = [given.labels[i] for i in original] if original.max(initial=0) < len(given.labels) else None
        return cls(**arrays, labels=labels, report=report)


#: Networks that functions accept, beside three arrays.
NetworkLike = Network | Mapping[str, Any] | tuple[Any, Any, Any] | ForeignNetwork | StrPath


def write_network(folder: str, network: NetworkLike) -> str:
    """Path of a network, which is written to ``folder`` if it is not a file."""
    if isinstance(network, (str, os.PathLike)):
        return os.fspath(network)
    if has_lines(network):
        path = os.path.join(folder, "network.vtp")
        network.save(path)
        return path
    return Network.of(network)._write(folder)


def _radii(name: str, values: Any, columns: int | None, rows: tuple[str, int]) -> Floats:
    # Unusable radii are allowed: the program fills them and says so.
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name}: the dtype is {array.dtype}: give real numbers")
    usable = np.where(np.isfinite(array), array, 0.0)
    _arrays.floats(name, usable, columns, rows)
    return array.astype(np.float64, copy=False)


def _position(label: Any, of: Mapping[str, Any]) -> Any:
    found = next((of[name] for name in _POSITIONS if name in of), None)
    if found is None and all(name in of for name in "xyz"):
        found = [of[name] for name in "xyz"]
    if found is None:
        raise ValueError(f"node {label!r} has no position: give it 'pos', or 'x', 'y' and 'z'")
    if np.shape(found) != (3,):
        raise ValueError(f"node {label!r} has the position {found!r}: give three coordinates")
    return found


def _attribute(kind: str, items: list[tuple[Any, Mapping[str, Any]]], names: tuple[str, ...]) -> Floats | None:
    """Values of an attribute that all items have under one of the names; None if no item has it."""
    for name in names:
        have = [name in of for _, of in items]
        if not any(have):
            continue
        if not all(have):
            raise ValueError(f"{kind} {items[have.index(False)][0]!r} has no '{name}': give it to all or to none")
        for label, of in items:
            if not isinstance(of[name], (int, float, np.number)):
                raise ValueError(f"{kind} {label!r} has the {name} {of[name]!r}: give a number")
        return np.array([of[name] for _, of in items], dtype=np.float64)
    return None
