#!/usr/bin/python3
"""Injects faults into runs of a small wall, and checks that nothing that was written before is lost:
finished rows of history.csv and Exodus steps can be read and are those of the run without faults, the
last finished checkpoint continues the run to the same bits, damaged files are refused with a reason,
no rank hangs, and no process crashes.

Usage: faults.py BRICKWALL MPIEXEC LIBRARY DECK [--count N] [--seed S] [--only KIND,...]
LIBRARY is that of failing_region.cpp.
With the default count, each kind of fault comes once (the short form); the long form is --count 200 or more.
Kinds that need a file system of their own (a small disk, a read-only folder) need root and are
skipped otherwise.
"""
import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import netCDF4
import numpy

STEPS, EVERY, RANKS = 400, 40, 2
OPTIONS = ["--set", "wall.bricks=[3,1,3]", "--set", "wall.elements=[4,2,2]", "--set", "load.pressure.0.wave_speed=0",
           "--set", "contact.friction=0.3", "--set", "output.history_interval=0", "--set", "output.interval=2e-4",
           "--set", f"output.checkpoint.steps={EVERY}", "--steps", str(STEPS)]
PATIENCE = 10  # s until all ranks have ended after one has died

arguments = argparse.ArgumentParser(usage=__doc__)
arguments.add_argument("program")
arguments.add_argument("mpiexec")
arguments.add_argument("library")
arguments.add_argument("deck")
arguments.add_argument("--count", type=int)
arguments.add_argument("--seed", type=int, default=1)
arguments.add_argument("--only")
arguments = arguments.parse_args()
name = os.path.splitext(os.path.basename(arguments.deck))[0]
environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_orte_execute_quiet="1")


class Wrong(Exception):
    pass


def demand(condition, text):
    if not condition:
        raise Wrong(text)


def start(folder, *more, command="run", deck=arguments.deck, ranks=RANKS, program=(arguments.program,), **variables):
    words = [arguments.mpiexec, "-n", str(ranks), "--oversubscribe", *program, command, deck, "-o", folder]
    return subprocess.Popen(words + OPTIONS + list(more), env={**environment, **variables}, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, errors="replace")


def finish(process, seconds=120):
    try:
        return process.communicate(timeout=seconds)[0]
    except subprocess.TimeoutExpired:
        for rank in ranks_of(process):
            send(rank, signal.SIGKILL)
        process.kill()
        raise Wrong(f"still running after {seconds} s")


def run(folder, *more, expected=(0,), **how):
    process = start(folder, *more, **how)
    text = finish(process)
    demand(process.returncode in expected, f"exit code {process.returncode}, expected {expected}: {text[-600:]}")
    return text


def send(rank, what):
    try:
        os.kill(rank, what)
    except ProcessLookupError:
        pass  # it has ended meanwhile


def ranks_of(process):
    try:
        return [int(p) for p in open(f"/proc/{process.pid}/task/{process.pid}/children").read().split()]
    except FileNotFoundError:
        return []


def history(folder):
    return open(f"{folder}/history.csv").read().splitlines(keepends=True)


def exodus_steps(folder):
    """Displacements of each finished step, by time, for each rank file."""
    for rank in range(RANKS):
        path = f"{folder}/{name}.exo.{RANKS}.{rank}"
        with netCDF4.Dataset(path) as file:
            yield rank, {float(t): numpy.ma.asarray(file["vals_nod_var1"][i]).tobytes()
                         for i, t in enumerate(file["time_whole"][:]) if t <= file.last_written_time}


def check_written(folder):
    """Whatever is there is a beginning of the run without faults."""
    if not os.path.exists(f"{folder}/history.csv"):
        return
    rows = history(folder)
    if rows and not rows[-1].endswith("\n"):
        rows.pop()  # the row that was being written
    demand(rows == reference_history[:len(rows)], "rows of history.csv are lost or differ")
    if len(rows) < 2 or not os.path.exists(f"{folder}/{name}.exo.{RANKS}.{RANKS - 1}"):
        return
    for rank, steps in exodus_steps(folder):
        for at, values in steps.items():  # the state at which a run was ended is of no output time
            demand(at not in reference_steps[rank] or reference_steps[rank][at] == values, f"Exodus step at {at} differs")


def check_continues(folder, which="latest"):
    """The run continues to the bits of the run without faults."""
    text = run(folder, "--restart", which)
    demand(history(folder) == reference_history, "history.csv differs after the restart")
    demand(dict(exodus_steps(folder)) == reference_steps, "Exodus differs after the restart")
    return text


def checkpoints(folder):
    try:
        found = sorted(os.listdir(f"{folder}/checkpoints"))
    except FileNotFoundError:
        return []
    return [f"{folder}/checkpoints/{entry}" for entry in found if "." not in entry]


