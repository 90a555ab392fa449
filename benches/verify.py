"""Differential test of both checkers: `anastomesh check` and `anastomesh-verify` on meshes that are broken at random.

    cargo build -p anastomesh-verify
    python3 benches/verify.py [--program PATH] [--verifier PATH] [--count N] [--seconds T] [--seed S] [--jobs N]
        [--keep DIR] [--only MUTATION]

Each mesh is a small sound one (boxes, tubes with caps, rings, shells, parts, random cells), turned and scaled, with one
mutation, in one of the formats that both programs read. The table has a row per mutation: meshes, both valid, both not
valid, verdicts that differ, and meshes with the same violated conditions. `check` refuses coordinates beyond the range of
its predicates, and the second checker has no such limit: these meshes have a column of their own. Meshes whose verdicts
differ are listed with their seed. The exit code is 1 if any verdict differs.
"""

import argparse
import base64
import json
import math
import random
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SIDES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))
KUHN = ((0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7))
# Meshes per call of the verifier.
BATCH = 100


class Mesh:
    """Points, tetrahedra, labelled triangles, and what a file of `mesh` says about them."""

    def __init__(self):
        self.points, self.tets, self.triangles, self.labels = [], [], [], []
        self.names, self.caps, self.loops, self.terminals = [], [], None, None

    def label(self, patch=lambda corners: 1):
        faces = defaultdict(list)
        for t in self.tets:
            for side in SIDES:
                face = tuple(t[i] for i in side)
                faces[tuple(sorted(face))].append(face)
        self.triangles = [f[0] for f in faces.values() if len(f) == 1]
        self.labels = [patch([self.points[v] for v in f]) for f in self.triangles]
        self.names = self.names or [(1, "wall")]

    def add(self, other, move):
        count = len(self.points)
        self.points += [move(p) for p in other.points]
        self.tets += [[v + count for v in t] for t in other.tets]


def cells(has, size, position=lambda p: [float(x) for x in p], period=None):
    """Tetrahedra of the selected cells of a lattice."""
    mesh, number = Mesh(), {}

    def vertex(p):
        p = (p[0] % period, p[1], p[2]) if period else p
        if p not in number:
            number[p] = len(mesh.points)
            mesh.points.append(position(p))
        return number[p]

    for i in range(size[0]):
        for j in range(size[1]):
            for k in range(size[2]):
                if has(i, j, k):
                    corner = [vertex((i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))) for c in range(8)]
                    mesh.tets += [[corner[c] for c in t] for t in KUHN]
    return mesh


def tube(rng):
    """Tube with caps, as of a network of two nodes."""
    mesh, n, levels = Mesh(), rng.randint(14, 20), rng.randint(2, 4)
    for k in range(levels + 1):
        mesh.points.append([0.0, 0.0, float(k)])
        mesh.points += [[math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), float(k)] for i in range(n)]
    for k in range(levels):
        low, high = k * (n + 1), (k + 1) * (n + 1)
        for i in range(n):
            a, b = 1 + i, 1 + (i + 1) % n
            flip = a > b
            a, b = min(a, b), max(a, b)
            for t in ((low, low + a, low + b, high + b), (low, low + a, high + b, high + a), (low, high + a, high + b, high)):
                mesh.tets.append([t[0], t[2], t[1], t[3]] if flip else list(t))
    mesh.names = [(1, "wall"), (2, "inlet"), (3, "outlet_0")]
    mesh.label(lambda c: 2 if all(p[2] == 0 for p in c) else 3 if all(p[2] == levels for p in c) else 1)
    mesh.caps = [[2, 0, [0.0, 0.0, 0.0], [0.0, 0.0, -1.0], 1.0], [3, 1, [0.0, 0.0, float(levels)], [0.0, 0.0, 1.0], 1.0]]
    mesh.loops, mesh.terminals = [0], [0, 1]
    return mesh


def ring(rng, turns=1):
    n = 8
    tall = rng.randint(1, 2)
    around = lambda p: 2 * math.pi * p[0] / n
    position = lambda p: [(3 - 0.5 * p[1]) * math.cos(around(p)), (3 - 0.5 * p[1]) * math.sin(around(p)), 0.5 * p[2]]
    mesh = cells(lambda i, j, k: True, (n * turns, 2, tall), position, n * turns)
    mesh.label()
    mesh.loops, mesh.terminals = ([1], []) if rng.random() < 0.5 else (None, None)
    return mesh


