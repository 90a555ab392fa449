"""Runs of the program: its lines become progress and messages, its exit code an exception."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple, TypeVar

from ._binary import binary
from ._errors import Error, error_of
from ._progress import Progress, ProgressLike, listener

_Made = TypeVar("_Made")

# Seconds that the program may take to end after a signal, before it gets the next one.
_PATIENCE = 10.0


class Done(NamedTuple):
    """Result of a run."""

    code: int
    #: What the program printed as JSON.
    report: dict[str, Any] | None
    #: Lines that the program wrote to standard error.
    messages: tuple[str, ...]

    @property
    def message(self) -> str:
        """The error among the messages: from the last line that names the program, or all of them."""
        starts = ("anastomesh: ", "error: ")
        said = [i for i, line in enumerate(self.messages) if line.startswith(starts)]
        # Lines that follow belong to it.
        text = "\n".join(self.messages[said[-1] :] if said else self.messages).strip()
        for start in starts:
            text = text.removeprefix(start)
        return text

    def error(self, result: Any = None) -> Error:
        """The exception for the exit code."""
        return error_of(self.code, self.message, report=self.report, result=result, messages=self.messages)

    def saying(self, change: Callable[[str], str | None]) -> Done:
        """The same run with every message changed, or left out for None."""
        changed = (change(line) for line in self.messages)
        return self._replace(messages=tuple(line for line in changed if line is not None))

    def made(self, result: _Made | None) -> _Made:
        """The result; raises the exception of a run that failed, with the result if there is one."""
        if self.code:
            raise self.error(result)
        if result is None:
            raise Error("the program ended without an error and without a result", report=self.report, messages=self.messages)
        return result

    def ensure_success(self) -> Done:
        """Raises the exception of a run that failed."""
        if self.code:
            raise self.error()
        return self


@contextmanager
def work_folder() -> Iterator[str]:
    """Temporary folder for arrays; mapped arrays stay readable after it is removed."""
    folder = tempfile.mkdtemp(prefix="anastomesh-")
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def run(words: Sequence[str], progress: ProgressLike = None) -> Done:
    """Runs the program with the arguments ``words`` to its end."""
    hear, close = listener(progress)
    with tempfile.TemporaryFile() as out:
        # A session of its own: Ctrl-C in a terminal reaches this process alone, which passes it on once.
        process = subprocess.Popen(
            [binary(), *words], stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE, start_new_session=True
        )
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
        return Done(code, _report(out.read()), messages)


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
    """Stops the program as Ctrl-C does, so that it removes partial files."""
    if process.stderr is not None:
        process.stderr.close()
    # Windows has no signal that the program could handle.
    signals = (signal.SIGINT, signal.SIGINT, signal.SIGKILL) if sys.platform != "win32" else (signal.SIGTERM,)
    for how in signals:
        process.send_signal(how)
        try:
            process.wait(_PATIENCE)
            return
        except subprocess.TimeoutExpired:
            continue
        except KeyboardInterrupt:
            # A second Ctrl-C does not wait.
            process.kill()
            process.wait()
            return


def _report(text: bytes) -> dict[str, Any] | None:
    try:
        report = json.loads(text)
    except ValueError:
        return None
    return report if isinstance(report, dict) else None
