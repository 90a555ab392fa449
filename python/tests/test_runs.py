"""Progress, and runs that are stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import anastomesh
import pytest

# A run of many seconds, which says when it has begun.
LONG = """
import anastomesh, signal, sys
# Shells have what they start in the background ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
def told(progress):
    if progress.stage == "blocks":
        print("begun", flush=True)
try:
    anastomesh.mesh(sys.argv[1], progress=told, rho=12, threads=1)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_progress_is_told_in_order(fixtures: Path) -> None:
    told: list[anastomesh.Progress] = []
    anastomesh.mesh(fixtures / "tree_30.vtp", progress=told.append)
    stages = list(dict.fromkeys(progress.stage for progress in told))
    assert {"prepare", "partition", "blocks", "check", "write"} <= set(stages)
    blocks = [progress for progress in told if progress.stage == "blocks"]
    assert blocks[-1].fraction == 1
    assert [p.done for p in blocks] == sorted(p.done for p in blocks)
    anastomesh.tetrahedralize(fixtures / "torus.off", progress=told.append)
    assert told[-1].stage == "write"


def test_progress_by_tqdm(fixtures: Path, capsys: pytest.CaptureFixture[str]) -> None:
    anastomesh.mesh(fixtures / "tree_30.vtp", progress=True)
    assert "blocks" in capsys.readouterr().err


def test_who_listens_may_end_the_run(fixtures: Path) -> None:
    class Enough(Exception):
        pass

    def told(progress: anastomesh.Progress) -> None:
        if progress.stage == "blocks":
            raise Enough

    start = time.monotonic()
    with pytest.raises(Enough):
        anastomesh.mesh(fixtures / "tree_30.vtp", rho=12, progress=told)
    assert time.monotonic() - start < 8


needs_proc = pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")


def of_program() -> set[int]:
    """Processes of the program."""
    found = set()
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and os.readlink(entry / "exe") == os.path.realpath(anastomesh.binary()):
                found.add(int(entry.name))
        except OSError:
            continue
    return found


@needs_proc
@pytest.mark.parametrize("name", ["SIGINT", "SIGKILL"])
def test_the_program_ends_with_its_caller(fixtures: Path, tmp_path: Path, name: str) -> None:
    how = signal.Signals[name]
    before = of_program()
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    command = [sys.executable, "-c", LONG, str(fixtures / "tree_30.vtp")]
    caller = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert caller.stdout is not None and caller.stdout.readline() == "begun\n"
    assert of_program() - before
    caller.send_signal(how)
    rest, _ = caller.communicate(timeout=20)
    if how == signal.SIGINT:
        assert rest.endswith("interrupted\n")
        assert os.listdir(tmp_path) == []
    end = time.monotonic() + 20
    while of_program() - before and time.monotonic() < end:
        time.sleep(0.1)
    assert not of_program() - before


@needs_proc
def test_a_run_that_somebody_else_ends(fixtures: Path) -> None:
    before = of_program()
    ended: set[int] = set()

    def told(progress: anastomesh.Progress) -> None:
        if progress.stage == "blocks":
            # Once: the second signal would end it without a word.
            for process in of_program() - before - ended:
                os.kill(process, signal.SIGTERM)
                ended.add(process)

    with pytest.raises(anastomesh.StoppedError, match="stopped") as caught:
        anastomesh.mesh(fixtures / "tree_30.vtp", rho=12, threads=1, progress=told)
    assert caught.value.exit_code == 130


def test_the_program_is_on_the_path() -> None:
    said = subprocess.run([sys.executable, "-m", "anastomesh", "--version"], capture_output=True, text=True, check=True)
    assert said.stdout.startswith("anastomesh ")
    assert os.access(anastomesh.binary(), os.X_OK)
