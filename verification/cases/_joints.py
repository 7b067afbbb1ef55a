"""Impacts of two bars by a one-dimensional model of lumped masses and central differences: the penalty of this program and other
joints (contact/theory.md, section 7).

A joint is a function of the bars and the length of the kick, in steps, that returns the force of contact in a step. The left bar
has the velocity 1, and length, modulus, density and section 1."""
import numpy as np

END = 5.0


class Bars:
    """Two bars with n elements for a unit of travel time, and steps of `courant` c dt/h."""

    def __init__(self, n, length, modulus, courant, massless_ends=False):
        counts = (n, round(n * length / np.sqrt(modulus)))
        lengths, moduli = (1.0, length), (1.0, modulus)
        self.stiffness = np.concatenate([[e * c / size for _ in range(c)] + [0.0] for c, size, e in zip(counts, lengths, moduli)])[:-1]
        self.mass = np.concatenate([np.full(c + 1, size / c) for c, size in zip(counts, lengths)])
        self.left, self.right = counts[0], counts[0] + 1
        self.mass[[0, self.left, self.right, -1]] /= 2
        if massless_ends:  # the nodes beside the ends take their masses
            for end, beside in ((self.left, self.left - 1), (self.right, self.right + 1)):
                self.mass[beside] += self.mass[end]
                self.mass[end] = 0
        self.massless_ends = massless_ends
        self.dt = courant / n
        self.velocity = np.where(np.arange(len(self.mass)) <= self.left, 1.0, 0.0)
        self.displacement = np.zeros(len(self.mass))
        if not massless_ends:
            self.mobility = self.dt**2 * (1 / self.mass[self.left] + 1 / self.mass[self.right])  # tau of eq. (17)

    def penetration(self):
        return self.displacement[self.left] - self.displacement[self.right]

    def approach(self):
        """Over the last drift: d- of eq. (17)."""
        return self.dt * (self.velocity[self.left] - self.velocity[self.right])

    def free_approach(self, kick):
        """Over the next drift, without a force of contact: c of eq. (18)."""
        left, right = self.left, self.right
        return self.approach() + kick * self.dt**2 * (self.free[left] / self.mass[left] - self.free[right] / self.mass[right])

    def collide(self, joint):
        """(restitution, times and forces of all steps, work of the contact over the energy of the relative motion)"""
        bars = (slice(0, self.right), slice(self.right, None))
        totals = [self.mass[bar].sum() for bar in bars]
        masses = np.where(self.mass > 0, self.mass, np.inf)
        forces, work, last_drift = [], 0.0, 0.0
        for step in range(round(END / self.dt)):
            kick = 0.5 if step == 0 else 1.0
            tension = self.stiffness * np.diff(self.displacement)
            self.free = np.append(tension, 0) - np.insert(tension, 0, 0)
            force = joint(self, kick)
            self.free[self.left] -= force
            self.free[self.right] += force
            self.velocity += kick * self.dt * self.free / masses
            penetration = self.penetration()
            self.displacement += self.dt * self.velocity
            if self.massless_ends:
                self.place_ends()
            drift = self.penetration() - penetration
            work -= force * (last_drift + drift) / 2
            last_drift = drift
            forces.append(force)
        left, right = (np.average(self.velocity[bar], weights=self.mass[bar]) for bar in bars)
        return right - left, self.dt * np.arange(len(forces)), np.array(forces), 2 * work * sum(totals) / np.prod(totals)

    def place_ends(self):
        """Ends without mass are in equilibrium: free, or pressed with equal forces."""
        u, left, right = self.displacement, self.left, self.right
        u[left], u[right] = u[left - 1], u[right + 1]
        if u[left] > u[right]:
            stiffness = self.stiffness[[left - 1, right]]
            u[left] = u[right] = stiffness @ u[[left - 1, right + 1]] / stiffness.sum()


class Penalty:
    """The penalty of this program with its energy-neutral first and last steps, eqs. (16) to (19)."""

    def __init__(self, penalty):
        self.penalty, self.stored = penalty, None

    def __call__(self, bars, kick):
        p, before, tau = bars.penetration(), bars.approach(), kick * bars.mobility
        if p <= 1e-14:
            self.stored = None
            return 0.0
        k = 2 * self.penalty / bars.mobility  # eq. (42) in general: 2 s m_red/dt^2
        free = bars.free_approach(kick)
        force = k * p
        if self.stored is None:
            force, self.stored = first_force(force, p, before, free, tau), 0.0
        elif p + free - tau * force <= 0:
            drift = -(before + free) / 2  # D of eq. (17)
            force = min((-drift + np.sqrt(drift**2 + 2 * tau * self.stored)) / tau, 4 * force)
        self.stored += force * (before + free - tau * force) / 2
        return force


