#!/usr/bin/env python3
"""The same command with two builds of the program: are all files equal, byte by byte?

    python3 benches/platforms.py target/release/anastomesh "qemu-aarch64 PATH/anastomesh" [--limit 600]

Each program may be a command with arguments, such as an emulator. Prints a row per case. The exit code is 1 if a file or an exit
code differs.
"""

import argparse
import filecmp
import pathlib
import shlex
import subprocess
import sys
import tempfile

FIXTURES = pathlib.Path(__file__).resolve().parent.parent / "fixtures"

#: Command lines, without the output, and its extension.
CASES = [
    ("mesh tree_30.vtp", "vtu"),
    ("mesh tree_30.swc --rho 4 --layers 3", "vtu"),
    ("mesh tree_30.swc --stretch 4", "msh"),
    ("mesh tree_30.swc --joint woven", "vtu"),
    ("mesh measured.swc --refine", "vtu"),
    ("mesh crotch.vtp --wall 0.2r --tissue box", "vtu"),
    ("mesh crotch.vtp --order 2", "vtu"),
    ("mesh tree_30.swc --embed --tissue box", "vtu"),
    ("surface tree_30.vtp", "stl"),
    ("refine measured.swc", "vtp"),
    ("generate --terminals 200 --seed 3", "vtp"),
    ("tetrahedralize torus.off", "vtu"),
    ("tetrahedralize torus.off --remesh-surface --size 0.2", "vtu"),
    ("tetrahedralize torus.off --layers 2", "ele"),
    ("tetrahedralize box.poly --min-dihedral 15 --split", "msh"),
]


def made(program, line, output, limit):
    """Exit code; none beyond the limit."""
    words = [str(FIXTURES / word) if (FIXTURES / word).is_file() else word for word in line.split()]
    command = [*shlex.split(program), *words, "-o", str(output), "-q"]
    try:
        return subprocess.run(command, timeout=limit, capture_output=True, check=False).returncode
    except subprocess.TimeoutExpired:
        return None


def files(folder):
    """Names of all files in a folder, in order."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs=2)
    parser.add_argument("--limit", type=float, default=600)
    options = parser.parse_args()
    differs = False
    print("| case | exit codes | files | differ |\n|---|---|---|---|")
    for line, extension in CASES:
        with tempfile.TemporaryDirectory() as scratch:
            folders = [pathlib.Path(scratch) / name for name in "ab"]
            codes = []
            for program, folder in zip(options.programs, folders, strict=True):
                folder.mkdir()
                codes.append(made(program, line, folder / f"out.{extension}", options.limit))
            names = files(folders[0])
            wrong = sorted(set(names) ^ set(files(folders[1])))
            both = [name for name in names if name not in wrong]
            wrong += [name for name in both if not filecmp.cmp(*(folder / name for folder in folders), shallow=False)]
        differs |= bool(wrong) or codes[0] != codes[1] or None in codes
        print(f"| `{line}` | {codes[0]}, {codes[1]} | {len(names)} | {', '.join(wrong) or 'none'} |", flush=True)
    sys.exit(differs)


if __name__ == "__main__":
    main()
