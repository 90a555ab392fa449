"""Files written and read through the verb ``convert``."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping
from typing import Protocol, TypeVar

from ._run import work_folder
from ._verb import Verb
from .options import ConvertOptions, StrPath

CONVERT = Verb("convert", ConvertOptions)

_Read = TypeVar("_Read")


class Writable(Protocol):
    """A mesh, surface or network, which can be written for the program."""

    def _write(self, folder: str) -> str: ...


def convert_file(source: str, target: StrPath, options: Mapping[str, object], folder: str, stacklevel: int = 4) -> None:
    """Converts a file; messages do not name ``folder``. Warnings name the caller at ``stacklevel``."""
    done = CONVERT.run([source, f"--output={os.fspath(target)}"], options, folder=folder).ensure_success()
    for line in done.messages:
        if line.startswith("warning: "):
            warnings.warn(line.removeprefix("warning: "), stacklevel=stacklevel)


def save(thing: Writable, path: StrPath, options: Mapping[str, object]) -> None:
    """Writes a mesh, surface or network in the format of the extension."""
    with work_folder() as folder:
        convert_file(thing._write(folder), path, options, folder)


def is_folder_of_arrays(path: StrPath) -> bool:
    """True for a folder .npyd, which needs no conversion."""
    return os.path.isdir(path) and os.fspath(path).endswith(".npyd")


def load(path: StrPath, name: str, read: Callable[[str], _Read]) -> _Read:
    """Reads a file of any format: ``read`` gets it converted to the format of the file ``name``."""
    with work_folder() as folder:
        converted = os.path.join(folder, name)
        convert_file(os.fspath(path), converted, {}, folder)
        return read(converted)
