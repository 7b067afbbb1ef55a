"""H4: Densities 1 and 1000. A light bar hits a dense one: the stress is Z1 Z2 v/(Z1 + Z2), Z =
sqrt(rho E), until the first wave returns. Then blocks of these densities collide obliquely."""
from _contrast import bars, draw, impacts

NAME = "H4"
TITLE = "density contrast of 1000"
DECK = "h04_density_contrast.toml"
SECONDS = 20


def evaluate(lab):
    run = bars(lab, 1.0)
    impacts(lab, "h04_impact.toml")
    draw(lab, run)
