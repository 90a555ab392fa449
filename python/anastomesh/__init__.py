"""Vascular networks and closed surfaces to valid tetrahedral meshes.

The program ``anastomesh``, which is part of this package, does the work. It exchanges arrays with Python as ``.npy`` files, which
are mapped into memory.
"""

from . import options
from ._binary import binary, installed_version
from ._errors import BugError, Error, InputError, InvalidError, StageError, StoppedError, UsageError
from ._file_verbs import Picture, check, convert, render, view
from ._mesh import Mesh, Patch
from ._network import Network
from ._network_verbs import dual, estimate, flow, generate, info, mesh, mesh_shard, prepare, refine, surface
from ._progress import Progress
from ._report import CheckReport, Condition, Place
from ._surface import Surface
from ._surface_verbs import check_surface, tetrahedralize
from ._tetgen import TetGen

__version__ = installed_version()

__all__ = [
    "BugError",
    "CheckReport",
    "Condition",
    "Error",
    "InputError",
    "InvalidError",
    "Mesh",
    "Network",
    "Patch",
    "Picture",
    "Place",
    "Progress",
    "StageError",
    "StoppedError",
    "Surface",
    "TetGen",
    "UsageError",
    "__version__",
    "binary",
    "check",
    "check_surface",
    "convert",
    "dual",
    "estimate",
    "flow",
    "generate",
    "info",
    "mesh",
    "mesh_shard",
    "options",
    "prepare",
    "refine",
    "render",
    "surface",
    "tetrahedralize",
    "view",
]
