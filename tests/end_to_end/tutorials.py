#!/usr/bin/env python3
"""Runs the commands of a tutorial: all blocks between ```sh and ```, in the order of the page, and checks that each line of a block
```text after them stands in their output.

usage: tutorials.py PAGE BRICKWALL SOURCE

The commands run in a folder that looks like a fresh clone with a finished build; run.sh uses one thread. Exit code 77: the program of
the page's line "Debian package: `NAME`" is not installed.
"""
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile


def squeezed(text):
    return " ".join(text.split())


def main():
    page, program, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    text = page.read_text()
    for package in re.findall(r"^Debian package: `(.*?)`", text, re.MULTILINE):
        if not shutil.which(package):
            print(f"{package} is not installed")
            return 77
    blocks = re.findall(r"^```(sh|text)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert any(kind == "sh" for kind, _ in blocks), f"{page} has no commands"
    with tempfile.TemporaryDirectory() as name:
        folder, output = pathlib.Path(name), ""
        for entry in ("inputs", "miniapp"):
            (folder / entry).symlink_to(source / entry)
        (folder / "build").symlink_to(program.parent.parent)
        run_sh = folder / "run.sh"
        run_sh.write_text(f"exec {shlex.quote(str(source / 'run.sh'))} \"$@\" -t 1 --program {shlex.quote(str(program))}\n")
        run_sh.chmod(0o755)
        for kind, block in blocks:
            if kind == "sh":
                result = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, capture_output=True, text=True)
                output = result.stdout + result.stderr  # one after the other: mpiexec may mix both within a line
                print(block + output)
                assert result.returncode == 0, f"exit code {result.returncode} of\n{block}"
            else:
                lines = {squeezed(line) for line in output.splitlines()}
                for line in block.splitlines():
                    assert squeezed(line) in lines, f"{page} has the line\n{line}\nwhich the commands before it did not print"
    return 0


if __name__ == "__main__":
    sys.exit(main())
