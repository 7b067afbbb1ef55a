"""H3: Young's moduli 1 and 1000. A soft bar hits a stiff one: the stress is Z1 Z2 v/(Z1 + Z2), Z =
sqrt(rho E), until the first wave returns. Both have the same elements, so the stiff bar sets a step
of a thirtieth of that of the soft one. A contact stiffness from the moduli would be too weak or too
strong; that from masses and the step is stable by construction. Then blocks of these moduli collide
obliquely."""
from _contrast import bars, draw, impacts

NAME = "H3"
TITLE = "stiffness contrast of 1000"
DECK = "h03_stiffness_contrast.toml"
SECONDS = 20


def evaluate(lab):
    run = bars(lab, 31.65)  # its wave returns at the same time
    impacts(lab, "h03_impact.toml")
    draw(lab, run)