def box(rng):
    mesh = cells(lambda i, j, k: True, [rng.randint(1, 3) for _ in range(3)])
    mesh.label()
    mesh.loops, mesh.terminals = ([0], []) if rng.random() < 0.5 else (None, None)
    return mesh


def shell(rng):
    """Cube with a cavity, sometimes with a cube inside it."""
    mesh = cells(lambda i, j, k: (i, j, k) != (1, 1, 1), (3, 3, 3))
    if rng.random() < 0.5:
        mesh.add(cells(lambda i, j, k: True, (1, 1, 1)), lambda p: [1.25 + 0.5 * x for x in p])
    mesh.label()
    return mesh


def scattered(rng):
    """Cells at random: they touch at edges and vertices, and enclose cavities and loops."""
    share = rng.choice((0.3, 0.6, 0.85, 0.95))
    chosen = {(i, j, k) for i in range(3) for j in range(3) for k in range(3) if rng.random() < share} or {(0, 0, 0)}
    mesh = cells(lambda i, j, k: (i, j, k) in chosen, (3, 3, 3))
    mesh.label()
    return mesh


BASES = (box, tube, tube, tube, ring, shell, scattered)


def transform(mesh, rng):
    """Moves inner details, turns and scales the mesh with its caps."""
    kind = rng.random()
    scale = 1.0 if kind < 0.6 else 10.0 ** rng.randint(-12, 12)
    if rng.random() < 0.5:
        a, b = rng.uniform(0, 6), rng.uniform(0, 6)
        turn = lambda p: [
            math.cos(a) * p[0] - math.sin(a) * p[1],
            math.cos(b) * (math.sin(a) * p[0] + math.cos(a) * p[1]) - math.sin(b) * p[2],
            math.sin(b) * (math.sin(a) * p[0] + math.cos(a) * p[1]) + math.cos(b) * p[2],
        ]
    else:
        turn = list
    mesh.points = [[scale * x for x in turn(p)] for p in mesh.points]
    mesh.caps = [[c[0], c[1], [scale * x for x in turn(c[2])], turn(c[3]), scale * c[4]] for c in mesh.caps]
    return mesh


def extent(mesh):
    return max(abs(x) for p in mesh.points for x in p) or 1.0


def m_none(mesh, rng):
    pass


def m_swap(mesh, rng):
    t = rng.choice(mesh.tets)
    i, j = rng.sample(range(4), 2)
    t[i], t[j] = t[j], t[i]


def m_remove(mesh, rng):
    for _ in range(rng.choice((1, 1, 3))):
        if len(mesh.tets) > 1:
            mesh.tets.pop(rng.randrange(len(mesh.tets)))
    if rng.random() < 0.5:
        mesh.label()


def m_duplicate(mesh, rng):
    mesh.tets.insert(rng.randrange(len(mesh.tets)), rng.sample(rng.choice(mesh.tets), 4))


def m_repeat(mesh, rng):
    t = rng.choice(mesh.tets)
    i, j = rng.sample(range(4), 2)
    t[i] = t[j]


def m_other_vertex(mesh, rng):
    rng.choice(mesh.tets)[rng.randrange(4)] = rng.randrange(len(mesh.points))


def m_out_of_range(mesh, rng):
    rng.choice(mesh.tets)[rng.randrange(4)] = len(mesh.points) + rng.choice((0, 1, 1000))


def m_move(mesh, rng):
    p = rng.choice(mesh.points)
    by = extent(mesh) * rng.choice((2.0, 0.5, 0.1, 1e-3, 1e-9, 1e-15))
    for k in range(3):
        p[k] += by * rng.uniform(-1, 1)


def m_flatten(mesh, rng):
    """A vertex is moved to the middle of two vertices of its tetrahedron, exactly or almost."""
    a, b, c, d = (mesh.points[v] for v in rng.sample(rng.choice(mesh.tets), 4))
    for k in range(3):
        a[k] = rng.choice((0.5 * b[k] + 0.5 * c[k], 0.5 * b[k] + 0.25 * c[k] + 0.25 * d[k]))


def m_not_finite(mesh, rng):
    rng.choice(mesh.points)[rng.randrange(3)] = rng.choice((math.nan, math.inf, -math.inf))


def m_huge(mesh, rng):
    rng.choice(mesh.points)[rng.randrange(3)] = rng.choice((1e300, 1e59, -1e57, 1e30, 1e20))


