"""Script ``vmtkanastomesh`` of VMTK, with the members of ``vmtktetgen``.

The command ``vmtk`` with this script::

    python -m anastomesh.adapters.vmtk vmtkmeshgenerator -ifile wall.vtp -edgelength 0.5 -ofile mesh.vtu
    python -m anastomesh.adapters.vmtk vmtkmeshreader -ifile wall.vtu --pipe vmtkanastomesh -ofile mesh.vtu
"""

from __future__ import annotations

import sys

import numpy as np
from vmtk import vmtkscripts as scripts
from vmtk import vmtktetgen as original
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkUnstructuredGrid

from .._errors import Error
from .._surface_verbs import tetrahedralize
from ._vtk import VtkSurface, add_cell_array, cell_array, grid_of, point_array, surface_of, triangles_of

#: Members of ``vmtktetgen`` that ask for another result, with their only accepted value.
_ONLY = {"Refine": 0, "Coarsen": 0, "VarVolume": 0, "RegionAttrib": 0, "Order": 1}


class vmtkAnastomesh(original.vmtkTetGen):  # type: ignore[misc]
    """Fills a closed surface with tetrahedra.

    Members are inherited. Those that tune algorithms of TetGen are ignored: ``MaxDihedral``, ``RemoveSliver``, ``Epsilon``,
    ``NoMerge``, ``DetectInter``, ``CheckClosure``, ``DoCheck`` and ``Verbose``.
    """

    def __init__(self) -> None:
        super().__init__()
        self.Mesh: vtkUnstructuredGrid | None
        self.SetScriptName("vmtkanastomesh")
        self.SetScriptDoc("fills a closed surface with tetrahedra by Anastomesh; members are those of vmtktetgen")

    def Execute(self) -> None:
        """Replaces ``Mesh`` by the mesh of its inside."""
        if self.Mesh is None:
            self.PrintError("Error: no input mesh")
            return
        for member, value in _ONLY.items():
            if getattr(self, member) != value:
                self.PrintError(f"Error: {member}={getattr(self, member)} is not supported: use {value}")
        surface = _capped(self.Mesh, self.CellEntityIdsArrayName) if self.GenerateCaps else self.Mesh
        try:
            points, triangles = triangles_of(surface)
            mesh = tetrahedralize(
                points,
                triangles,
                markers=cell_array(surface, self.CellEntityIdsArrayName),
                plc=bool(self.PLC),
                refine=bool(self.Quality or self.FixedVolume or self.UseSizingFunction),
                max_radius_edge=self.MinRatio if self.Quality else None,
                min_dihedral=self.MinDihedral if self.Quality else None,
                max_volume=self.MaxVolume if self.FixedVolume else None,
                size=self._size(surface),
                split=not self.NoBoundarySplit,
            )
        except (Error, ValueError) as error:
            self.PrintError(f"Error: {error}")
            return
        kinds = {"tets": bool(self.OutputVolumeElements), "triangles": bool(self.OutputSurfaceElements)}
        self.Mesh = grid_of(mesh, self.CellEntityIdsArrayName, **kinds)
        a, b, c, d = (mesh.points[mesh.tets[:, corner]] for corner in range(4))
        volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
        of_cells = np.zeros(self.Mesh.GetNumberOfCells())
        if self.OutputVolumeElements:
            of_cells[: len(volumes)] = volumes
        add_cell_array(self.Mesh, self.TetrahedronVolumeArrayName, numpy_to_vtk(of_cells, deep=True))

    def _size(self, surface: VtkSurface) -> float | None:
        """Largest value of the sizing function. Smaller ones belong to smaller triangles, from which edge lengths grow."""
        if not self.UseSizingFunction:
            return None
        sizes = point_array(surface, self.SizingFunctionArrayName)
        if sizes is None:
            name = self.SizingFunctionArrayName
            raise ValueError(f"the surface has no point array {name!r}: add it, or set UseSizingFunction to 0")
        return float(sizes.max())


def _capped(surface: VtkSurface, ids: str) -> vtkPolyData:
    """The surface with a cap on each hole; the ids of caps follow those of the surface."""
    capper = scripts.vmtkSurfaceCapper()
    # Offsets of cells that VMTK appends to must be stored. Those of VTK's filters may be implicit.
    capper.Surface = surface_of(*triangles_of(surface), cell_array(surface, ids), ids)
    capper.CellEntityIdsArrayName = ids
    capper.Method, capper.Interactive, capper.LogOn = "centerpoint", 0, 0
    capper.Execute()
    capped: vtkPolyData = capper.Surface
    return capped


def install() -> None:
    """Adds the script to VMTK, and puts it in the place of ``vmtktetgen``, which ``vmtkmeshgenerator`` uses."""
    sys.modules["vmtk.vmtkanastomesh"] = sys.modules[__name__]
    scripts.vmtkAnastomesh = scripts.vmtkTetGen = vmtkAnastomesh


def main() -> int:
    """Runs the command ``vmtk`` with the script."""
    # The imported module, not the one that runs as a program.
    from vmtk import pypemain

    from anastomesh.adapters import vmtk

    vmtk.install()
    return int(pypemain.main() or 0)


if __name__ == "__main__":
    sys.exit(main())
