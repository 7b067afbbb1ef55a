#!/usr/bin/python3
"""Lets one of three ranks run out of memory alone, in the middle of a step, and checks that all ranks end
with a message: in the phases of the search, in waits for messages, in enforcement, in the sums over ranks.

Usage: lone_failures.py BRICKWALL MPIEXEC LIBRARY DECK [--all] [--only NAME,...]
LIBRARY is that of failing_region.cpp. --all takes every region, kernel and allocation of a step.
"""
import argparse
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
import time

RANKS, RANK, STEP, STEPS = 3, 1, 25, 60
LIMIT = 60  # s of a run; a rank that fails waits 5 s for the others
SCENES = {  # a search in every step; lists that are kept, and faces on other ranks than their elements
    "search": ["--set", "search.reuse.margin=0", "--set", "contact.friction=0.3"],
    "kept": ["--set", "search.decomposition='surface'", "--set", "contact.friction=0.3"],
}
# One of each kind: boxes, rank boxes, node boxes, faces, pairs, forces, sums.
NAMES = {
    "search": [
        "base::waitForRanks", "contact::exchangeNodeBoxes::pack_nodes", "contact::exchangeNodeBoxes",
        "contact::searchLocalFacesAgainstRemoteNodes", "contact::migrateFaces::pack", "contact::migrateFaces::unpack",
        "contact::reverseSum::pack", "miniapp::sumSharedNodes", "miniapp::kickVelocities"],
    "kept": ["contact::forwardCoordinates", "contact::enforce", "miniapp::bookEnergies"],
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
                       BRICKWALL_FAULT_RANK=str(RANK), BRICKWALL_FAULT_STEP=str(STEP), **more)
    words = [arguments.mpiexec, "-n", str(RANKS), "--oversubscribe", arguments.program, "run", arguments.deck, "-o", folder,
             "--steps", str(STEPS), *SCENES[scene]]
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
    process = start(scene, f"{folder}/{scene}_{re.sub('[^a-zA-Z0-9]', '_', name)}", {"BRICKWALL_FAULT_NAME": name})
    try:
        text = process.communicate(timeout=LIMIT)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        return "it hangs"
    if process.returncode != 1:
        return f"exit code {process.returncode} instead of 1 after {time.monotonic() - begin:.0f} s: {text[-500:]}"
    if "brickwall: error" not in text or "out of memory" not in text:
        return f"no message: {text[-500:]}"
    return ""


with tempfile.TemporaryDirectory() as work, concurrent.futures.ThreadPoolExecutor(3) as pool:
    runs = []
    for scene in SCENES:
        os.mkdir(f"{work}/{scene}")
        known = names_of(scene, f"{work}/{scene}")
        chosen = arguments.only.split(",") if arguments.only else known if arguments.all else NAMES[scene]
        missing = [name for name in chosen if name not in known]
        if missing and not arguments.only:
            sys.exit(f"no step of scene {scene} has {', '.join(missing)}; it has {', '.join(known)}")
        runs += [(scene, name) for name in chosen if name in known]
    ends = list(pool.map(lambda run: fault_of(run[0], f"{work}/{run[0]}", run[1]), runs))
failed = [f"FAILED {scene}, {name}: {end}" for (scene, name), end in zip(runs, ends) if end]
print("\n".join(failed + [f"{len(runs)} failures of one rank, {len(failed)} ended wrongly"]))
sys.exit(len(failed) > 0)
