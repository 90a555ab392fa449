"""Type annotations, checked by mypy."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def mypy(*arguments: str | Path) -> tuple[int, str]:
    command = [sys.executable, "-m", "mypy", "--strict", f"--config-file={ROOT / 'pyproject.toml'}", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parent, check=False)
    return done.returncode, done.stdout


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Examples of the documentation, each document as one module."""
    from test_docs import blocks

    path = tmp_path_factory.mktemp("examples") / "documented.py"
    path.write_text("\n".join(blocks()))
    return path


def test_package_tests_and_examples(examples: Path) -> None:
    code, said = mypy("-p", "anastomesh")
    assert code == 0, said
    code, said = mypy(*sorted(Path(__file__).parent.glob("*.py")), ROOT / "python/examples/vessels.py")
    assert code == 0, said
    code, said = mypy(examples)
    assert code == 0, said


def test_faulty_calls_are_rejected(tmp_path: Path) -> None:
    wrong = [
        ("anastomesh.mesh('x.vtp', nonsense=3)", "call-arg"),
        ("anastomesh.mesh('x.vtp', rho='thick')", "arg-type"),
        ("anastomesh.mesh(3)", "arg-type"),
        ("anastomesh.refine('x.vtp', residual='shrunk')", "arg-type"),
        ("anastomesh.tetrahedralize('x.off', refine=3)", "arg-type"),
        ("anastomesh.tetrahedralize('x.off', rho=3)", "call-arg"),
        ("anastomesh.render('x.vtu', size=3)", "arg-type"),
        ("anastomesh.check('x.vtu').failed[0].nonsense", "attr-defined"),
        ("anastomesh.TetGen('x.off').tetrahedralize(nonsense=3)", "call-arg"),
        ("anastomesh.Mesh.load('x.vtu').save('y.vtu', nonsense=3)", "call-arg"),
        ("number: int = anastomesh.surface('x.vtp')", "assignment"),
        ("anastomesh.nonsense", "attr-defined"),
    ]
    used = tmp_path / "used.py"
    used.write_text("\n".join(["import anastomesh", *(line for line, _ in wrong)]))
    code, said = mypy(used)
    found = [(int(line), kind) for line, kind in re.findall(r"used.py:(\d+): error: .*\[([a-z-]+)\]$", said, re.M)]
    assert code == 1 and found == [(i + 2, kind) for i, (_, kind) in enumerate(wrong)], said