def m_scale(mesh, rng):
    factor = 10.0 ** rng.choice((-300, -100, -40, -30, -25, -20, -15, 15, 20, 30, 40, 45, 50, 60, 100, 290))
    mesh.points = [[factor * x for x in p] for p in mesh.points]
    mesh.caps = [[c[0], c[1], [factor * x for x in c[2]], c[3], factor * c[4]] for c in mesh.caps]


def m_glue(mesh, rng):
    """Two vertices become one, everywhere or in the tetrahedra alone."""
    a, b = rng.sample(range(len(mesh.points)), 2)
    mesh.tets = [[a if v == b else v for v in t] for t in mesh.tets]
    if rng.random() < 0.5:
        mesh.triangles = [tuple(a if v == b else v for v in t) for t in mesh.triangles]


def m_same_place(mesh, rng):
    a, b = rng.sample(range(len(mesh.points)), 2)
    mesh.points[a] = list(mesh.points[b])


def m_split_vertex(mesh, rng):
    """Some tetrahedra at a vertex take a copy of it."""
    v = rng.randrange(len(mesh.points))
    mesh.points.append(list(mesh.points[v]))
    for t in mesh.tets:
        if v in t and rng.random() < 0.5:
            t[t.index(v)] = len(mesh.points) - 1


def m_touch(mesh, rng):
    """A copy beside the mesh touches it at a vertex, by vertices of its own or by shared ones."""
    a, b = rng.choice(mesh.triangles)[0], rng.choice(mesh.triangles)[0]
    shift = [x - y for x, y in zip(mesh.points[a], mesh.points[b])]
    copy = Mesh()
    copy.points, copy.tets = [list(p) for p in mesh.points], [list(t) for t in mesh.tets]
    count = len(mesh.points)
    mesh.add(copy, lambda p: [x + s for x, s in zip(p, shift)])
    if rng.random() < 0.5:
        mesh.tets = [[a if v == count + b else v for v in t] for t in mesh.tets]
        mesh.points.pop(count + b)
        mesh.tets = [[v - 1 if v > count + b else v for v in t] for t in mesh.tets]
    mesh.label()


def m_overlap(mesh, rng):
    """A smaller or equal copy overlaps the mesh, lies inside it, or apart."""
    center = [sum(p[k] for p in mesh.points) / len(mesh.points) for k in range(3)]
    factor, by = rng.choice((1e-3, 0.1, 0.5, 1.0)), [extent(mesh) * rng.uniform(-2, 2) * rng.choice((0.1, 1, 3)) for _ in range(3)]
    copy = Mesh()
    copy.points, copy.tets = [list(p) for p in mesh.points], [list(t) for t in mesh.tets]
    mesh.add(copy, lambda p: [c + factor * (x - c) + b for x, c, b in zip(p, center, by)])
    mesh.label()
    if mesh.loops is not None:
        mesh.loops = mesh.loops * 2


def m_twice_around(mesh, rng):
    other = ring(rng, turns=2)
    mesh.__dict__.update(other.__dict__)


def m_unused(mesh, rng):
    mesh.points.append([extent(mesh) * rng.uniform(-1, 1) for _ in range(3)])


def m_label_lost(mesh, rng):
    i = rng.randrange(len(mesh.triangles))
    mesh.triangles.pop(i)
    mesh.labels.pop(i)


def m_label_added(mesh, rng):
    t = rng.choice(mesh.tets)
    face = rng.choice((tuple(t[i] for i in rng.choice(SIDES)), rng.choice(mesh.triangles), (0, 1, 2)))
    mesh.triangles.append(face)
    mesh.labels.append(1)


def m_label_reversed(mesh, rng):
    i = rng.randrange(len(mesh.triangles))
    mesh.triangles[i] = mesh.triangles[i][::-1]


def m_label_other(mesh, rng):
    for _ in range(rng.choice((1, 3))):
        mesh.labels[rng.randrange(len(mesh.labels))] = rng.choice((1, 2, 3, 9, 0))


def m_names(mesh, rng):
    i = rng.randrange(len(mesh.names))
    mesh.names[i] = (mesh.names[i][0], rng.choice((mesh.names[0][1], "outlet_7", mesh.names[-1][1])))


def m_cap(mesh, rng):
    if mesh.caps:
        cap, what = rng.choice(mesh.caps), rng.randrange(5)
        if what < 2:
            cap[what] = rng.randint(0, 4)
        elif what == 2:
            cap[2][rng.randrange(3)] += cap[4] * rng.choice((0.05, 0.2, 1e-3))
        elif what == 3:
            cap[3] = rng.choice(([-x for x in cap[3]], [1.0, 0.0, 0.0], [x + 1e-6 for x in cap[3]]))
        else:
            cap[4] *= rng.choice((1.01, 1.2, 0.9))


