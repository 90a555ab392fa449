"""Verbs of the program: their keyword arguments, documentation and runs."""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from ._progress import ProgressLike
from ._run import Done, run
from .options._option import keywords, words

_Function = TypeVar("_Function", bound=Callable[..., Any])

#: Options of the program whose place in Python is not a keyword argument.
_ELSEWHERE = {"json": "the report", "verbose": "the report"}


class Verb:
    """A verb of the program with the keyword arguments of its Python functions.

    ``json`` and ``progress`` tell whether it has the options ``--json`` and ``--progress``; ``mode`` is one more option.
    """

    def __init__(self, name: str, options: type, *, mode: str = "", json: bool = True, progress: bool = True) -> None:
        self.keywords = keywords(options)
        self._name = name
        self._function = name
        fixed = [(mode, bool(mode)), ("--json", json), ("--progress=json", progress)]
        self._fixed = [option for option, given in fixed if given]

    def run(
        self, given: Sequence[str], options: Mapping[str, object], progress: ProgressLike = None, *, folder: str = ""
    ) -> Done:
        """Runs the verb to its end; messages do not name ``folder``, that of the arrays."""
        command = [self._name, *given, *words(self._function, self.keywords, options), *self._fixed]
        return run(command, progress).saying(lambda line: self.in_python(line, folder))

    def in_python(self, line: str, folder: str = "") -> str | None:
        """A message with the names of keyword arguments and functions; None for hints about the command line."""
        if line.startswith(("For more information, try", "Usage: ")):
            return None
        spelled = {flag: python for word in self.keywords.values() for flag, python in word.spellings().items()}
        spelled.update(_ELSEWHERE)
        # The value, if one is shown, belongs to the name.
        line = re.sub(
            r"--([a-z][a-z0-9-]*)(?: <[^>]*>)?",
            lambda found: spelled.get(found[1], found[1].replace("-", "_") + "="),
            line.replace(folder + os.sep, "") if folder else line,
        )
        return re.sub(r"`anastomesh ([a-z]+)`", r"`anastomesh.\1()`", line)

    def documents(self, function: _Function) -> _Function:
        """Completes the docstring and the signature of a function with the keyword arguments."""
        self._function = function.__name__
        own = inspect.signature(function).parameters.values()
        named = [parameter for parameter in own if parameter.kind is not parameter.VAR_KEYWORD]
        listed = [
            inspect.Parameter(word.name, inspect.Parameter.KEYWORD_ONLY, default=word.option.default, annotation=word.hint)
            for word in self.keywords.values()
        ]
        function.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [*named, *listed], return_annotation=inspect.signature(function).return_annotation
        )
        text = "\n".join(word.documented() for word in self.keywords.values())
        function.__doc__ = f"{inspect.getdoc(function)}\n\nKeyword arguments\n-----------------\n{text}\n"
        return function
