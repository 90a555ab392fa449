"""Options that many verbs have."""

import os
from typing import Annotated, TypedDict

from ._option import Option

StrPath = str | os.PathLike[str]


class ConfigOptions(TypedDict, total=False):
    """General"""

    config: Annotated[
        StrPath | None, Option("TOML file with options, by their long names on the command line; keyword arguments win")
    ]


class OrderOptions(TypedDict, total=False):
    """Elements"""

    order: Annotated[
        int,
        Option(
            "Order of the elements: 1, or 2 for ten-node tetrahedra whose midpoints lie on smooth walls and interfaces "
            "(VTU, MSH and .npyd, in memory)",
            1,
        ),
    ]


class ThreadOptions(TypedDict, total=False):
    """General"""

    threads: Annotated[int | None, Option("Number of threads; all cores if absent. The output does not depend on it")]


class MemoryOptions(TypedDict, total=False):
    """Memory"""

    memory: Annotated[
        str,
        Option(
            "Memory limit with its unit, as '500MB'. A VTU file that anastomesh has written is read block by block above it",
            "2GiB",
        ),
    ]


class PageOptions(TypedDict, total=False):
    """Report"""

    report: Annotated[StrPath | None, Option("HTML page to write: pictures, plots, tables and the validity check")]