def m_cap_bent(mesh, rng):
    """A vertex of a cap leaves its plane by a little."""
    if mesh.caps:
        cap = rng.choice(mesh.caps)
        faces = [t for t, label in zip(mesh.triangles, mesh.labels) if label == cap[0]]
        p, by = mesh.points[rng.choice(rng.choice(faces))], cap[4] * rng.choice((1e-6, 1e-8, 3e-9, 1.5e-9, 5e-10, 1e-12))
        for k in range(3):
            p[k] += by * cap[3][k]


def m_expected(mesh, rng):
    mesh.loops = rng.choice(([0], [1], [2], [0, 0], []))
    mesh.terminals = rng.choice(([], [0], [0, 1], [0, 1, 1], [1, 2])) if rng.random() < 0.5 else mesh.terminals or []


def m_rounded(mesh, rng):
    """Coordinates of 32 bits."""
    mesh.points = [[struct.unpack("f", struct.pack("f", x))[0] for x in p] for p in mesh.points]


def m_snap(mesh, rng):
    """A boundary vertex is moved onto a boundary face, edge or vertex."""
    p = mesh.points[rng.choice(rng.choice(mesh.triangles))]
    a, b, c = (mesh.points[v] for v in rng.choice(mesh.triangles))
    u, v, w = rng.choice(((0.5, 0.25, 0.25), (0.5, 0.5, 0.0), (1.0, 0.0, 0.0), (-0.5, 0.75, 0.75)))
    p[:] = [u * a[k] + v * b[k] + w * c[k] for k in range(3)]


MUTATIONS = {name[2:]: f for name, f in list(globals().items()) if name.startswith("m_")}


