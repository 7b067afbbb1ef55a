#!/usr/bin/env python3
"""headers_test.py BUILD: compiles every header by itself, with the flags of the build. Headers whose own
includes lead to Kokkos get it precompiled, as in the build; the others do not see it."""
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

root = Path(__file__).resolve().parents[2]
build = Path(sys.argv[1])

# Compiler and flags: those of a unit that sees every folder, without its optimisation and its own files.
words = next(shlex.split(unit["command"]) for unit in json.loads((build / "compile_commands.json").read_text())
             if unit["file"].endswith("miniapp/output/report.cpp"))
compiler = [word for word in words[:words.index("-o")] if not re.match("-O|-g", word)]


def reaches_kokkos(header, seen):
    if header in seen or not (root / header).exists():
        return False
    seen.add(header)
    text = (root / header).read_text()
    return "#include <Kokkos_" in text or any(
        reaches_kokkos(included, seen) for included in re.findall(r'^#include "([^"]+)"', text, re.MULTILINE))


def compile_alone(header):
    seen = []
    if reaches_kokkos(header, set()):
        seen = ["-include", precompiled]
    command = [*compiler, *seen, "-fsyntax-only", "-x", "c++", "-"]
    run = subprocess.run(command, input=f'#include "{header}"\n', text=True, capture_output=True, cwd=root)
    return "" if run.returncode == 0 else f"{header} does not compile by itself:\n{run.stderr}"


folders = [root / folder for folder in ("contact", "mechanics", "io", "miniapp")]
headers = sorted(str(path.relative_to(root)) for folder in folders for path in folder.rglob("*.hpp"))
with tempfile.TemporaryDirectory() as folder:
    precompiled = f"{folder}/kokkos.hpp"
    Path(precompiled).write_text("#include <Kokkos_Core.hpp>\n")
    subprocess.run([*compiler, "-x", "c++-header", precompiled, "-o", precompiled + ".gch"], check=True)
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        faults = list(filter(None, pool.map(compile_alone, headers)))
print("\n".join(faults) or f"{len(headers)} headers compile by themselves")
sys.exit(1 if faults else 0)
