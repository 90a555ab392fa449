"""Runs the program: options to arguments, its lines to progress and messages, its exit code to an exception."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

from ._binary import binary
from ._errors import error_of
from ._progress import Progress, ProgressLike, listener

# What this package says itself.
_OURS = {"output", "json", "quiet", "progress", "from", "to", "format", "help", "version"}

# Seconds that a run may take to end after it was told to; then it is told again, and then it is killed.
_PATIENCE = 10.0


class Done(NamedTuple):
    """A run that has ended."""

    code: int
    report: dict[str, Any] | None
    #: The lines that it has said.
    messages: tuple[str, ...]

    @property
    def message(self) -> str:
        """The error among the lines: what begins with the program's name, or all of them."""
        name = "anastomesh: "
        said = [i for i, line in enumerate(self.messages) if line.startswith(name)]
        # What stands behind it belongs to it.
        lines = self.messages[said[-1] :] if said else self.messages
        return "\n".join(lines).strip().removeprefix(name).removeprefix("error: ")

    def error(self, result: Any = None) -> Exception:
        """The exception for the exit code."""
        return error_of(self.code, self.message, report=self.report, result=result, messages=self.messages)


@contextmanager
def work_folder() -> Iterator[str]:
    """A folder for arrays on their way; what is mapped stays readable when it is gone."""
    folder = tempfile.mkdtemp(prefix="anastomesh-")
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def arguments(options: Mapping[str, Any]) -> list[str]:
    """Options as the command line has them: ``max_volume=0.1`` is ``--max-volume 0.1``, True a flag, a list several times."""
    words = []
    for name, value in options.items():
        if name in _OURS:
            raise TypeError(f"{name} is not for the caller to give")
        flag = "--" + name.replace("_", "-")
        values = value if isinstance(value, Sequence) and not isinstance(value, str) else [value]
        for one in values:
            if one is None or one is False:
                continue
            if one is True:
                words.append(flag)
                continue
            if not isinstance(one, (str, int, float, os.PathLike)) and not hasattr(one, "__float__"):
                raise TypeError(f"{name} is {one!r}; give a number, a text, True or a list of these")
            # With a sign of its own a value would look like an option.
            words.append(f"{flag}={os.fspath(one) if isinstance(one, os.PathLike) else one}")
    return words


def run(verb: str, words: Sequence[str], progress: ProgressLike = None, *, folder: str = "", tells: bool = True) -> Done:
    """Runs a verb to its end. ``folder``: that of the arrays, which messages need not name; ``tells``: whether the verb knows
    ``--progress``."""
    hear, close = listener(progress)
    command = [binary(), verb, *words, "--json"]
    if tells:
        # Without anybody who listens it is still the way in which the program learns that this one is gone.
        command += ["--progress", "json"]
    with tempfile.TemporaryFile() as out:
        # In a session of its own: Ctrl-C in a terminal reaches this process alone, which passes it on once.
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE, start_new_session=True)
        try:
            messages = _listen(process, hear)
            code = process.wait()
        except BaseException:
            _stop(process)
            raise
        finally:
            if process.stderr is not None:
                process.stderr.close()
            close()
        out.seek(0)
        return Done(code, _report(out.read()), tuple(line.replace(folder + os.sep, "") for line in messages))


def _listen(process: subprocess.Popen[bytes], hear: Callable[[Progress], Any] | None) -> tuple[str, ...]:
    messages = []
    assert process.stderr is not None
    for raw in process.stderr:
        line = raw.decode(errors="replace").rstrip("\n")
        if not line.startswith('{"progress":'):
            messages.append(line)
        elif hear is not None:
            hear(Progress(**json.loads(line)["progress"]))
    return tuple(messages)


def _stop(process: subprocess.Popen[bytes]) -> None:
    """Ends the program as Ctrl-C does: it leaves nothing partial."""
    if process.stderr is not None:
        process.stderr.close()
    for how in (signal.SIGINT, signal.SIGINT, signal.SIGKILL):
        process.send_signal(how)
        try:
            process.wait(_PATIENCE)
            return
        except subprocess.TimeoutExpired:
            continue
        except KeyboardInterrupt:
            # Asked for once more: without patience.
            process.kill()
            process.wait()
            return


def _report(text: bytes) -> dict[str, Any] | None:
    try:
        report = json.loads(text)
    except ValueError:
        return None
    return report if isinstance(report, dict) else None
