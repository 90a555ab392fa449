"""Networks of vessels: nodes with radii, and edges."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np

from . import _arrays
from ._arrays import Array, Floats, Ints

_POSITIONS = ("pos", "position", "coords", "xyz")
_RADII = ("radius", "r", "radii")


@dataclass(eq=False)
class Network:
    """A network: node ``i`` lies at ``nodes[i]``, edge ``j`` joins the two nodes ``edges[j]``.

    ``radii`` (n,) are those of the nodes, ``edge_radii`` (m,) those of the edges, or (m, 2) at both of their ends; one of them
    is needed. ``roots`` name the nodes at which its trees begin. Lengths are in any one unit. A network that ``refine`` has made
    also has ``original_node`` (n,), ``displacement`` (n, 3) and ``report``.
    """

    nodes: Floats
    edges: Ints
    radii: Floats | None = None
    edge_radii: Floats | None = None
    roots: Ints | None = None
    #: What the nodes are called, where they come from a graph.
    labels: list[Any] | None = field(default=None, repr=False)
    original_node: Ints | None = field(default=None, repr=False)
    displacement: Floats | None = field(default=None, repr=False)
    report: dict[str, Any] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        self.nodes = _arrays.floats("nodes", self.nodes, 3)
        self.edges = _arrays.indices("edges", self.edges, 2, "nodes", len(self.nodes))
        if self.radii is None and self.edge_radii is None:
            raise ValueError("radii: neither nodes nor edges have any; give radii or edge_radii")
        if self.radii is not None:
            self.radii = _radii("radii", self.radii, None, ("nodes", len(self.nodes)))
        if self.edge_radii is not None:
            columns = 2 if np.ndim(self.edge_radii) == 2 else None
            self.edge_radii = _radii("edge_radii", self.edge_radii, columns, ("edges", len(self.edges)))
        if self.roots is not None:
            self.roots = _arrays.indices("roots", self.roots, None, "nodes", len(self.nodes))

    @classmethod
    def of(cls, network: NetworkLike) -> Network:
        """A network from what is one: itself, a mapping or tuple of its arrays, or a graph of networkx."""
        if isinstance(network, cls):
            return network
        if hasattr(network, "nodes") and hasattr(network, "edges") and hasattr(network, "adj"):
            return cls.from_networkx(network)
        if isinstance(network, Mapping):
            return cls(**network)
        if isinstance(network, tuple) and len(network) == 3:
            nodes, edges, radii = network
            return cls(nodes, edges, radii)
        raise TypeError(
            f"a network is needed, not {type(network).__name__}: a Network, a tuple (nodes, edges, radii), a dict of these, a "
            "graph of networkx, or the path of a file"
        )

    @classmethod
    def from_networkx(cls, graph: Any) -> Network:
        """A graph whose nodes have a position (``pos``, ``position``, or ``x``, ``y`` and ``z``) and a ``radius``; radii may be
        those of the edges instead. Nodes are numbered in the order of the graph; their names are ``labels``."""
        labels = list(graph.nodes)
        number = {label: i for i, label in enumerate(labels)}
        data = [graph.nodes[label] for label in labels]
        nodes = np.array([_position(label, of) for label, of in zip(labels, data, strict=False)], dtype=np.float64).reshape(-1, 3)
        listed = list(graph.edges(data=True))
        edges = np.array([(number[a], number[b]) for a, b, _ in listed], dtype=np.int64).reshape(-1, 2)
        radii = _attribute("node", list(zip(labels, data, strict=False)), _RADII)
        edge_radii = _attribute("edge", [((a, b), of) for a, b, of in listed], _RADII)
        return cls(nodes, edges, radii, edge_radii, labels=labels)

    def to_networkx(self) -> Any:
        """A graph of networkx: nodes with ``pos`` and ``radius``, edges with ``radius``, under the names that they came with."""
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
        """The number of a node that is called so."""
        if self.labels is None:
            return int(label)
        try:
            return self.labels.index(label)
        except ValueError:
            raise ValueError(f"there is no node {label!r} in the graph") from None

    def write(self, folder: str) -> str:
        """Writes it for the program; returns the path."""
        path = os.path.join(folder, "network.npyd")
        os.mkdir(path)
        arrays: dict[str, Array | None] = {"nodes": self.nodes, "edges": self.edges, "radii": self.radii}
        _arrays.write(path, **arrays, edge_radii=self.edge_radii, roots=self.roots)
        return path

    @classmethod
    def load(cls, folder: str, report: dict[str, Any] | None, given: Network | None) -> Network:
        """Reads what the program has written."""
        parts = ("nodes", "edges", "radii", "edge_radii", "original_node", "displacement")
        arrays = {name: _arrays.read(folder, name) for name in parts}
        labels = None
        original = arrays["original_node"]
        # Where a node was split, or put in, names would not tell the new ones apart.
        if given is not None and given.labels is not None and len(np.unique(original)) == len(original):
            labels = [given.labels[i] for i in original] if original.max(initial=0) < len(given.labels) else None
        return cls(**arrays, labels=labels, report=report)


#: What can be given as a network: arrays, a graph of networkx, or the path of a file.
NetworkLike = Union[Network, Mapping[str, Any], tuple[Any, Any, Any], "os.PathLike[str]", str, Any]


def _radii(name: str, values: Any, columns: int | None, rows: tuple[str, int]) -> Floats:
    # Radii that cannot be used are filled by the program, which says so.
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name}: has the dtype {array.dtype}, and real numbers are needed")
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
        raise ValueError(f"node {label!r} has the position {found!r}, and three coordinates are needed")
    return found


def _attribute(kind: str, items: list[tuple[Any, Mapping[str, Any]]], names: tuple[str, ...]) -> Floats | None:
    """What all items have under one of the names; None where none of them has it."""
    for name in names:
        have = [name in of for _, of in items]
        if not any(have):
            continue
        if not all(have):
            raise ValueError(f"{kind} {items[have.index(False)][0]!r} has no '{name}', which others have")
        for label, of in items:
            if not isinstance(of[name], (int, float, np.number)):
                raise ValueError(f"{kind} {label!r} has the {name} {of[name]!r}, and a number is needed")
        return np.array([of[name] for _, of in items], dtype=np.float64)
    return None
