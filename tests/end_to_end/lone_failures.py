#!/usr/bin/python3
"""Lets one of three ranks run out of memory alone, in the middle of a step, and checks that all ranks end
with a message: in the phases of the search, in waits for messages, in enforcement, in the sums over ranks, in
distributions of faces and in transfers to them.

Usage: lone_failures.py BRICKWALL MPIEXEC LIBRARY DECK [--all] [--only NAME,...]
LIBRARY is that of failing_region.cpp. --all takes every region, kernel and allocation of a step; those of a distribution of faces, which
depends on measured times, may not come up again. NAME+N: the N-th `new` after that name.
"""
import argparse
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
import time

RANKS, RANK, STEPS = 3, 1, 60
LIMIT = 60  # s of a run; a rank that fails waits 5 s for the others
NOT_MET = "the name did not come up"
HANGS = f"it hangs for {LIMIT} s"
# With half bricks, faces leave the ranks of their elements.
SURFACE = ["--set", "search.decomposition='surface'", "--set", "contact.friction=0.3", "--set", "wall.ends='ragged'"]
# First step, options: a search in every step; lists that are kept, and faces on other ranks than their elements; their distribution.
SCENES = {
    "search": (25, ["--set", "search.reuse.margin=0", "--set", "contact.friction=0.3"]),
    "kept": (25, SURFACE),
    "distribution": (0, SURFACE),
}
# One of each kind: rank boxes, node boxes, faces, forces, sums; coordinates, flags, accelerations and forces of faces elsewhere.
NAMES = {
    "search": [
        "base::waitForRanks", "contact::exchangeNodeBoxes::pack_nodes", "contact::searchLocalFacesAgainstRemoteNodes",
        "contact::migrateFaces::pack", "contact::reverseSum::pack", "miniapp::sumSharedNodes", "miniapp::kickVelocities"],
    "kept": ["contact::forwardCoordinates", "contact::SurfaceTransfer::packFlags", "contact::SurfaceTransfer::copyRows"],
    "distribution": ["contact::SecondarySurface+3", "contact::SecondarySurface+50"],
}

parser = argparse.ArgumentParser(usage=__doc__)
for name in ("program", "mpiexec", "library", "deck"):
    parser.add_argument(name)
parser.add_argument("--all", action="store_true")
parser.add_argument("--only")
arguments = parser.parse_args()


def start(scene, folder, more):
    environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_orte_execute_quiet="1",
                       KOKKOS_PROFILE_LIBRARY=arguments.library, KOKKOS_TOOLS_LIBS=arguments.library,
                       BRICKWALL_FAULT_RANK=str(RANK), BRICKWALL_FAULT_STEP=str(SCENES[scene][0]), **more)
    words = [arguments.mpiexec, "-n", str(RANKS), "--oversubscribe", "-x", f"LD_PRELOAD={arguments.library}", arguments.program, "run",
             arguments.deck, "-o", folder, "--steps", str(STEPS), *SCENES[scene][1]]
    return subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            errors="replace")


def names_of(scene, folder):
    """All that a step opens, launches and allocates."""
    path = f"{folder}/names"
    text = start(scene, folder, {"BRICKWALL_FAULT_LIST": path}).communicate(timeout=LIMIT)[0]
    if not os.path.exists(path):
        sys.exit(f"no list of names: {text[-600:]}")
    # Destructors allocate nothing.
    return [name for name in open(path).read().splitlines() if "::destruction" not in name]


def fault_of(scene, folder, name):
    """What is wrong with the end of a run that fails at this name, or nothing."""
    begin = time.monotonic()
    region, _, allocation = name.partition("+")
    process = start(scene, f"{folder}/{scene}_{re.sub('[^a-zA-Z0-9]', '_', name)}",
                    {"BRICKWALL_FAULT_NAME": region, "BRICKWALL_FAULT_ALLOCATION": allocation})
    try:
        text = process.communicate(timeout=LIMIT)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        return HANGS
    if process.returncode == 0 and "failing_region: the name has come up" not in text:
        return NOT_MET
    if process.returncode != 1:
        return f"exit code {process.returncode} instead of 1 after {time.monotonic() - begin:.0f} s: {text[-500:]}"
    if "brickwall: error" not in text or "out of memory" not in text:
        return f"no message: {text[-500:]}"
    return ""


with tempfile.TemporaryDirectory() as work, concurrent.futures.ThreadPoolExecutor(6) as pool:
    for scene in SCENES:
        os.mkdir(f"{work}/{scene}")
    runs = []
    for scene, known in zip(SCENES, pool.map(lambda scene: names_of(scene, f"{work}/{scene}"), SCENES)):
        chosen = arguments.only.split(",") if arguments.only else known if arguments.all else NAMES[scene]
        missing = [name for name in chosen if name.partition("+")[0] not in known]
        if missing and not arguments.only:
            sys.exit(f"no step of scene {scene} has {', '.join(missing)}; it has {', '.join(known)}")
        runs += [(scene, name) for name in chosen if name not in missing]
    ends = list(pool.map(lambda run: fault_of(run[0], f"{work}/{run[0]}", run[1]), runs))
    # Six runs at once may take that long where other programs fill the machine.
    ends = [fault_of(run[0], f"{work}/{run[0]}", run[1]) if end == HANGS else end for run, end in zip(runs, ends)]
accepted = ("", NOT_MET) if arguments.all or arguments.only else ("",)
failed = [f"FAILED {scene}, {name}: {end}" for (scene, name), end in zip(runs, ends) if end not in accepted]
not_met = ends.count(NOT_MET)
print("\n".join(failed + [f"{len(runs) - not_met} failures of one rank, {len(failed)} ended wrongly; {not_met} names did not come up"]))
sys.exit(len(failed) > 0)
