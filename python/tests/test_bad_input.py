"""Faulty input raises exceptions that name the argument and the row."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import anastomesh
import networkx as nx
import numpy as np
import pytest
from anastomesh import Network

POINTS = np.eye(4)[:, :3]
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def with_row(array: Any, row: int, values: Any) -> Any:
    array = np.array(array, dtype=np.result_type(array, np.asarray(values)))
    array[row] = values
    return array


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((POINTS[:, :2], TRIANGLES), r"points: the shape is \(4, 2\): give an array of shape \(n, 3\)"),
        ((POINTS.ravel(), TRIANGLES), r"points: the shape is \(12,\)"),
        ((POINTS, TRIANGLES[:, :2]), r"triangles: the shape is \(4, 2\)"),
        ((with_row(POINTS, 2, [0, np.nan, 0]), TRIANGLES), "points: row 2 is .*nan"),
        ((with_row(POINTS, 3, [0, np.inf, 0]), TRIANGLES), "points: row 3 is .*inf"),
        ((POINTS, with_row(TRIANGLES, 1, [0, 1, 4])), "triangles: row 1 refers to row 4 of points, which has 4 rows"),
        ((POINTS, with_row(TRIANGLES, 3, [0, -1, 2])), "triangles: row 3 refers to row -1"),
        ((POINTS, TRIANGLES.astype(float)), "triangles: the dtype is float64: give integers"),
        ((POINTS.astype(complex), TRIANGLES), "points: the dtype is complex128"),
        ((POINTS.astype(str), TRIANGLES), "points: the dtype is"),
        ((POINTS.astype(object), TRIANGLES), "points: the dtype is object"),
        ((POINTS, TRIANGLES > 1), "triangles: the dtype is bool"),
        ((POINTS[:0], TRIANGLES[:0]), "no points|at least four points|nothing"),
        ((POINTS, TRIANGLES[:3]), "the surface is open"),
        ((POINTS[:, [0, 1, 0]] * 0, TRIANGLES), "."),
    ],
)
def test_surfaces(arguments: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        anastomesh.tetrahedralize(*arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"markers": [1, 2, 3]}, "markers: there are 3 rows: give one for each of the 4 rows of triangles"),
        ({"markers": [1, 2, 3, 2**31]}, "markers: row 3 is 2147483648"),
        ({"segments": [[0, 9]]}, "segments: row 0 refers to row 9"),
        ({"holes": [[0, 0]]}, r"holes: the shape is \(1, 2\)"),
        ({"regions": [([0, 0], 1)]}, "regions: row 0"),
        ({"regions": [([0, 0, 0], 1.5)], "plc": True}, "row 0"),
    ],
)
def test_what_goes_with_surfaces(options: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        anastomesh.tetrahedralize(POINTS, TRIANGLES, **options)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[0, 0], [1, 1]], [[0, 1]], [1, 1]), r"nodes: the shape is \(2, 2\)"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 2]], [1, 1]), "edges: row 0 refers to row 2 of nodes, which has 2 rows"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]], [1]), "radii: there are 1 rows: give one for each of the 2 rows of nodes"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]], ["a", "b"]), "radii: the dtype is"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]]), "give radii or edge_radii"),
        (([[0, 0, 0], [0, 0, 9]], [[0, 1]], None, [[1, 2, 3]]), "edge_radii: the shape is"),
    ],
)
def test_networks(arguments: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        anastomesh.mesh(Network(*arguments))


def test_what_is_no_network_or_file() -> None:
    with pytest.raises(TypeError, match="a network is needed, not int"):
        anastomesh.mesh(3)  # type: ignore[arg-type]
    with pytest.raises(anastomesh.InputError, match="No such file") as caught:
        anastomesh.mesh("/nowhere/network.vtp")
    assert isinstance(caught.value, ValueError) and caught.value.exit_code == 3


def test_keyword_arguments(fork: nx.Graph) -> None:
    mesh: Any = anastomesh.mesh
    for unknown in ({"roh": 3}, {"output": "x.vtu"}, {"no_refine": True}):
        with pytest.raises(TypeError, match=rf"mesh\(\) got an unexpected keyword argument '{next(iter(unknown))}'"):
            mesh(fork, **unknown)
    with pytest.raises(TypeError, match="did you mean 'rho'"):
        mesh(fork, roh=3)
    with pytest.raises(TypeError, match="rho=<object .*: give float"):
        mesh(fork, rho=object())
    with pytest.raises(TypeError, match="rho=True: give float"):
        mesh(fork, rho=True)
    with pytest.raises(TypeError, match="keep_going=1: give True or False"):
        mesh(fork, keep_going=1)
    with pytest.raises(TypeError, match="progress='yes'"):
        mesh(fork, progress="yes")
    with pytest.raises(TypeError, match="give nodes, edges and radii"):
        mesh([[0, 0, 0], [0, 0, 9]], [[0, 1]])
    with pytest.raises(TypeError, match="roots='left': give a sequence"):
        mesh(fork, roots="left")


def test_messages_speak_of_keyword_arguments(fork: nx.Graph) -> None:
    mesh: Any = anastomesh.mesh
    with pytest.raises(anastomesh.UsageError, match="invalid value 'thick' for 'rho='") as caught:
        mesh(fork, rho="thick")
    assert isinstance(caught.value, ValueError) and "--" not in str(caught.value) and "Usage" not in str(caught.value)
    with pytest.raises(anastomesh.UsageError, match=r"invalid value 'cut' for 'touching='\s+\[possible values: join"):
        mesh(fork, touching="cut")
    with pytest.raises(anastomesh.UsageError, match="work_dir="):
        mesh(fork, make_missing=True)


def test_nothing_is_left_behind(fork: nx.Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    mesh = anastomesh.mesh(fork)
    with pytest.raises(ValueError):
        anastomesh.tetrahedralize(POINTS, TRIANGLES[:3])
    assert os.listdir(tmp_path) == []
    assert mesh.points[mesh.tets].shape == (len(mesh.tets), 4, 3)


def test_a_mesh_at_fault(fork: nx.Graph) -> None:
    mesh = anastomesh.mesh(fork)
    mesh.tets[5] = mesh.tets[5][[1, 0, 2, 3]]
    report = anastomesh.check(mesh)
    assert not report and report.failed[0].name == "positive_tets"
    mesh.tets[7, 2] = len(mesh.points)
    with pytest.raises(ValueError, match="tets: row 7 refers to row"):
        anastomesh.check(mesh)