def write_vtu(mesh, path, rng):
    encoding = rng.choice(("ascii", "binary", "appended", "zlib"))
    appended = b""
    out = []

    def array(kind, name, numbers, extra=""):
        nonlocal appended
        head = f'<DataArray type="{kind}" Name="{name}"{extra} '
        if encoding == "ascii":
            out.append(head + 'format="ascii">' + " ".join(map(repr, numbers)) + "</DataArray>")
            return
        letter = {"Float64": "d", "Int64": "q", "Int32": "i", "UInt8": "B"}[kind]
        data = struct.pack(f"<{len(numbers)}{letter}", *numbers)
        if encoding == "binary":
            text = base64.b64encode(struct.pack("<Q", len(data)) + data).decode()
            out.append(head + f'format="binary">{text}</DataArray>')
            return
        out.append(head + f'format="appended" offset="{len(appended)}"/>')
        if encoding == "appended":
            appended += struct.pack("<Q", len(data)) + data
        else:
            size = 256
            blocks = [zlib.compress(data[i : i + size]) for i in range(0, len(data), size)]
            appended += struct.pack("<QQQ", len(blocks), size, len(data) % size) + b"".join(struct.pack("<Q", len(b)) for b in blocks)
            appended += b"".join(blocks)

    flat = lambda rows: [x for row in rows for x in row]
    compressor = ' compressor="vtkZLibDataCompressor"' if encoding == "zlib" else ""
    out.append(f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64"{compressor}>')
    out.append("<UnstructuredGrid><FieldData>")
    names = dict(mesh.names)
    array("UInt8", "patch_names", b"".join(names.get(i, "lumen" if i == 0 else "").encode() + b"\0" for i in range(max(names) + 1)))
    if mesh.caps:
        array("Int64", "cap_patch", [c[0] for c in mesh.caps])
        array("Int64", "cap_node", [c[1] for c in mesh.caps])
        array("Float64", "cap_center", flat(c[2] for c in mesh.caps), ' NumberOfComponents="3"')
        array("Float64", "cap_normal", flat(c[3] for c in mesh.caps), ' NumberOfComponents="3"')
        array("Float64", "cap_radius", [c[4] for c in mesh.caps])
    if mesh.loops is not None:
        array("Int64", "expected_loops", mesh.loops)
        array("Int64", "expected_terminals", mesh.terminals)
    count = len(mesh.tets) + len(mesh.triangles)
    out.append(f'</FieldData><Piece NumberOfPoints="{len(mesh.points)}" NumberOfCells="{count}"><Points>')
    array("Float64", "Points", flat(mesh.points), ' NumberOfComponents="3"')
    out.append("</Points><Cells>")
    array("Int32", "connectivity", flat(mesh.tets) + flat(mesh.triangles))
    ends = [4 * (i + 1) for i in range(len(mesh.tets))]
    array("Int32", "offsets", ends + [4 * len(mesh.tets) + 3 * (i + 1) for i in range(len(mesh.triangles))])
    array("UInt8", "types", [10] * len(mesh.tets) + [5] * len(mesh.triangles))
    out.append("</Cells><CellData>")
    array("Int32", "patch", [0] * len(mesh.tets) + mesh.labels)
    out.append("</CellData></Piece></UnstructuredGrid>")
    text = "\n".join(out).encode()
    if appended:
        text += b'<AppendedData encoding="raw">_' + appended + b"</AppendedData>"
    path.write_bytes(text + b"</VTKFile>\n")


def notes(mesh):
    if mesh.loops is None:
        return ""
    caps = [dict(zip(("patch", "node", "center", "normal", "radius"), c)) for c in mesh.caps]
    record = {"generator": "verify.py", "options": "", "loops": mesh.loops, "terminals": mesh.terminals, "caps": caps}
    return f"$Anastomesh\n{json.dumps(record)}\n$EndAnastomesh\n"


def names(mesh):
    rows = "".join(f'2 {i} "{name}"\n' for i, name in mesh.names)
    return f'$PhysicalNames\n{len(mesh.names) + 1}\n{rows}3 99 "lumen"\n$EndPhysicalNames\n'


def write_msh2(mesh, path, rng):
    out = [f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{names(mesh)}$Nodes\n{len(mesh.points)}"]
    out += [f"{i + 1} {p[0]!r} {p[1]!r} {p[2]!r}" for i, p in enumerate(mesh.points)]
    out.append(f"$EndNodes\n$Elements\n{len(mesh.triangles) + len(mesh.tets)}")
    rows = [f"2 2 {label} {label} " + " ".join(str(v + 1) for v in t) for t, label in zip(mesh.triangles, mesh.labels)]
    rows += ["4 2 99 1 " + " ".join(str(v + 1) for v in t) for t in mesh.tets]
    out += [f"{i + 1} {row}" for i, row in enumerate(rows)]
    path.write_text("\n".join(out) + f"\n$EndElements\n{notes(mesh)}")


def write_msh4(mesh, path, rng):
    s, labels = struct.pack, sorted(set(mesh.labels))
    out = f"$MeshFormat\n4.1 1 8\n".encode() + s("<i", 1) + f"\n$EndMeshFormat\n{names(mesh)}$Entities\n".encode()
    out += s("<4Q", 0, 0, len(labels), 1)
    for label in labels:
        out += s("<i6dQiQ", label, *[0.0] * 6, 1, label, 0)
    out += s("<i6dQiQ", 1, *[0.0] * 6, 1, 99, 0) + b"\n$EndEntities\n$Nodes\n"
    n = len(mesh.points)
    out += s("<4Q", 1, n, 1, n) + s("<3iQ", 3, 1, 0, n) + s(f"<{n}Q", *range(1, n + 1))
    out += b"".join(s("<3d", *p) for p in mesh.points) + b"\n$EndNodes\n$Elements\n"
    total = len(mesh.triangles) + len(mesh.tets)
    out += s("<4Q", len(labels) + 1, total, 1, total)
    number = 0
    for label in labels:
        own = [t for t, other in zip(mesh.triangles, mesh.labels) if other == label]
        out += s("<3iQ", 2, label, 2, len(own))
        for t in own:
            number += 1
            out += s("<4Q", number, *(v + 1 for v in t))
    out += s("<3iQ", 3, 1, 4, len(mesh.tets))
    for t in mesh.tets:
        number += 1
        out += s("<5Q", number, *(v + 1 for v in t))
    path.write_bytes(out + f"\n$EndElements\n{notes(mesh)}".encode())


def write_tetgen(mesh, path, rng):
    first = rng.choice((0, 1))
    row = lambda i, t: f"{i + first} " + " ".join(map(str, t)) + "\n"
    up = lambda t: [v + first for v in t]
    path.with_suffix(".node").write_text(f"{len(mesh.points)} 3 0 0\n" + "".join(row(i, map(repr, p)) for i, p in enumerate(mesh.points)))
    path.write_text(f"{len(mesh.tets)} 4 0\n" + "".join(row(i, up(t)) for i, t in enumerate(mesh.tets)))
    faces = zip(mesh.triangles, mesh.labels)
    path.with_suffix(".face").write_text(f"{len(mesh.triangles)} 1\n" + "".join(row(i, [*up(t), label]) for i, (t, label) in enumerate(faces)))


FORMATS = ((".vtu", write_vtu), (".vtu", write_vtu), (".msh", write_msh4), (".msh", write_msh2), (".ele", write_tetgen))


def make(seed, folder, only):
    """Writes the mesh of a seed; returns its path and mutation."""
    rng = random.Random(seed)
    mutation = only or rng.choice(list(MUTATIONS))
    mesh = transform(rng.choice(BASES)(rng), rng)
    MUTATIONS[mutation](mesh, rng)
    extension, write = rng.choice(FORMATS)
    path = folder / f"{seed}_{mutation}{extension}"
    write(mesh, path, rng)
    return path, mutation


def checked(program, path):
    """Violated conditions by `anastomesh check`; None if it refuses the file."""
    run = subprocess.run([program, "check", "--json", "-j", "1", path], capture_output=True, text=True)
    if run.returncode not in (0, 1):
        return None if run.returncode == 3 else {f"exit {run.returncode}: {run.stderr.strip()[-200:]}"}
    return {line["line"] for line in json.loads(run.stdout)["lines"] if line["outcome"] == "fail"}


def verified(verifier, paths):
    """Violated conditions by the second checker; None for files that it refuses."""
    run = subprocess.run([verifier, "--json", *paths], capture_output=True, text=True)
    results = {}
    for line in run.stdout.splitlines():
        found = json.loads(line)
        wrong = {c["name"] for c in found.get("conditions", []) if c["violations"]}
        results[found["file"]] = None if "error" in found else {"no_self_intersection" if c == "no_nesting" else c for c in wrong}
    return [results.get(str(path), {"no answer: " + run.stderr[-200:]}) for path in paths]


def verdict(conditions):
    return "refused" if conditions is None else "not valid" if conditions else "valid"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/debug/anastomesh")
    parser.add_argument("--verifier", default="target/debug/anastomesh-verify")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=math.inf, help="stop after this time")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--only", choices=sorted(MUTATIONS))
    args = parser.parse_args()
    rows, pairs, listed = defaultdict(Counter), Counter(), []
    end = time.monotonic() + args.seconds
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(args.jobs) as pool:
        folder = Path(folder)
        for start in range(args.seed, args.seed + args.count, BATCH):
            if time.monotonic() > end:
                break
            made = [make(seed, folder, args.only) for seed in range(start, min(start + BATCH, args.seed + args.count))]
            paths = [path for path, _ in made]
            first = pool.map(lambda path: checked(args.program, path), paths)
            second = verified(args.verifier, paths)
            for (path, mutation), a, b in zip(made, first, second):
                row = rows[mutation]
                row["meshes"] += 1
                is_far = a == {"finite_points"} and mutation in ("scale", "huge") and b is not None
                differs = (a == set()) != (b == set()) and not is_far
                row["differ" if differs else "beyond range" if is_far else "valid" if a == set() else "not valid"] += 1
                row["same conditions"] += a == b
                if a != b and not differs and not is_far:
                    only = lambda x, y: " ".join(sorted(x - y)) if None not in (x, y) else verdict(x)
                    pairs[f"{mutation} {path.suffix}: check: {only(a, b) or '-'}; verify: {only(b, a) or '-'}"] += 1
                if differs:
                    listed.append(f"{path.name}: check: {verdict(a)} {sorted(a or [])}; verify: {verdict(b)} {sorted(b or [])}")
                for file in folder.glob(f"{path.stem}.*"):
                    if differs and args.keep:
                        args.keep.mkdir(parents=True, exist_ok=True)
                        (args.keep / file.name).write_bytes(file.read_bytes())
                    file.unlink()
    columns = ("meshes", "valid", "not valid", "beyond range", "differ", "same conditions")
    print("| mutation | " + " | ".join(columns) + " |")
    print("|---|" + "---|" * len(columns))
    for mutation in sorted(rows):
        print(f"| {mutation} | " + " | ".join(str(rows[mutation][c]) for c in columns) + " |")
    total = {c: sum(row[c] for row in rows.values()) for c in columns}
    print("| all | " + " | ".join(str(total[c]) for c in columns) + " |")
    print("\nconditions that only one program names, with equal verdicts:")
    for text, count in pairs.most_common(40):
        print(f"{count:6} {text}")
    print("\nverdicts that differ:", *(listed or ["none"]), sep="\n")
    return 1 if total["differ"] else 0


if __name__ == "__main__":
    sys.exit(main())
