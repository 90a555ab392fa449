"""Meshes of networks, and refined networks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import anastomesh
import networkx as nx
import numpy as np
import pytest
from anastomesh import Network


def arrays(graph: nx.Graph) -> tuple[Any, Any, Any]:
    number = {label: i for i, label in enumerate(graph)}
    nodes = np.array([graph.nodes[n]["pos"] for n in graph], float)
    return nodes, np.array([(number[a], number[b]) for a, b in graph.edges]), np.array([graph.nodes[n]["radius"] for n in graph])


def test_a_network_is_the_same_however_it_is_given(fork: nx.Graph, tmp_path: Path) -> None:
    nodes, edges, radii = arrays(fork)
    by_file = tmp_path / "fork.swc"
    by_file.write_text("1 2 0 0 0 1 -1\n2 2 0 0 10 1 1\n3 2 5 0 18 0.8 2\n4 2 -5 0 18 0.8 2\n")
    forms = [
        fork,
        (nodes, edges, radii),
        {"nodes": nodes, "edges": edges, "radii": radii},
        Network(nodes, edges, edge_radii=np.array([[1, 1], [1, 0.8], [1, 0.8]]), radii=radii),
        by_file,
        str(by_file),
    ]
    meshes = [anastomesh.mesh(form) for form in forms]
    for mesh in meshes:
        assert np.array_equal(mesh.points, meshes[0].points) and np.array_equal(mesh.tets, meshes[0].tets)
    mesh = meshes[0]
    assert mesh.markers is not None
    assert [patch.name for patch in mesh.patches] == ["wall", "inlet", "outlet_0", "outlet_1"]
    assert set(np.unique(mesh.markers)) == {1, 2, 3, 4}
    assert mesh.patches[1].center == (0, 0, 0) and mesh.patches[1].radius == 1
    assert len(mesh.patch("inlet")) == (mesh.markers == 2).sum()
    with pytest.raises(KeyError, match="outlet_1"):
        mesh.patch("outlet_2")
    report = anastomesh.check(mesh)
    assert report.valid and report.report["verdict"] == "valid" and report.failed == []


def test_roots_are_called_as_the_graph_calls_them(fork: nx.Graph) -> None:
    mesh = anastomesh.mesh(fork, roots=["left"])
    assert mesh.patches[1].name == "inlet" and mesh.patches[1].node == 2
    assert [row["name"] for row in mesh.terminals] == ["inlet", "outlet_0", "outlet_1"]
    flows = {row["name"]: row["flow"] for row in mesh.terminals}
    assert flows["inlet"] == pytest.approx(flows["outlet_0"] + flows["outlet_1"], rel=1e-6)
    with pytest.raises(ValueError, match="no node 'middle'"):
        anastomesh.mesh(fork, roots=["middle"])
    network = Network.of(fork)
    network.roots = np.array([3])
    assert anastomesh.mesh(network).patches[1].node == 3


def test_values_of_places(fork: nx.Graph) -> None:
    mesh = anastomesh.mesh(fork, data=["radius", "branch"])
    assert set(mesh.values) == {("point", "radius"), ("tet", "branch"), ("triangle", "branch")}
    assert len(mesh.values["point", "radius"]) == len(mesh.points)
    assert len(np.unique(mesh.values["tet", "branch"])) == 3


def test_embedded_vessels_are_divided_between_cells(fork: nx.Graph) -> None:
    mesh = anastomesh.mesh(fork, embed=True, embed_size="3r", tissue="box:6")
    assert mesh.patches[0].name == "organ" and not mesh.terminals
    pieces = mesh.embedding
    total = sum(np.linalg.norm(np.subtract(fork.nodes[a]["pos"], fork.nodes[b]["pos"])) for a, b in fork.edges)
    assert pieces["length"].sum() == pytest.approx(total, rel=1e-12)
    assert set(pieces["edge"]) == {0, 1, 2} and pieces["cell"].max() < len(mesh.tets)
    assert anastomesh.check(mesh)


def test_overlaps_are_an_error_with_the_mesh_and_refine_parts_them() -> None:
    network = Network([[0, 0, 0], [20, 0, 0], [10, -10, 0.5], [10, 10, 0.5]], [[0, 1], [2, 3]], [1.0, 1, 1, 1])
    with pytest.raises(anastomesh.InvalidError) as caught:
        anastomesh.mesh(network)
    assert len(caught.value.result.tets) > 0
    failed = {condition.name: condition for condition in caught.value.failed}
    crossing = failed["no_self_intersection"]
    assert crossing.count >= len(crossing.places) > 0 and crossing.places[0].kind == "face_pair"
    assert crossing.places[0].position is not None
    assert np.linalg.norm(np.subtract(crossing.places[0].position, (10, 0, 0.25))) < 2
    assert str(caught.value).startswith(f"no_self_intersection fails at {crossing.count} places, the first at (")
    assert "refine=" in str(caught.value)
    assert "--" not in str(caught.value)
    assert not anastomesh.check(caught.value.result).valid
    with pytest.raises(anastomesh.InvalidError, match="vessels_overlap fails at 1 place") as caught:
        anastomesh.refine(network, iterations=0)
    assert caught.value.failed[0].places[0].ids == (0, 1, 2, 3) and len(caught.value.result.nodes) == 4
    better = anastomesh.refine(network)
    assert better.displacement is not None and better.original_node is not None
    assert better.displacement.any() and len(better.original_node) == len(better.nodes)
    assert better.report["report"]
    assert anastomesh.check(anastomesh.mesh(better))
    assert anastomesh.check(anastomesh.mesh(network, refine=True))


def test_graphs_come_back_with_their_names(fork: nx.Graph) -> None:
    better = anastomesh.refine(fork)
    assert better.labels == ["root", "fork", "left", "right"]
    assert sorted(map(sorted, better.to_networkx().edges)) == sorted(map(sorted, fork.edges))


def test_radii_of_edges_do(fork: nx.Graph) -> None:
    for _, _, data in fork.edges(data=True):
        data["radius"] = 0.7
    for node in fork:
        del fork.nodes[node]["radius"]
    assert {patch.radius for patch in anastomesh.mesh(fork).patches} == {None, 0.7}


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda g: g.nodes["fork"].pop("radius"), "node 'fork' has no 'radius'"),
        (lambda g: g.nodes["left"].pop("pos"), "node 'left' has no position"),
        (lambda g: g.nodes["left"].update(pos=(1, 2)), "three coordinates"),
        (lambda g: g.nodes["left"].update(radius="thick"), "node 'left' has the radius 'thick'"),
        (lambda g: g.nodes["left"].update(pos=(1, 2, float("nan"))), "nodes: row 2"),
    ],
)
def test_graphs_at_fault_are_named(fork: nx.Graph, spoil: Callable[[nx.Graph], Any], message: str) -> None:
    spoil(fork)
    with pytest.raises(ValueError, match=message):
        anastomesh.mesh(fork)
