"""Keyword arguments agree with the options of the program."""

from __future__ import annotations

import inspect
import re
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import anastomesh
import networkx as nx
import pytest
from anastomesh import options
from anastomesh._verb import Verb
from anastomesh.options._option import Keyword, keywords
from anastomesh.options.files import CapOptions, FileOptions

#: Options that the package itself gives, and those of files that it does not write.
OURS = {"output", "json", "quiet", "verbose", "progress", "log-format", "certificate"}

#: Options of `mesh` that concern its files.
IN_FILES = {"dry-run", "shard", "format", "prisms", "parts", "split-regions", "float32", "cells", "compress"}

#: Functions, their verb and keywords, and options of the verb that are found elsewhere in Python.
FUNCTIONS: list[tuple[Callable[..., Any], str, type, set[str]]] = [
    # Files are written by Mesh.save; estimate and mesh_shard have the rest.
    (anastomesh.mesh, "mesh", options.MeshOptions, IN_FILES),
    (anastomesh.estimate, "mesh", options.MeshOptions, IN_FILES),
    (anastomesh.mesh_shard, "mesh", options.MeshOptions, IN_FILES),
    (anastomesh.flow, "flow", options.NetworkFlowOptions, set()),
    (anastomesh.surface, "surface", options.SurfaceOptions, set()),
    (anastomesh.prepare, "prepare", options.PrepareOptions, set()),
    (anastomesh.refine, "refine", options.RefineOptions, set()),
    (anastomesh.dual, "dual", options.NetworkOptions, set()),
    (anastomesh.generate, "generate", options.GenerateOptions, {"terminals"}),
    # Formats and files are those of Mesh.save; check_surface is --check-only; regions and holes are arrays.
    (
        anastomesh.tetrahedralize,
        "tetrahedralize",
        options.TetrahedralizeOptions,
        {"from", "to", "check-only", "region", "hole", "parts"},
    ),
    (anastomesh.check, "check", options.CheckOptions, set()),
    (anastomesh.convert, "convert", options.ConvertOptions, set()),
    # The network beside a mesh is handed over like the mesh.
    (anastomesh.render, "render", options.RenderOptions, {"network"}),
    (anastomesh.view, "view", options.ViewOptions, {"network"}),
    (anastomesh.info, "info", options.NetworkOptions, set()),
]
NAMES = [function.__name__ for function, *_ in FUNCTIONS]


@cache
def program() -> dict[str, dict[str, tuple[str, str]]]:
    """Options of all verbs: the default and the description of each."""
    text = subprocess.run([anastomesh.binary(), "man", "--markdown"], capture_output=True, text=True, check=True).stdout
    row = re.compile(r"^\| `(?:-\w, )?--([a-z0-9-]+)[^`]*` \| (?:`(.*?)`)? ?\| (.*?) \|(?: ([a-z, ]+) \|)?$", re.M)
    found: dict[str, dict[str, tuple[str, str]]] = {}
    for section in re.split(r"^## ", text, flags=re.M)[1:]:
        for name, default, said, verbs in row.findall(section):
            # Rows of shared options name their verbs.
            for verb in verbs.split(", ") if verbs else [section.split("\n")[0]]:
                found.setdefault(verb, {})[name] = (default, said)
    return found


@pytest.mark.parametrize(("function", "verb", "typed", "elsewhere"), FUNCTIONS, ids=NAMES)
def test_every_option_has_its_keyword(function: Callable[..., Any], verb: str, typed: type, elsewhere: set[str]) -> None:
    known = program()[verb]
    assert len(known) > 5 and elsewhere <= set(known)
    spelled = {flag for keyword in keywords(typed).values() for flag in keyword.spellings()}
    assert spelled == set(known) - OURS - elsewhere


def test_options_of_files_are_those_of_convert() -> None:
    files = set(keywords(FileOptions)) | set(keywords(CapOptions))
    assert {"format", "prisms", "parts", "float32", "cells", "compress"} < files < set(keywords(options.ConvertOptions))


def test_check_surface_has_options_of_tetrahedralize() -> None:
    own, whole = keywords(options.CheckSurfaceOptions), keywords(options.TetrahedralizeOptions)
    assert own.items() < whole.items()


