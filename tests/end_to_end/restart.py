#!/usr/bin/python3
"""Compares a run with others that are interrupted and restarted on other numbers of ranks and threads:
history.csv byte by byte, all variables of the joined Exodus file bit by bit, and the checksums of the
final state and contact history. An audit (search.audit) must find no missed pair, in lists that are kept.

Usage: restart.py BRICKWALL MPIEXEC EPU DECK "LEG ..." "LEG ..." ... [program options from the first --]
The first list is the reference. Each leg after the first of a list restarts from the latest
checkpoint. A leg is RANKSxTHREADS@END: END is the last step, `end` for that of the deck, or `kill`
for SIGKILL to all ranks at the leg's first checkpoint; with END+TIME, the leg extends the run to TIME. RANKSxTHREADS!@END
prints checksums of all steps, which changes skip.free_bricks.
"""
import csv
import itertools
import json
import os
import signal
import subprocess
import sys
import tempfile

import netCDF4
import numpy

brickwall, mpiexec, epu, deck = sys.argv[1:5]
reference, *others = itertools.takewhile(lambda word: not word.startswith("--"), sys.argv[5:])
options = sys.argv[6 + len(others):]
name = os.path.splitext(os.path.basename(deck))[0]


def start(folder, ranks, threads, more):
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads), OMPI_MCA_orte_execute_quiet="1")
    command = [mpiexec, "-n", str(ranks), "--oversubscribe", brickwall, "run", deck, "-o", folder]
    return subprocess.Popen(command + options + more, env=environment, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, start_new_session=True)


def run(folder, ranks, threads, more, expected=0):
    process = start(folder, ranks, threads, more)
    text = process.communicate(timeout=120)[0]
    if process.returncode != expected:
        sys.exit(f"{text}\n{ranks}x{threads} {more}: exit code {process.returncode}, expected {expected}")
    return text


def kill_ranks(launcher):
    children = f"/proc/{launcher.pid}/task/{launcher.pid}/children"
    for rank in open(children).read().split():
        os.kill(int(rank), signal.SIGKILL)


def join(folder, ranks):
    if ranks > 1:
        base = f"{name}.exo.{ranks}.{0:0{len(str(ranks))}d}"
        subprocess.run([epu, "-auto", base], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def difference(one, other):
    """The first difference of two output folders, or None."""
    histories = [open(f"{folder}/history.csv").read() for folder in (one, other)]
    if histories[0] != histories[1]:
        for a, b in zip(*(text.splitlines() for text in histories)):
            if a != b:
                header = histories[0].splitlines()[0].split(",")
                columns = [h for h, x, y in zip(header, a.split(","), b.split(",")) if x != y]
                return f"history.csv differs in step {a.split(',')[0]}: {columns}"
        return f"history.csv has {[text.count(chr(10)) for text in histories]} lines"
    reports = [json.load(open(f"{folder}/report.json"))["checksums"] for folder in (one, other)]
    if reports[0] != reports[1]:
        return f"checksums {reports}"
    a, b = (netCDF4.Dataset(f"{folder}/{name}.exo") for folder in (one, other))
    for variable in a.variables:
        if variable.startswith(("vals_", "coord", "connect", "time")):
            x, y = (numpy.ma.asarray(f[variable][:]).tobytes() for f in (a, b))
            if a[variable].shape != b[variable].shape or x != y:
                return f"{variable} differs: {a[variable].shape} {b[variable].shape}"
    return None


def run_legs(folder, legs):
    more = []
    for leg in legs.split():
        layout, end = leg.split("@")
        more += ["--checksums"] if layout.endswith("!") else []
        ranks, threads = (int(n) for n in layout.rstrip("!").split("x"))
        end, _, time = end.partition("+")
        more += ["--extend-to", time] if time else []
        if end == "kill":
            process = start(folder, ranks, threads, more)
            for line in process.stdout:
                if line.startswith("checkpoint "):
                    break
            kill_ranks(process)
            process.communicate()
            assert process.returncode not in (0, 2), f"the run ended before it was killed: {legs}"
        else:
            run(folder, ranks, threads, more + (["--steps", end] if end != "end" else []))
        more = ["--restart", "latest" if more else folder]
    join(folder, ranks)


with tempfile.TemporaryDirectory() as work:
    straight = f"{work}/straight"
    run_legs(straight, reference)
    with open(f"{straight}/history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    if "missed_pairs" in rows[-1]:
        assert rows[-1]["missed_pairs"] == "0", f"the audit found {rows[-1]['missed_pairs']} missed pairs"
        assert 1 < int(rows[-1]["searches"]) < int(rows[-1]["step"]) / 2, f"{rows[-1]['searches']} searches"
    for number, legs in enumerate(others):
        pieces = f"{work}/{number}"
        run_legs(pieces, legs)
        found = difference(straight, pieces)
        if found:
            sys.exit(f"{legs}: {found}")
        kept = os.listdir(f"{pieces}/checkpoints")
        assert len(kept) <= 2 and not any("." in folder for folder in kept), kept
        print(f"{legs}: identical, {len(rows)} rows")
