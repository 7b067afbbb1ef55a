#!/usr/bin/python3
"""What the areas of flush joints cost in enforcement: `/usr/bin/python3 verification/accuracy/joint_cost.py
[--turns N]` (1 minute; needs a machine with nothing else running).

Two blocks of case V6 with 36 x 36 and 48 x 48 elements at the joint and 4 layers, pressed together;
once flush, and once with the upper block 3e-4 faces higher, where contacts have tributary areas. In
turns, with the same steps; the least time of each counts.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE.parent), str(ROOT / "miniapp/plot"), str(ROOT / "miniapp/study")]
from framework.meshes import box, together
from framework.program import Program

LOWER, UPPER, LAYERS = 36, 48, 4
STEPS = 258


def blocks(gap):
    return together(*(box((1, 1, LAYERS / n), (n, n, LAYERS), (0, 0, low), name)
                      for n, low, name in ((LOWER, 0, "lower"), (UPPER, LAYERS / LOWER + gap, "upper"))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=12)
    parser.add_argument("--program", type=Path, default=ROOT / "build/miniapp/brickwall")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "out/joint_cost")
    arguments = parser.parse_args()
    program = Program(ROOT / "run.sh", arguments.program)
    settings = {"time.steps": STEPS}
    seconds, contacts = {}, {}
    for _ in range(arguments.turns):
        for name, gap in (("areas of the joint", 0.0), ("tributary areas", 3e-4 / LOWER)):
            run = program.run(ROOT / "verification/decks/v06_contact_patch.toml", arguments.output / name.replace(" ", "_"), settings, mesh=blocks(gap))
            phases = {phase["name"]: phase["max"] for phase in run.report["phases"]}
            seconds.setdefault(name, []).append(phases["contact::enforce"])
            contacts[name] = run.history["contacts"][-1], run.report["steps"]
    for name, times in seconds.items():
        print(f"{name}: least {min(times):.3f} s, median {np.median(times):.3f} s, contacts at the end and steps {contacts[name]}")
    least = [min(times) for times in seconds.values()]
    print(f"ratio of the least {least[0] / least[1]:.3f}")


if __name__ == "__main__":
    main()
