"""Where the program is."""

from __future__ import annotations

import os
import shutil
import sysconfig
from functools import cache

NAME = "anastomesh" + (sysconfig.get_config_var("EXE") or "")


@cache
def _installed() -> str:
    # The folder of scripts of the environment, of the user, and that of `pip install --target`.
    schemes = [sysconfig.get_path("scripts"), sysconfig.get_path("scripts", f"{os.name}_user")]
    beside = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    for folder in [*schemes, os.path.join(beside, "bin")]:
        path = os.path.join(folder, NAME)
        if os.access(path, os.X_OK):
            return path
    found = shutil.which(NAME)
    if found is None:
        raise FileNotFoundError(
            f"the program {NAME} is not where this package was installed ({schemes[0]}), nor on the PATH: install the "
            "package again, or let ANASTOMESH_BINARY name it"
        )
    return found


def binary() -> str:
    """The path of the program ``anastomesh``: that in ``ANASTOMESH_BINARY``, or the one that came with this package."""
    return os.environ.get("ANASTOMESH_BINARY") or _installed()
