"""Location and version of the program."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
from functools import cache
from importlib.metadata import PackageNotFoundError, version

NAME = "anastomesh" + (sysconfig.get_config_var("EXE") or "")


@cache
def _installed() -> str:
    # Script folders of the environment, of the user, and of `pip install --target`.
    schemes = [sysconfig.get_path("scripts"), sysconfig.get_path("scripts", f"{os.name}_user")]
    beside = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    for folder in [*schemes, os.path.join(beside, "bin")]:
        path = os.path.join(folder, NAME)
        if os.access(path, os.X_OK):
            return path
    found = shutil.which(NAME)
    if found is None:
        raise FileNotFoundError(
            f"the program {NAME} is neither in {schemes[0]} nor on the PATH: reinstall the package, "
            "or set ANASTOMESH_BINARY to its path"
        )
    return found


def binary() -> str:
    """Path of the program ``anastomesh``: the value of ``ANASTOMESH_BINARY``, or the program installed with this package."""
    return os.environ.get("ANASTOMESH_BINARY") or _installed()


def installed_version() -> str:
    """Version of the package; the program has the same one."""
    try:
        return version("anastomesh")
    except PackageNotFoundError:
        # A source tree on the path, without an installation.
        return subprocess.check_output([binary(), "--version"], text=True).split()[1]
