"""Examples of the documentation run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from anastomesh._binary import binary

ROOT = Path(__file__).parents[2]


def blocks(page: str = "docs/python.md") -> list[str]:
    """Blocks of Python in a page, in their order; each continues the one before it."""
    return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)


def test_documentation(tmp_path: Path) -> None:
    assert len(blocks()) > 5
    done = subprocess.run([sys.executable, "-c", "\n".join(blocks())], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    printed = re.findall(r"^ *print\(.*\) +# (.*)$", "\n".join(blocks()), re.M)
    assert len(printed) > 3
    for line in printed:
        pattern = re.escape(line).replace(re.escape("..."), ".*")
        assert re.search(f"^{pattern}$", done.stdout, re.M), line
    assert {"vessels.vtu", "vessels.png", "vessels.html"} <= {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize("page", ["meshio", "pyvista", "simvascular", "slicer", "svv", "vmtk"])
def test_pages_of_adapters(page: str, tmp_path: Path) -> None:
    if page in ("svv", "vmtk"):
        pytest.importorskip(page, reason=f"{page} is not installed")
    code = "\n".join(blocks(f"docs/adapters/{page}.md"))
    assert "import" in code
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_tutorial(tmp_path: Path) -> None:
    env = {**os.environ, "PATH": os.pathsep.join([os.path.dirname(binary()), os.environ["PATH"]]), "ANASTOMESH_REQUIRE_ORACLES": "1"}
    command = [sys.executable, str(ROOT / "docs/run"), "--check", "--any-times", str(ROOT / "docs/tutorials/surface.md")]
    done = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_links_are_absolute() -> None:
    """The page is shown on PyPI, where links into the repository lead nowhere."""
    links = re.findall(r"\]\((.*?)\)", (ROOT / "docs/python.md").read_text(encoding="utf-8"))
    assert links and all(link.startswith(("https://", "#")) for link in links)


def test_the_example_runs(tmp_path: Path) -> None:
    picture = tmp_path / "vessels.png"
    command = [sys.executable, str(ROOT / "python/examples/vessels.py"), str(picture)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "valid: True" in done.stdout and "blocks: 100%" in done.stderr
    assert picture.stat().st_size > 20_000
