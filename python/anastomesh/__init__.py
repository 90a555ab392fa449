"""Networks of vessels and closed surfaces to valid tetrahedral meshes.

The work is done by the program ``anastomesh``, which comes with this package; numpy arrays go to it and come back as
``.npy`` files that are mapped into memory.
"""

from ._api import check, mesh, refine, tetrahedralize
from ._binary import binary
from ._errors import BugError, Error, InputError, InvalidError, StageError, StoppedError, UsageError
from ._mesh import Mesh, Patch
from ._network import Network
from ._progress import Progress
from ._report import CheckReport
from ._tetgen import TetGen

__all__ = [
    "BugError",
    "CheckReport",
    "Error",
    "InputError",
    "InvalidError",
    "Mesh",
    "Network",
    "Patch",
    "Progress",
    "StageError",
    "StoppedError",
    "TetGen",
    "UsageError",
    "binary",
    "check",
    "mesh",
    "refine",
    "tetrahedralize",
]
