"""H9: A cube of one element approaches another so fast that it moves by 0.05 to 0.9 of its size in
a stable step: between two steps a node, or the whole body, could pass a face. The guard must cut
the step so that they collide, with momentum and energy conserved, or the run must stop with the
reason; without the guard, the cube passes through the other."""
import numpy as np
from _hard import Block, check_stop, energy_change, mesh_of

NAME = "H9"
TITLE = "impact at v dt near a brick"
DECK = "h09_fast_impact.toml"
SECONDS = 5
STEP = 0.506  # stable step of the cube at safety 0.8, rounded down


def throw(lab, label, share, settings=None, expect=None):
    """The cube moves by `share` of its size in a stable step of 0.506 edge lengths/c; the gap is
    0.7 of a cube."""
    speed = share / STEP
    blocks = (Block("low", elements=(1, 1, 1)), Block("high", (0.1, 0.05, 1.7), elements=(1, 1, 1)))
    run = lab.run(label, {"initial.velocity[0].velocity": [0, 0, -speed], "time.end": 3.0 / speed + 1.0, **(settings or {})},
                  mesh=mesh_of(*blocks), expect=expect)
    return run, speed


def height(run, step=-1):
    """Height of the centre of the upper cube above that of the lower one."""
    z = run.results.nodes[:, 2] + run.results.nodal("displacement_z", step)
    return z[run.results.nodes_of_block(1)].mean() - z[run.results.nodes_of_block(0)].mean()


def evaluate(lab):
    rows, passed_through, stops = [], 0, []
    for share in (0.05, 0.2, 0.5, 0.9):
        run, speed = throw(lab, f"v_dt_{share}", share)
        history = run.history
        energy = energy_change(history)
        momentum = np.abs(run.vector("momentum")[:, 2] + speed).max() / speed
        rows.append([share, speed, run.code, history["timestep"][0], history["timestep"].min(), height(run),
                     np.abs(energy).max(), momentum, int(history["contacts"].max())])
        # A run that ends normally must not have cubes that passed through each other; one that
        # stops must give the reason. At the speed of sound a cube of one element that is hit at a
        # corner folds and tumbles past the other one.
        passed_through += run.code == 0 and height(run) < 0.3 and speed < 0.5
        if run.code == 0 and speed >= 0.5 and height(run) < 0.3:
            lab.weak_spot(f"at {speed:.2g} c cubes of one element fold where they meet and tumble past each other")
        if run.code != 0:
            stops.append((run, share))
    lab.check(passed_through, 0, 0)
    for run, share in stops:
        check_stop(lab, run, ["step"], f"stop_at_{share}")
    slow = [row for row in rows if row[2] == 0]
    lab.check(len(slow) > 0, 1, 0, "some_collide")
    # A cut of the step under load changes the conserved energy of central differences by O(dt^2).
    lab.check(max(row[6] for row in slow), 0, 1e-2, "energy")
    lab.check(max(row[7] for row in rows), 0, 1e-12, "momentum")
    stopped, _ = throw(lab, "guard_stop", 0.5, {"contact.guard": "stop"})
    check_stop(lab, stopped, ["contact could be missed", "of body 0 moves by", "of body 1 in one step"], "guard_stop_names_the_pair")
    off, _ = throw(lab, "without_guard", 2.5, {"contact.guard": "off"})
    lab.check(off.code == 0 and height(off) < 0, 1, 0, "without_guard_it_passes_through")
    lab.table("By share of the cube's size in a stable step:", ["v dt / cube", "v/c", "exit code", "first step", "least step",
                                                         "final height", "energy error", "momentum error", "most contacts"],
              rows)