def first_force(force, p, before, free, tau):
    """Eq. (18) with U = 0: the work of this force is the energy of the spring in the next half step."""
    b, c = before + free + force * tau, force * (p + free)
    return np.clip((b - np.sqrt(max(b**2 - 4 * tau * c, 0))) / (2 * tau), 0, force)


def rigid(bars, kick):
    """One velocity while they press: loses the energy of the ends' relative motion."""
    return max(bars.free_approach(kick) / (kick * bars.mobility), 0) if bars.penetration() > 1e-12 else 0.0


def no_gap(bars, kick):
    """The force after which the gap is 0 (Heinstein et al. 2000), where the bars penetrate."""
    p = bars.penetration()
    return max((p + bars.free_approach(kick)) / (kick * bars.mobility), 0) if p > 1e-12 else 0.0


def without_mass(bars, kick):
    """Ends without mass (Doyen, Ern and Piperno 2011): the force of the pressed elements, which the nodes beside have already."""
    return max(-bars.stiffness[bars.left - 1] * (bars.displacement[bars.left] - bars.displacement[bars.left - 1]), 0)


class Bipenalty:
    """Eq. (44), implicit in the penetration after the step."""

    def __init__(self, penalty):
        self.penalty, self.pressed = penalty, False

    def __call__(self, bars, kick):
        p = bars.penetration()
        k = 2 * self.penalty / bars.mobility
        change = bars.free_approach(kick) - bars.approach()  # F = k p + k/4 (change - tau F)
        force = (k * p + k / 4 * change) / (1 + k / 4 * kick * bars.mobility)
        self.pressed = force > 0 and (self.pressed or p > 1e-12)
        return force if self.pressed else 0.0


# name, joint, c dt/h, first gap over the first drift
JOINTS = [("penalty 0.5, 0.8", lambda: Penalty(0.5), 0.8, 0), ("penalty 0.9, 0.63: the default", lambda: Penalty(0.9), 0.63, 0),
          ("end nodes without mass, theirs on the next ones (Doyen, Ern and Piperno 2011), 0.63", lambda: without_mass, 0.63, 0),
          ("rigid: one velocity while they press, 0.3", lambda: rigid, 0.3, 0), ("rigid, 0.63", lambda: rigid, 0.63, 0),
          ("rigid, 0.98", lambda: rigid, 0.98, 0),
          ("force by which the gap after the step is 0 (Heinstein et al. 2000), 0.63", lambda: no_gap, 0.63, 0),
          ("the same, bars that are apart by nearly the first drift", lambda: no_gap, 0.63, 0.99),
          ("eq. (44), s = 1, 0.9", lambda: Bipenalty(1.0), 0.9, 0), ("eq. (44), s = 4, 0.9", lambda: Bipenalty(4.0), 0.9, 0)]


def collide(n, length, modulus, exact, make_joint, courant, gap=0.0):
    """(error of the restitution, error of the time of contact of equal bars from the first force and from t = 0, work of the
    contact over the energy of the relative motion, oscillation of the force about its mean)"""
    bars = Bars(n, length, modulus, courant, massless_ends=make_joint() is without_mass)
    bars.displacement[bars.right:] = gap * bars.dt
    restitution, times, forces, work = bars.collide(make_joint())
    pressed = times[forces > 0]
    plateau = forces[(times > 0.5) & (times < 1.5)]
    return np.array([restitution / exact - 1, np.ptp(pressed) / 2 - 1, pressed[-1] / 2 - 1, work,
                     np.ptp(plateau) / 2 / plateau.mean()])


def compare(bars):
    """Rows of a table, a joint each: means over nine steps within 3 %, since results depend on the phase of the joint's vibration.
    `bars` maps names to length and modulus of the right bar and the exact restitution; the first are equal bars."""
    def percent(values):
        return " / ".join(f"{round(100 * value, 1) + 0.0:+.1f}" for value in values)
    rows = []
    for name, make_joint, courant, gap in JOINTS:
        mean = {(n, label): np.mean([collide(n, *bar, make_joint, courant * (1 + 0.0075 * i), gap) for i in range(-4, 5)
                                     if courant * (1 + 0.0075 * i) < 1], axis=0)
                for index, (label, bar) in enumerate(bars.items()) for n in ((20, 40) if index else (20, 40, 80))}
        equal = [mean[n, next(iter(bars))] for n in (20, 40, 80)]
        rows.append([name, *(percent(mean[n, label][0] for n in (20, 40)) for label in bars),
                     *(percent(figures[i] for figures in equal) for i in (1, 2, 3)), f"{100 * equal[-1][4]:.0f}"])
    return ["joint, and dt c/h", *(f"e, {label}" for label in bars), "time from the first force", "time from t = 0", "work",
            "oscillation of the force"], rows
