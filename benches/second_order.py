"""Second-order meshes (`--order 2`) in VTK, meshio and Gmsh: volumes, Jacobians, and cost beside first order.

    python3 benches/second_order.py target/release/anastomesh [NETWORK ...]

Makes straight tubes of radius 1 and length 20 at --rho 2.5, 3, 4 and 6 with both orders, and compares volumes with the exact cylinder. The
volume of second-order elements is integrated with VTK's cells and, from the nodes that meshio reads, with a quadrature of degree 3.
Gmsh gives the least Jacobian determinant and the least scaled Jacobian of all elements. Volumes of lumen and wall follow, at --rho 3 with
`--wall 0.2r` and `--layers 3`. Then the same comparison for each NETWORK, at --rho 3 and without an exact volume. Needs pyvista, meshio and numpy; gmsh if it is installed.
"""

import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import meshio
import numpy as np
import pyvista

try:
    import gmsh
except (ImportError, OSError):
    gmsh = None

TUBE = "1 2 0 0 0 1 -1\n2 2 0 0 20 1 1\n"
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


def mesh(program, network, out, *options):
    """Makes a mesh; returns its JSON report and the wall time in seconds."""
    start = time.perf_counter()
    command = [program, "mesh", network, "-o", out, "--json", *options]
    made = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if made.returncode not in (0, 1):
        sys.exit(made.stderr)
    return json.loads(made.stdout), time.perf_counter() - start


def jacobians(nodes, at):
    """Jacobian determinants of ten-node elements at a point with these barycentric coordinates."""
    by = [nodes[:, i] * (4 * at[i] - 1) for i in range(4)]
    for (i, j), middle in zip(EDGES, range(4, 10)):
        by[i] = by[i] + nodes[:, middle] * (4 * at[j])
        by[j] = by[j] + nodes[:, middle] * (4 * at[i])
    a, b, c = (by[k] - by[0] for k in (1, 2, 3))
    return np.einsum("ij,ij->i", np.cross(a, b), c)


def volume(points, cells):
    """Volume of ten-node elements in VTK's order, by a rule that is exact for cubic polynomials."""
    nodes = points[cells]
    total = -0.8 * jacobians(nodes, [0.25] * 4)
    for corner in range(4):
        at = [1 / 6] * 4
        at[corner] = 0.5
        total = total + 0.45 * jacobians(nodes, at)
    return total.sum() / 6


def of_vtk(path):
    """Volume of the quadratic tetrahedra as VTK reads them, and their number."""
    grid = pyvista.read(path)
    tets = grid.cells_dict[pyvista.CellType.QUADRATIC_TETRA]
    alone = pyvista.UnstructuredGrid({pyvista.CellType.QUADRATIC_TETRA: tets}, grid.points)
    # VTK's integration divides quadratic cells into linear ones; subdivided cells follow the curved boundary.
    faces = grid.cells_dict[pyvista.CellType.QUADRATIC_TRIANGLE]
    assert len(faces) > 0
    fine = alone.extract_surface(nonlinear_subdivision=4, algorithm="dataset_surface")
    return volume(np.asarray(grid.points, dtype=float), tets), fine.volume, len(tets)


def of_meshio(path):
    read = meshio.read(path)
    cells = np.concatenate([block.data for block in read.cells if block.type == "tetra10"])
    return volume(read.points, cells)


def of_gmsh(path):
    """Integrated volume, least Jacobian determinant and least scaled Jacobian of all ten-node tetrahedra in Gmsh."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 1)
    gmsh.open(str(path))
    tags, _ = gmsh.model.mesh.getElementsByType(11)
    least, scaled = (gmsh.model.mesh.getElementQualities(tags, name).min() for name in ("minDetJac", "minSJ"))
    points, weights = gmsh.model.mesh.getIntegrationPoints(11, "Gauss4")
    _, determinants, _ = gmsh.model.mesh.getJacobians(11, points)
    gmsh.finalize()
    return (determinants.reshape(len(tags), -1) @ weights).sum(), least, scaled, len(tags)


def compare(program, network, folder, exact=None, rho="3"):
    linear, seconds = mesh(program, network, folder / "linear.vtu", "--rho", rho)
    print(f"{network.name}, rho {rho}: order 1 in {seconds:.1f} s, {(folder / 'linear.vtu').stat().st_size / 1e6:.1f} MB")
    if exact:
        print(f"  volume {100 * (linear['check']['counts']['volume'] / exact - 1):+.3f} %")
    for name in ("curved.vtu", "curved.msh", "curved.msh2"):
        path = folder / name
        report, seconds = mesh(program, network, path, "--rho", rho, "--order", "2")
        second = report["second_order"]
        share = second["pulled"] / max(second["curved"] + second["straightened"], 1)
        print(f"{name}: order 2 in {seconds:.1f} s, {path.stat().st_size / 1e6:.1f} MB")
        print(f"  {second['curved']} of {second['midpoints']} midpoints curved, {100 * share:.3f} % pulled back,", end=" ")
        print(f"least scaled Jacobian {second['least_scaled']:.3f}")
        if path.suffix == ".vtu":
            found, surface, count = of_vtk(path)
            volumes = {"pyvista": found, "pyvista, fine surface": surface}
        else:
            if path.suffix == ".msh2":
                path = path.rename(folder / "second.msh")
            volumes = {"meshio": of_meshio(path)}
            if gmsh:
                volumes["gmsh"], least, scaled, count = of_gmsh(path)
                print(f"  gmsh: {count} elements, minDetJac {least:.3e}, minSJ {scaled:.3f}")
        for reader, found in volumes.items():
            change = f", {100 * (found / exact - 1):+.4f} % of the cylinder" if exact else ""
            print(f"  volume in {reader}: {found:.6f}{change}")


def regions(program, tube, folder):
    """Volumes of lumen and wall of both orders, compared with exact ones."""
    for options in (["--layers", "3"], ["--wall", "0.2r"], ["--wall", "0.2r", "--layers", "3"]):
        for order in ("1", "2"):
            mesh(program, tube, folder / "regions.vtu", "--order", order, *options)
            read = meshio.read(folder / "regions.vtu")
            tets = next(i for i, block in enumerate(read.cells) if block.type.startswith("tetra"))
            cells, number = read.cells[tets].data, read.cell_data.get("region", {tets: None})[tets]
            parts = {"lumen": slice(None)} if number is None else {"lumen": number == 1, "wall": number == 2}
            print(f"{' '.join(options)}, order {order}:", end="")
            for name, part in parts.items():
                corners = read.points[cells[part][:, :4]]
                found = np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6
                found = volume(read.points, cells[part]) if order == "2" else found
                exact = math.pi * 20 * (1 if name == "lumen" else 1.2**2 - 1)
                print(f" {name} {100 * (found / exact - 1):+.2f} %", end="")
            print()


def main():
    program, networks = Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tube = folder / "tube.swc"
        tube.write_text(TUBE)
        for rho in ("2.5", "3", "4", "6"):
            compare(program, tube, folder, math.pi * 20, rho)
        regions(program, tube, folder)
        for network in networks:
            compare(program, network, folder)


main()
