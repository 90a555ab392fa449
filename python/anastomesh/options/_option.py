"""Keyword arguments of a verb and their form on the command line."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterator, Mapping, Sequence
from types import UnionType
from typing import Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

import numpy as np


class Option(NamedTuple):
    """Description of a keyword argument, attached to its type by ``Annotated``."""

    #: Meaning and unit, for the docstring.
    text: str
    #: Default of the program; None if the option is absent by default.
    default: Any = None
    #: Name on the command line; None if it is the keyword with hyphens, empty if only ``off`` exists.
    flag: str | None = None
    #: Name on the command line of the value False.
    off: str | None = None
    #: Separator of the items of a sequence; without one the option is repeated for each item.
    join: str | None = None


class Keyword(NamedTuple):
    """A keyword argument: its name, its type and its description."""

    name: str
    hint: Any
    option: Option

    @property
    def flag(self) -> str:
        """Name on the command line, without leading hyphens."""
        return self.name.replace("_", "-") if self.option.flag is None else self.option.flag

    @property
    def takes_bool(self) -> bool:
        """True if the keyword accepts True and False."""
        return bool in _parts(self.hint)

    def spellings(self) -> dict[str, str]:
        """Names on the command line with what a caller writes in Python instead."""
        on = f"{self.name}=True" if self.hint is bool else f"{self.name}="
        found = {self.flag: on, self.option.off: f"{self.name}=False"}
        return {flag: python for flag, python in found.items() if flag}

    def words(self, value: Any) -> list[str]:
        """Arguments of the command line for a value."""
        if value is None:
            return []
        if isinstance(value, (bool, np.bool_)):
            if not self.takes_bool:
                raise TypeError(f"{self.name}={value}: give {self.kind()}")
            flag = self.flag if value else self.option.off
            return [f"--{flag}"] if flag else []
        if isinstance(value, (str, int, float, os.PathLike)) or hasattr(value, "__float__") and np.ndim(value) == 0:
            if self.hint is bool:
                raise TypeError(f"{self.name}={value!r}: give True or False")
            items = [os.fspath(value) if isinstance(value, os.PathLike) else value]
        elif self.option.join is not None:
            items = [self.option.join.join(map(str, self.items(value)))]
        else:
            items = self.items(value)
        # Joined by an equals sign: a negative number is otherwise taken for an option.
        return [f"--{self.flag}={item}" for item in items]

    def items(self, value: Any) -> list[Any]:
        """Items of a sequence, where the type allows one."""
        takes_items = any(get_origin(part) in (Sequence, tuple) for part in _parts(self.hint))
        if not takes_items or not hasattr(value, "__iter__"):
            raise TypeError(f"{self.name}={value!r}: give {self.kind()}")
        return list(value)

    def kind(self) -> str:
        """The type as the docstring shows it."""
        return " or ".join(_shown(part) for part in _parts(self.hint))

    def documented(self) -> str:
        """Entry of the docstring, in the style of numpydoc."""
        default = "" if self.option.default is None else f", default {self.option.default!r}"
        return f"{self.name} : {self.kind()}{default}\n    {self.option.text}."


def _parts(hint: Any) -> list[Any]:
    """Alternatives of a type, without None."""
    is_union = get_origin(hint) in (Union, UnionType)
    return [part for part in get_args(hint) if part is not type(None)] if is_union else [hint]


def _shown(hint: Any) -> str:
    if get_origin(hint) is Literal:
        return "{" + ", ".join(map(repr, get_args(hint))) + "}"
    if get_origin(hint) is os.PathLike:
        return "os.PathLike"
    if get_origin(hint) is None and hasattr(hint, "__name__"):
        return str(hint.__name__)
    return str(hint).replace("typing.", "").replace("collections.abc.", "")


def keywords(options: type) -> dict[str, Keyword]:
    """Keyword arguments that a ``TypedDict`` of this package lists."""
    hints = get_type_hints(options, include_extras=True)
    return {name: Keyword(name, hint.__origin__, hint.__metadata__[0]) for name, hint in hints.items()}


def words(verb: str, known: Mapping[str, Keyword], given: Mapping[str, Any]) -> list[str]:
    """Arguments of the command line for keyword arguments; ``verb`` names the function in errors."""
    return list(_words(verb, known, given))


def _words(verb: str, known: Mapping[str, Keyword], given: Mapping[str, Any]) -> Iterator[str]:
    for name, value in given.items():
        if name not in known:
            similar = difflib.get_close_matches(name, known, 1)
            hint = f"; did you mean {similar[0]!r}?" if similar else ""
            raise TypeError(f"{verb}() got an unexpected keyword argument {name!r}{hint}")
        yield from known[name].words(value)
