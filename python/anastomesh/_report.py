"""What a check has found."""

from __future__ import annotations

from typing import Any, NamedTuple


class CheckReport(NamedTuple):
    """Whether a mesh is valid, line by line; ``report`` is all that the program says."""

    valid: bool
    report: dict[str, Any]

    @property
    def failed(self) -> list[dict[str, Any]]:
        """The lines that do not hold."""
        return [line for line in self.report.get("lines", []) if line["outcome"] == "fail"]

    def __bool__(self) -> bool:
        return self.valid
