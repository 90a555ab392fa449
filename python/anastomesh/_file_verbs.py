"""Functions that take a mesh, a surface or a network: checks, pictures and files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from ._files import CONVERT, convert_file
from ._foreign import ForeignSurface, has_lines, is_graph, is_surface
from ._mesh import Mesh
from ._network import NetworkLike, write_network
from ._progress import ProgressLike
from ._report import CheckReport
from ._run import work_folder
from ._surface import Surface
from ._verb import Verb
from .options import CheckOptions, ConvertOptions, RenderOptions, StrPath, ViewOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack

_CHECK = Verb("check", CheckOptions)
_RENDER = Verb("render", RenderOptions, json=False, progress=False)
_VIEW = Verb("view", ViewOptions, json=False, progress=False)

#: What pictures show: a mesh, a surface, a network, or the path of a file.
Drawable = Mesh | Surface | ForeignSurface | NetworkLike


class Picture(bytes):
    """Bytes of a PNG file; a notebook shows them as a picture."""

    def _repr_png_(self) -> bytes:
        return bytes(self)

    def __repr__(self) -> str:
        return f"Picture({len(self):,} bytes)"


@_CHECK.documents
def check(mesh: Mesh | StrPath, *, progress: ProgressLike = None, **options: Unpack[CheckOptions]) -> CheckReport:
    """Checks the validity of a :class:`Mesh`, or of the mesh in a file, condition by condition.

    An invalid mesh is not an exception: the result is false, and its ``failed`` lists the conditions that do not hold.
    """
    with work_folder() as folder:
        path = mesh._write(folder) if isinstance(mesh, Mesh) else os.fspath(mesh)
        done = _CHECK.run([path], options, progress, folder=folder)
        if done.report is None or done.code not in (0, 1):
            raise done.error()
        return CheckReport(done.code == 0, done.report)


@CONVERT.documents
def convert(source: Drawable, target: StrPath, **options: Unpack[ConvertOptions]) -> None:
    """Writes a mesh, a surface or a network to the file ``target``, in the format of its extension.

    Meshes: .vtu, .pvtu, .msh, .msh2, .mesh, .foam, .svmesh, .ele, .npyd; their boundaries and surfaces: .stl, .ply, .obj, .off,
    .glb, .3mf, .vtp; networks: .vtp, .npyd and, for trees, .swc.
    """
    with work_folder() as folder:
        convert_file(_written(source, folder), target, options, folder, stacklevel=3)


@_RENDER.documents
def render(
    drawn: Drawable,
    output: StrPath | None = None,
    *,
    network: NetworkLike | None = None,
    **options: Unpack[RenderOptions],
) -> Picture:
    """Renders a mesh, a surface or a network, and returns the bytes of a PNG file.

    The picture is also written to ``output`` if given. ``network`` is the network of a mesh, for colours by radius or order.
    """
    with work_folder() as folder:
        path = os.path.join(folder, "picture.png") if output is None else os.fspath(output)
        words = [_written(drawn, folder), f"--output={path}", *_beside(network, folder)]
        _RENDER.run(words, options, folder=folder).ensure_success()
        return Picture(Path(path).read_bytes())


@_VIEW.documents
def view(
    drawn: Drawable,
    output: StrPath,
    *,
    network: NetworkLike | None = None,
    **options: Unpack[ViewOptions],
) -> None:
    """Writes an interactive 3D viewer of a mesh, a surface or a network to the HTML file ``output``.

    ``network`` is the network of a mesh: it adds colours by radius and order, and the names of vessels and nodes.
    """
    with work_folder() as folder:
        words = [_written(drawn, folder), f"--output={os.fspath(output)}", *_beside(network, folder)]
        _VIEW.run(words, options, folder=folder).ensure_success()


def _written(drawn: Drawable, folder: str) -> str:
    """Path of what is drawn, which is written to ``folder`` if it is not a file."""
    if isinstance(drawn, (Mesh, Surface)):
        return drawn._write(folder)
    if is_surface(drawn) and not has_lines(drawn) and not is_graph(drawn):
        return Surface.of(drawn)._write(folder)
    return write_network(folder, drawn)  # type: ignore[arg-type]


def _beside(network: NetworkLike | None, folder: str) -> list[str]:
    return [] if network is None else [f"--network={write_network(folder, network)}"]
