#!/usr/bin/env python3
"""Runs decks and compares the checksums of nodes and contacts with those of other machines: all processors, numbers of SIMD lanes and
GPUs must give the same. Those below are of a Zen 3 with 4 SIMD lanes and with 8 (061e57c0), the second of a Xeon with 8 (2026-11-29).

usage: known_bits.py BRICKWALL SOURCE

A change of the program that changes bits on purpose renews the checksums and says so in CHANGELOG.md. Otherwise a compiler or a back
end does not do what the others do: `--checksums` on both tells the first part of a step that differs.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

SCENES = [  # deck, options, checksums
    ("inputs/brick_wall.toml", ["--steps", "120", "--set", "search.reuse.margin=0"],
     {"nodes": "7c0463478d8742a9", "contacts": "19129055f020872d", "interactions": 7436}),
    ("tests/end_to_end/struck_bricks.toml", ["--steps", "60"],
     {"nodes": "5b8f24502cd53b39", "contacts": "efe56b8c00198362", "interactions": 801}),
    ("tests/end_to_end/free_bricks.toml", ["--steps", "60"],
     {"nodes": "650b5cc80de60e8b", "contacts": "0000000000000000", "interactions": 0}),
]


def main():
    program, source = sys.argv[1], pathlib.Path(sys.argv[2])
    differ = 0
    for deck, options, expected in SCENES:
        with tempfile.TemporaryDirectory() as folder:
            command = [program, "run", str(source / deck), *options, "--set", "output.history_interval=1e9", "-o", folder]
            result = subprocess.run(command, capture_output=True, text=True)
            assert result.returncode == 0, f"exit code {result.returncode} of {' '.join(command)}\n{result.stdout}{result.stderr}"
            found = json.loads((pathlib.Path(folder) / "report.json").read_text())["checksums"]
        print(f"{deck} {' '.join(options)}: found {found}, expected {expected}")
        differ += found != expected
    return differ > 0


if __name__ == "__main__":
    sys.exit(main())
