"""H3: Young's moduli 1 and 1000. A soft bar runs into a stiff one: the stress is Z1 Z2 v/(Z1 + Z2), Z = sqrt(rho E), until the
first wave returns; both have the same elements, so the stiff bar sets a step of a thirtieth of what the soft one needs. A contact
stiffness from the moduli would be too weak or too strong; that from masses and the step is stable by construction. Then blocks of
such moduli run into each other askew."""
from _contrast import bars, draw, impacts

NAME = "H3"
TITLE = "stiffness contrast of 1000"
DECK = "h03_stiffness_contrast.toml"
SECONDS = 20


def evaluate(lab):
    run = bars(lab, 31.65)  # its wave takes as long
    impacts(lab, "h03_impact.toml")
    draw(lab, run)
