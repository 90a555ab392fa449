"""Exceptions, one for each exit code of the program."""

from __future__ import annotations

from typing import Any

from ._report import Condition, failed_conditions


class Error(RuntimeError):
    """Failure of a run; base class of the exceptions of this package."""

    exit_code: int = 4

    def __init__(
        self,
        message: str,
        *,
        report: dict[str, Any] | None = None,
        result: Any = None,
        messages: tuple[str, ...] = (),
        exit_code: int | None = None,
    ) -> None:
        super().__init__(message)
        #: The program's report, or None.
        self.report = report
        #: The mesh, surface or network that was made all the same, or None.
        self.result = result
        #: Everything that the program said, line by line.
        self.messages = messages
        if exit_code is not None:
            self.exit_code = exit_code


class InvalidError(Error):
    """The result exists but is not valid, or exceeds a bound; it is in ``result``, the failed conditions are in ``failed``."""

    exit_code = 1

    def __init__(self, message: str, **details: Any) -> None:
        #: Conditions that fail, each with its name, count and places. Empty if only the message tells the reason.
        self.failed: list[Condition] = failed_conditions(details.get("report"))
        super().__init__("\n".join([*map(str, self.failed), message]).rstrip() or "the result is not valid", **details)


class UsageError(Error, ValueError):
    """A keyword argument has a value that it cannot have, or does not go with another one."""

    exit_code = 2


class InputError(Error, ValueError):
    """The input cannot be read or used, or the output cannot be written."""

    exit_code = 3


class StageError(Error):
    """A stage failed: blocks could not be meshed, or a surface could not be recovered."""

    exit_code = 4


class BugError(Error):
    """An internal error of the program."""

    exit_code = 70


class StoppedError(Error):
    """Another process stopped the run. Ctrl-C raises ``KeyboardInterrupt`` instead."""

    exit_code = 130


_BY_CODE = {kind.exit_code: kind for kind in (InvalidError, UsageError, InputError, StageError, BugError, StoppedError)}


def error_of(code: int, message: str, **details: Any) -> Error:
    """The exception for an exit code; negative codes are signals."""
    if code < 0 and code not in _BY_CODE:
        return StoppedError(message or f"the program was ended by signal {-code}", exit_code=code, **details)
    kind = _BY_CODE.get(code, BugError)
    if kind is not InvalidError:
        message = message or f"the program ended with exit code {code}"
    return kind(message, exit_code=code, **details)
