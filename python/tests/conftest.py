"""Fixtures shared by the tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import numpy.typing as npt
import pytest

Cube = tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]

FIXTURES = Path(__file__).parents[2] / "fixtures"


@pytest.fixture
def fixtures() -> Path:
    return FIXTURES


@pytest.fixture
def cube() -> Cube:
    """The unit cube: 8 points, 12 triangles."""
    points = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return points, np.array([t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))])


@pytest.fixture
def fork() -> nx.Graph:
    """A bifurcation."""
    graph = nx.Graph()
    graph.add_node("root", pos=(0, 0, 0), radius=1.0)
    graph.add_node("fork", pos=(0, 0, 10), radius=1.0)
    graph.add_node("left", pos=(5, 0, 18), radius=0.8)
    graph.add_node("right", pos=(-5, 0, 18), radius=0.8)
    graph.add_edges_from([("root", "fork"), ("fork", "left"), ("fork", "right")])
    return graph


def volumes(points: npt.NDArray[np.float64], tets: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Signed volumes of tetrahedra."""
    a, b, c, d = (points[tets[:, i]] for i in range(4))
    signed: npt.NDArray[np.float64] = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    return signed
