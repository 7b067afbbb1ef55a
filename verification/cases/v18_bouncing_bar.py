"""V18: Bounces of an elastic bar (after Doyen, Ern and Piperno 2011): a bar of length L falls on a rigid
plane, which it meets with v0 at t1 = v0/g. In the frame that falls freely, the force on its end
sends the velocity w = v0 + g (t - t1) up the bar; the wave returns from the free end at t1 + 2 L/c.
There the bar leaves with v0 everywhere and twice the strain of its standing weight, since w(t - z/c)
+ w(t - (2 L - z)/c) does not depend on z. With v0 c/(g L) = 3 the flight of 2 v0/g lasts three
periods of its vibration, so the second impact is the first one backwards in time: contact force rho
c A w, then w backwards, and at rest in the height of the start at 4 v0/g + 4 L/c. Penalty and mesh
err by O(h) and by the dispersion of the front, O(h^(2/3)). It tests the behaviour of the energy at
impacts, as one of the benchmarks of Di Stasio, Dureisseix, Gravouil, Georges and Homolle (Adv. Model.
Simul. Eng. Sci. 6:2, 2019) does; it is in their spirit and has this code's own definition."""
import numpy as np
from framework.figures import EXACT
from framework.meshes import box, nodal_masses, together

NAME = "V18"
TITLE = "bounces of an elastic bar"
DECK = "v18_bouncing_bar.toml"
LENGTH, SPEED, AREA = 10.0, 30.0, 0.16
HEIGHT = 0.005  # of the fall


def scene(n):
    width = np.sqrt(AREA)
    bar = box((width, width, LENGTH), (1, 1, n), (0, 0, HEIGHT), "bar")
    plane = box((3 * width, 3 * width, width), (1, 1, 1), (-width, -width, -width), "plane")
    plane.node_sets = {"plane.all": np.arange(8)}
    return together(bar, plane)


class Exact:
    """Force and centre of mass by time; the impacts last from begin to end."""

    def __init__(self, gravity):
        self.g, self.v0, self.mass = gravity, np.sqrt(2 * gravity * HEIGHT), AREA * LENGTH
        fall, wave = self.v0 / gravity, 2 * LENGTH / SPEED
        self.begin = np.array([fall, 3 * fall + wave])
        self.end = self.begin + wave

    def force(self, times):
        (b1, b2), (e1, e2) = self.begin, self.end
        along = SPEED * AREA * (self.v0 + self.g * np.where(times < e1, times - b1, e2 - times))
        return np.where((times > b1) & (times < e1) | (times > b2) & (times < e2), along, 0.0)

    def height(self, times):
        """Displacement of the centre of mass: twice the integral of force/mass - g."""
        fine = np.linspace(0, 2 * self.begin[0] + self.end[1], 200001)
        dt = fine[1]
        velocity = np.concatenate([[0], np.cumsum((self.force(fine[:-1] + dt / 2) / self.mass - self.g) * dt)])
        place = np.concatenate([[0], np.cumsum((velocity[1:] + velocity[:-1]) / 2 * dt)])
        return np.interp(times, fine, place)


def evaluate(lab):
    exact = Exact(-lab.deck["gravity"]["acceleration"][2])
    rows, curves = [], {}
    for n in (25, 50, 100) if lab.quick else (25, 50, 100, 200):
        run = lab.run(f"n{n}", mesh=scene(n))
        results, history, times = run.results, run.history, run.results.times
        bar = results.nodes_of_block(0)
        share = nodal_masses(results.nodes, results.hexes)[bar] / exact.mass
        steps, dt = range(len(times)), times[1]
        force = np.array([results.nodal("force_contact_z", step)[bar].sum() for step in steps])
        place, velocity = (np.array([share @ results.nodal(f"{name}_z", step)[bar] for step in steps])
                           for name in ("displacement", "velocity"))
        first = times < (exact.end[0] + exact.begin[1]) / 2
        flight = velocity + exact.g * (times - exact.end[0])  # at the end of the first contact
        errors = {"end of the first contact": (times[np.flatnonzero((force > 0) & first)[-1]] - exact.end[0]) / (2 * LENGTH / SPEED),
                  "velocity of the rebound": flight[first][-1] / exact.v0 - 1,
                  "first impulse": force[first].sum() / force_sum(exact, times) - 1,
                  "second impulse": force[~first].sum() / force_sum(exact, times) - 1,
                  "height, largest error": np.abs(place - exact.height(times)).max() / HEIGHT,
                  "height at the end": place[-1] / HEIGHT}
        # The front is smeared over (1 - C^2)^(1/3) (L/(4 h))^(1/3) elements after 2 L, C = c dt/h;
        # the penalty is as soft as a part of an element.
        h = LENGTH / n
        width = (1 + ((1 - (SPEED * dt / h)**2) * n / 4) ** (1 / 3)) / n
        rows.append([n, width, *errors.values(), history["energy_error"].max()])
        curves[n] = times, force, place
    for name, error in errors.items():  # of the finest mesh
        # Heights err by the velocity times the flight, 4 times its error.
        lab.check(error, 0, (4 if "height" in name else 1) * width, name.replace(",", "").replace(" ", "_") if "end of" not in name else "")
    # The order is 1 for the penalty and 2/3 for the smeared front.
    lab.check_order([1 / row[0] for row in rows], [row[3] for row in rows], least=0.6, exact=1, name="order_of_the_rebound")
    lab.check(max(row[-1] for row in rows), 0, 1e-9, "energy")
    lab.table("Relative errors; the tolerance is the width of the front and one element, over the length:",
              ["elements", "tolerance", *errors, "energy error"], rows)
    with lab.figure("Contact force; height of the centre of mass over that of the fall", panels=2) as (forces, heights):
        plateau = SPEED * AREA * exact.v0
        forces.plot(times, exact.force(times) / plateau, label="exact", **EXACT)
        heights.plot(times, 1 + exact.height(times) / HEIGHT, label="exact", **EXACT)
        for n in (25, max(curves)):
            times, force, place = curves[n]
            smooth = np.convolve(force, np.ones(n // 5) / (n // 5), "same")  # contact oscillates from step to step
            forces.plot(times, smooth / plateau, label=f"N = {n}, mean over {n // 5} steps", linewidth=0.8)
            heights.plot(times, 1 + place / HEIGHT, label=f"N = {n}", linewidth=1)
        forces.set(xlabel="t", ylabel="F / (rho c A v0)")
        heights.set(xlabel="t", ylabel="height")


def force_sum(exact, times):
    """The impulse of one impact over the step."""
    return exact.mass * 2 * (exact.v0 + exact.g * LENGTH / SPEED) / times[1]
