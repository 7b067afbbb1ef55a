"""Scenes with exact or converged answers: the cases V1s, V2, V7, V13 of the verification, over
settings."""
import sys

import numpy as np
from framework.meshes import box
from framework.signals import fit_frequency, tip_deflection
from bricks import means_of_bodies
from scene import COMBINED, DEFAULT, FEW, FULL, HERE, PENALTIES, PLAIN, REUSE, ROW_SUMS, SOFT_AND_LONG, STEPS, Scene, counts_of

CASES = HERE.parent / "cases"
sys.path.insert(0, str(CASES))
from v01s_smooth_wave import exact_stress
from v07_cantilever import CONVERGED

DECKS = HERE.parent / "decks"


class SmoothWave(Scene):
    name = "smooth wave"
    text = ("A smooth pulse runs along an elastic bar (V1s). Error: root mean square of the stress error at the centres of the elements "
            "at t = 0.5, over that of d'Alembert's solution.")
    deck = DECKS / "v01s_smooth_wave.toml"
    has_contact = False
    rule = STEPS[-1]
    targets = (0.03, 0.01, 0.003, 0.001)

    def __init__(self, quick):
        self.sizes = {f"{n}x1x1": 1 / n for n in ((50, 100) if quick else (25, 50, 100, 200, 400, 800))}

    def variants(self, mesh):
        return [DEFAULT, *STEPS, FULL, *ROW_SUMS[:3]]

    def observe(self, run):
        results = run.results
        sigma = results.element("stress_xx") / 1e-3
        exact = exact_stress(results.centroids()[:, 0], results.times[-1], 0.3)
        return {"error": float(np.linalg.norm(sigma - exact) / np.linalg.norm(exact))}


class TwoBars(Scene):
    name = "two bars"
    text = ("Two equal bars meet (V2). Error: displacement of the first bar's centre of mass from the start to t = 3 L/c, which is "
            "exactly -v0 L/c, over v0 L/c. It depends on the duration and the force of the contact; a mere delay gives 2 delay c/L.")
    deck = DECKS / "v02_two_bars.toml"
    targets = (0.1, 0.03, 0.01, 0.003)

    def __init__(self, quick):
        self.sizes = {f"{n}x1x1": 1 / n for n in ((10, 20) if quick else (20, 40, 80, 160, 320))}
        self.quick = quick

    def settings(self, mesh):
        return {**super().settings(mesh), "output.interval": 0.0}

    def variants(self, mesh):
        if self.quick:
            return [DEFAULT, FEW[2], *REUSE, ROW_SUMS[0]]
        return [DEFAULT, *STEPS, *PENALTIES, *SOFT_AND_LONG, PLAIN, *REUSE, *COMBINED, *ROW_SUMS]

    def observe(self, run):
        v0 = 1e-3
        moved = means_of_bodies(run.results, "displacement")[0, 0]
        return {"error": float(abs(moved + v0) / v0), "energy_error": float(run.history["energy_error"][-1])}


class Cantilever(Scene):
    name = "cantilever"
    text = ("A clamped beam vibrates (V7). Error: that of the first bending frequency, relative to the converged one. The error of "
            "the one-point element crosses zero between one and two elements through the depth, so that of one is accidentally small.")
    deck = DECKS / "v07_cantilever.toml"
    has_contact = False
    rule = ROW_SUMS[0]
    targets = (0.1, 0.03, 0.01, 0.003)

    def __init__(self, quick):
        meshes = ((10, 1, 1), (10, 2, 2)) if quick else ((10, 1, 1), (10, 2, 2), (20, 2, 2), (40, 4, 4))
        self.sizes = {"x".join(map(str, elements)): 1 / elements[2] for elements in meshes}

    def settings(self, mesh):
        return {}

    def geometry(self, mesh):
        return box((10, 1, 1), counts_of(mesh), name="beam")

    def variants(self, mesh):
        return [DEFAULT, STEPS[0], STEPS[-1], FULL, *ROW_SUMS[:3]]

    def observe(self, run):
        frequency = fit_frequency(run.results.times, tip_deflection(run.results), CONVERGED)
        return {"error": float(abs(frequency / CONVERGED - 1))}


class SpinningBlock(Scene):
    name = "spinning block"
    text = ("A free block spins with its corners at 0.1 c (V13). Error: largest minus least energy within 7 revolutions, over the energy. "
            "It falls with the square of the step, on finer meshes and with shorter steps alike.")
    deck = DECKS / "v13_spinning_block.toml"
    has_contact = False
    rule = STEPS[-1]
    targets = (1e-3, 3e-4, 1e-4)

    def __init__(self, quick):
        meshes = ((4, 2, 2),) if quick else ((2, 1, 1), (4, 2, 2), (8, 4, 4))
        self.sizes = {"x".join(map(str, elements)): 1 / elements[2] for elements in meshes}

    def settings(self, mesh):
        return {**super().settings(mesh), "time.end": 500.0, "output.history_interval": 0.0}

    def variants(self, mesh):
        return [DEFAULT, *STEPS, FULL, *ROW_SUMS[:3]]

    def observe(self, run):
        energy = run.history["total_energy"][1:]
        angular = run.vector("angular_momentum")
        return {"error": float(np.ptp(energy) / energy[0]),
                "angular_momentum_error": float(np.linalg.norm(angular - angular[0], axis=1).max() / np.linalg.norm(angular[0]))}
