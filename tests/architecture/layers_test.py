#!/usr/bin/env python3
"""Compares the source tree with layers.txt: includes follow its arrows and form no circle, folders and
files stay small, and headers launch functors: with g++ 12, nvcc mixes up the lambdas that an inline
function has in several source files."""
import re
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

MAX_SOURCES_IN_FOLDER = 24
MAX_LINES_IN_FILE = 400

root = Path(__file__).resolve().parents[2]
faults = []

# The table: all folders that a folder reaches. A folder names only folders above it, so they form no circle.
reachable = {}
exceptions = set()
for line in (Path(__file__).parent / "layers.txt").read_text().splitlines():
    line = line.split("#")[0].strip()
    if line.startswith("except "):
        exceptions.add(tuple(line.split()[1:]))
    elif line:
        folder, _, named = line.partition(":")
        faults += [f"layers.txt: {folder} names {name}, which does not stand above it"
                   for name in named.split() if name not in reachable]
        reachable[folder] = {folder}.union(*(reachable.get(name, set()) for name in named.split()))

unneeded = set(exceptions)


def report(fault, *place):
    unneeded.discard(place)
    if place not in exceptions:
        faults.append(f"{place[0]}: {fault}")


includes = {}  # file -> its own headers
folders = {}  # folder -> number of source files
for path in sorted(p for folder in ("contact", "mechanics", "io", "miniapp", "tests", "verification")
                   for p in (root / folder).rglob("*.[ch]pp")):
    file = str(path.relative_to(root))
    folder = str(Path(file).parent)
    text = path.read_text()
    includes[file] = re.findall(r'^\s*#\s*include\s+"([^"]+)"', text, re.MULTILINE)
    folders[folder] = folders.get(folder, 0) + 1
    if text.count("\n") > MAX_LINES_IN_FILE:
        report(f"more than {MAX_LINES_IN_FILE} lines", file)
    if folder.startswith(("tests", "verification")):
        continue
    if file.endswith(".hpp") and "KOKKOS_LAMBDA" in text:
        report("a header launches a KOKKOS_LAMBDA, expected a functor", file, "KOKKOS_LAMBDA")
    for header in includes[file]:
        if str(Path(header).parent) not in reachable.get(folder, set()):
            report(f"includes {header}, which layers.txt does not allow to {folder}", file, header)

try:
    TopologicalSorter(includes).prepare()
except CycleError as circle:
    faults.append("circle of includes: " + " -> ".join(circle.args[1]))
faults += [f"{folder}: {number} source files, more than {MAX_SOURCES_IN_FOLDER}"
           for folder, number in folders.items() if number > MAX_SOURCES_IN_FOLDER]
faults += [f"layers.txt: the exception {' '.join(place)} is not needed" for place in sorted(unneeded)]

print("\n".join(faults) or f"{len(includes)} source files in {len(reachable)} folders follow layers.txt")
sys.exit(1 if faults else 0)