def check_survives(folder):
    """What was written is right, and a run that has a checkpoint continues."""
    check_written(folder)
    if checkpoints(folder):
        check_continues(folder)


def wait_and_find_ranks(process):
    """Waits a random time of the run, of which the part before the first checkpoint is small."""
    end = time.monotonic() + random.uniform(0.2, 1.3) * duration
    while time.monotonic() < end and process.poll() is None:
        time.sleep(0.005)
    return ranks_of(process)


def kill_all(folder):
    process = start(folder)
    for rank in wait_and_find_ranks(process):
        send(rank, signal.SIGKILL)
    finish(process)
    check_survives(folder)


def lose_a_rank(folder):
    process = start(folder)
    ranks = wait_and_find_ranks(process)
    if ranks:
        send(random.choice(ranks), signal.SIGKILL)
        finish(process, PATIENCE)
    else:
        finish(process)
    check_survives(folder)


def lose_a_rank_before_the_last_state(folder):
    """A checkpoint of the last step would call the run complete: it must follow the last state."""
    seldom = ["--set", "output.history_interval=1", "--set", "output.interval=1"]  # the first state and the last one
    run(folder + "/straight", *seldom)
    text = run(folder, *seldom, expected=(1,), KOKKOS_PROFILE_LIBRARY=arguments.library, KOKKOS_TOOLS_LIBS=arguments.library,
               BRICKWALL_FAULT_RANK="1", BRICKWALL_FAULT_STEP=str(STEPS), BRICKWALL_FAULT_NAME="miniapp::output")
    demand("out of memory" in text, text[-600:])
    run(folder, *seldom, "--restart", "latest")
    demand(history(folder) == history(folder + "/straight"), "history.csv differs after the restart")
    demand(dict(exodus_steps(folder)) == dict(exodus_steps(folder + "/straight")), "Exodus differs after the restart")


def lose_memory_while_elements_move(folder):
    """There is then no state to write; the files are those of the steps before, whichever part of the move fails."""
    moves = ["--set", "partition.rebalance='always'", "--set", f"partition.interval={EVERY + EVERY // 2}"]
    part = random.choice(["miniapp::rebalance", "mechanics::lumpedMass::sums", "miniapp::ResultsWriter::contact_words"])
    text = run(folder, *moves, expected=(1,), KOKKOS_PROFILE_LIBRARY=arguments.library, KOKKOS_TOOLS_LIBS=arguments.library,
               BRICKWALL_FAULT_RANK="1", BRICKWALL_FAULT_STEP=str(EVERY + 2), BRICKWALL_FAULT_NAME=part)
    demand(text.count("brickwall: error") == 1 and "out of memory" in text, text[-600:])
    check_written(folder)
    run(folder, *moves, "--restart", "latest")
    demand(history(folder) == reference_history, "history.csv differs after the restart")
    demand(not [file for file in os.listdir(folder) if ".new" in file], "files of the move are left")


def end_by_signal(folder):
    process = start(folder)
    ranks = wait_and_find_ranks(process)
    for _ in range(random.choice([0, 1, 3])):
        for rank in ranks:
            send(rank, signal.SIGUSR1)
        time.sleep(0.02)
    if ranks:
        send(random.choice(ranks), random.choice([signal.SIGTERM, signal.SIGINT, signal.SIGUSR2]))
    finish(process)
    # Before its handlers stand, the program dies by the signal as any other does.
    if process.returncode == 5:
        demand(checkpoints(folder), "a run that was ended has no checkpoint")
    check_survives(folder)


def finished_run(folder):
    shutil.copytree(whole, folder)


def damage(path):
    """Cuts a file, or inverts a bit."""
    size = os.path.getsize(path)
    if random.random() < 0.5:
        os.truncate(path, random.randrange(size))
        return
    with open(path, "r+b") as file:
        at = random.randrange(size)
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ 1 << random.randrange(8)]))


def damaged_checkpoint(folder):
    finished_run(folder)
    last = checkpoints(folder)[-1]
    damage(f"{last}/{random.choice(sorted(os.listdir(last)))}")
    text = run(folder, "--restart", "latest", expected=(2,))
    demand("cannot be used: " in text and "the nearest one can: --restart " in text, text[-600:])
    check_continues(folder, text.split("the nearest one can: --restart ")[1].split()[0])