@pytest.mark.parametrize(("function", "verb", "typed", "elsewhere"), FUNCTIONS, ids=NAMES)
def test_defaults_and_choices_agree(function: Callable[..., Any], verb: str, typed: type, elsewhere: set[str]) -> None:
    for keyword in keywords(typed).values():
        if keyword.hint is bool or not keyword.flag:
            continue
        default, said = program()[verb][keyword.flag]
        given = keyword.option.default
        assert default == ("" if given is None or given is False else str(given)), keyword.name
        choices = choices_of(keyword)
        if keyword.name == "format":
            assert all(choice in said for choice in choices)
        elif choices:
            # As `one`, `two`, or `one` (description), `two` (description).
            assert re.findall(r"`([a-z-]+)`(?= \(|,|$)", said.split(": ", 1)[1])[-len(choices) :] == choices, keyword.name


def choices_of(keyword: Keyword) -> list[str]:
    parts = [keyword.hint, *get_args(keyword.hint)]
    return [choice for part in parts if get_origin(part) is Literal for choice in get_args(part)]


@pytest.mark.parametrize(("function", "verb", "typed", "elsewhere"), FUNCTIONS, ids=NAMES)
def test_help_lists_every_keyword(function: Callable[..., Any], verb: str, typed: type, elsewhere: set[str]) -> None:
    shown = inspect.signature(function).parameters
    document = inspect.getdoc(function) or ""
    for name, keyword in keywords(typed).items():
        assert shown[name].default == keyword.option.default
        assert f"\n{name} : {keyword.kind()}" in document and f"\n    {keyword.option.text}." in document
    assert not any(parameter.kind is parameter.VAR_KEYWORD for parameter in shown.values())


def test_words_of_the_command_line() -> None:
    of = keywords(options.MeshOptions) | keywords(options.RenderOptions)
    assert of["rho"].words(3) == ["--rho=3"]
    assert of["refine"].words(True) == ["--refine"] and of["refine"].words(7) == ["--refine=7"]
    assert of["refine"].words(False) == [] and of["report"].words(None) == []
    assert of["roots"].words(["1", "x"]) == ["--root=1", "--root=x"]
    data = keywords(options.MeshOptions)["data"]
    assert data.words(["radius", "node"]) == ["--data=radius,node"] and data.words("node") == ["--data=node"]
    assert of["size"].words((300, 200)) == ["--size=300x200"] and of["at"].words([-1, 0.5, 2]) == ["--at=-1,0.5,2"]
    filling = keywords(options.TetrahedralizeOptions)
    assert filling["refine"].words(False) == ["--no-refine"] and filling["refine"].words(True) == []
    check = keywords(options.ViewOptions)["check"]
    assert check.words(True) == ["--check"] and check.words(False) == ["--no-check"] and check.words(None) == []


def test_messages_name_keywords_and_functions() -> None:
    said = Verb("mesh", options.MeshOptions).in_python
    assert said("give a name with `--radius-array`, or --rho <RHO>") == "give a name with `radius_array=`, or rho="
    assert said("--keep-going leaves blocks out") == "keep_going=True leaves blocks out"
    assert said("--root names another; --json lists all") == "roots= names another; the report lists all"
    assert said("`anastomesh refine` moves them apart, at -1 --") == "`anastomesh.refine()` moves them apart, at -1 --"
    assert said("For more information, try '--help'.") is None
    filling = Verb("tetrahedralize", options.TetrahedralizeOptions)
    assert filling.in_python("--no-refine adds no points") == "refine=False adds no points"


def test_options_from_a_file(fork: nx.Graph, tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_text("rho = 4.0\nkeep-spurs = true\n")
    by_file = anastomesh.mesh(fork, config=plan)
    assert len(by_file.tets) == len(anastomesh.mesh(fork, rho=4).tets)
    assert len(anastomesh.mesh(fork, config=plan, rho=3).tets) < len(by_file.tets)


def test_hints_are_real_types() -> None:
    assert get_type_hints(options.MeshOptions)["rho"] is float
