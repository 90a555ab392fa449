"""What can go wrong: a class for each exit code of the program."""

from __future__ import annotations

from typing import Any


class Error(RuntimeError):
    """The program did not do what it was asked for.

    ``report`` is what it reports all the same (None where it has none), ``result`` the mesh or network that it has written
    (None where it has not), ``messages`` are the lines that it has said and ``exit_code`` is the code it ended with.
    """

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
        self.report = report
        self.result = result
        self.messages = messages
        if exit_code is not None:
            self.exit_code = exit_code


class InvalidError(Error):
    """A gate is not met: the mesh is there (``result``) and is not valid, or a bound is not met."""

    exit_code = 1


class UsageError(Error, TypeError):
    """An option that there is not, or a value that it cannot have."""

    exit_code = 2


class InputError(Error, ValueError):
    """The input cannot be read or used, or there is no room for the output."""

    exit_code = 3


class StageError(Error):
    """A stage failed: blocks could not be meshed, a surface not be recovered."""

    exit_code = 4


class BugError(Error):
    """A fault of the program."""

    exit_code = 70


class StoppedError(Error):
    """Somebody else stopped the run; after Ctrl-C it is ``KeyboardInterrupt`` that is raised."""

    exit_code = 130


_BY_CODE = {kind.exit_code: kind for kind in (InvalidError, UsageError, InputError, StageError, BugError, StoppedError)}


def error_of(code: int, message: str, **what: Any) -> Error:
    """The exception for an exit code; a negative one is a signal."""
    if code < 0 and code not in _BY_CODE:
        return StoppedError(message or f"the program was ended by signal {-code}", exit_code=code, **what)
    return _BY_CODE.get(code, BugError)(message or f"the program ended with {code}", exit_code=code, **what)