def damaged_results(folder):
    """Damaged rows or headers of earlier results are refused; a damage inside values is copied."""
    finished_run(folder)
    path = f"{folder}/" + random.choice([f"{name}.exo.{RANKS}.0", f"{name}.exo.{RANKS}.1", "history.csv"])
    os.truncate(path, random.randrange(os.path.getsize(path) // 2))
    sizes = {file: os.path.getsize(f"{folder}/{file}") for file in os.listdir(folder)}
    text = run(folder, "--restart", checkpoints(folder)[0], expected=(2,))
    demand("are not those that the checkpoint continues" in text, text[-600:])
    demand(sizes == {file: os.path.getsize(f"{folder}/{file}") for file in os.listdir(folder) if not file.endswith(".new")},
           "a refused restart has changed files")


def damaged_deck(folder):
    os.mkdir(folder)
    deck = f"{folder}/deck.toml"
    shutil.copy(arguments.deck, deck)
    for _ in range(random.choice([1, 1, 5])):
        damage(deck)
        if os.path.getsize(deck) == 0:
            break
    run(folder, command="check", deck=deck, ranks=1, expected=(0, 2))


def damaged_mesh(folder):
    os.mkdir(folder)
    shutil.copy(f"{mesh}/{name}.exo", folder)
    deck = f"{folder}/mesh.toml"
    with open(deck, "w") as file:
        file.write(f'[mesh]\nfile = "{name}.exo"\n[time]\nend = 1e-5\n')
        for block in ("brick", "half_brick"):
            file.write(f"[material.{block}]\ndensity = 2000.0\nyoungs_modulus = 2e10\npoissons_ratio = 0.2\n")
    damage(f"{folder}/{name}.exo")
    words = [arguments.mpiexec, "-n", "2", "--oversubscribe", arguments.program, "check", deck]
    process = subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               errors="replace")
    text = finish(process)
    demand(process.returncode in (0, 2, 3), f"exit code {process.returncode}: {text[-600:]}")


def mounted(folder, options):
    os.mkdir(folder)
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], check=True)


def small_disk(folder):
    disk = folder + ".disk"
    mounted(disk, f"size={random.randrange(64, 1500)}k")
    try:
        text = run(disk, expected=(0, 4))
        demand("brickwall: error" in text or "PASS" in text, "no message: " + text[-600:])
        shutil.copytree(disk, folder)
    finally:
        subprocess.run(["umount", disk], check=True)
    check_survives(folder)


def quota(folder):
    """Each file may have so many KiB, beyond which writing fails as at a quota."""
    limit = f'ulimit -f {random.randrange(4, 250)}; trap "" XFSZ; exec "$@"'
    text = run(folder, program=("bash", "-c", limit, "quota", arguments.program), expected=(0, 4))
    demand("brickwall: error" in text or "PASS" in text, "no message: " + text[-600:])
    check_survives(folder)


def read_only_folder(folder):
    mounted(folder, "size=10m")
    try:
        ended = random.random() < 0.5
        if ended:
            run(folder, "--time-limit", "00:00:00", expected=(5,))
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        text = run(folder, *(["--restart", "latest"] if ended else []), expected=(4,))
        demand("brickwall: error" in text, "no message: " + text[-600:])
        subprocess.run(["mount", "-o", "remount,rw", folder], check=True)
        if ended:
            check_continues(folder)
    finally:
        subprocess.run(["umount", folder], check=True)


KINDS = [kill_all, lose_a_rank, lose_a_rank_before_the_last_state,
         lose_memory_while_elements_move, end_by_signal, damaged_checkpoint, damaged_results, damaged_deck, damaged_mesh, quota]
if os.geteuid() == 0 and shutil.which("mount"):
    KINDS += [small_disk, read_only_folder]
if arguments.only:
    KINDS = [kind for kind in KINDS if kind.__name__ in arguments.only.split(",")]

random.seed(arguments.seed)
count = arguments.count or len(KINDS)
failures = 0
done = {}
with tempfile.TemporaryDirectory() as work:
    whole, mesh = f"{work}/whole", f"{work}/mesh"
    begin = time.monotonic()
    run(whole)
    duration = time.monotonic() - begin
    reference_history, reference_steps = history(whole), dict(exodus_steps(whole))
    subprocess.run([arguments.program, "mesh", arguments.deck, "-o", mesh, *OPTIONS[:4]], env=environment, check=True,
                   stdout=subprocess.DEVNULL)
    for number in range(count):
        kind = KINDS[number % len(KINDS)]
        folder = f"{work}/fault{number}"
        try:
            kind(folder)
            done[kind.__name__] = done.get(kind.__name__, 0) + 1
        except Wrong as wrong:
            failures += 1
            print(f"FAILED fault {number}, {kind.__name__}: {wrong}", flush=True)
        if number % 25 == 24:
            print(f"{number + 1} faults, {failures} failed", flush=True)
        shutil.rmtree(folder, ignore_errors=True)
        shutil.rmtree(folder + ".disk", ignore_errors=True)
print(f"{count} faults, {failures} failed: {done}")
sys.exit(failures > 0)
