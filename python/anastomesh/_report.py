"""Results of the validity check."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Place:
    """A place at which a condition does not hold."""

    #: Kind of the offender: ``point``, ``tet``, ``face_pair``, ``edges``, ...
    kind: str
    #: Indices of the offender: of a face its three points.
    ids: tuple[int, ...] = ()
    #: Coordinates, where the program gives any.
    position: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Condition:
    """A condition of validity: ``count`` is the number of places at which it fails, ``places`` lists the first of them."""

    name: str
    count: int = 0
    places: tuple[Place, ...] = field(default=(), repr=False)

    def __str__(self) -> str:
        at = next((place.position for place in self.places if place.position), None)
        first = "" if at is None else ", the first at ({:.4g}, {:.4g}, {:.4g})".format(*at)
        return f"{self.name} fails at {self.count} {'place' if self.count == 1 else 'places'}{first}"


@dataclass(frozen=True, repr=False)
class CheckReport:
    """Result of the validity check of a mesh; true if the mesh is valid."""

    valid: bool
    #: The program's report as it is.
    report: dict[str, Any]

    @property
    def verdict(self) -> str:
        """``valid``, ``invalid``, or ``no_fault_found`` for a mesh without a labelled boundary."""
        return str(self.report["verdict"])

    @property
    def counts(self) -> dict[str, Any]:
        """Number of points, tetrahedra and so on, and the volume."""
        return dict(self.report["counts"])

    @property
    def conditions(self) -> list[Condition]:
        """All conditions, in the order of the check."""
        return [_condition(line) for line in self.report["lines"]]

    @property
    def failed(self) -> list[Condition]:
        """Conditions that do not hold."""
        return failed_lines(self.report)

    def __bool__(self) -> bool:
        return self.valid

    def __repr__(self) -> str:
        return f"CheckReport({'; '.join([self.verdict, *map(str, self.failed)])})"


def failed_conditions(report: dict[str, Any] | None) -> list[Condition]:
    """Conditions that fail by the report of any verb."""
    report = report or {}
    own = report.get("report", {})
    return [
        *failed_lines(report.get("check") or {}),
        # Other bounds hold only where the boundary allows it.
        *(Condition("max_volume", of["beyond"]) for of in own.get("bounds") or () if of["beyond"] and "volume" in of["bound"]),
        *_overlaps(own.get("residual") or {}),
    ]


def failed_lines(check: dict[str, Any]) -> list[Condition]:
    """Conditions that fail by the report of a check."""
    return [_condition(line) for line in check.get("lines", []) if line["outcome"] == "fail"]


def _condition(line: dict[str, Any]) -> Condition:
    places = (Place(at["kind"], tuple(at["ids"]), at["position"] and tuple(at["position"])) for at in line["offenders"])
    return Condition(line["line"], line["count"], tuple(places))


def _overlaps(residual: dict[str, Any]) -> list[Condition]:
    """Overlaps that a refinement has left; the ids are the nodes of both edges."""
    if not residual.get("left"):
        return []
    pairs = [pair for pair in residual["pairs"] if pair["treatment"] == "left"]
    return [
        Condition("vessels_overlap", residual["left"], tuple(Place("edges", tuple(sum(pair["edges"], []))) for pair in pairs))
    ]
