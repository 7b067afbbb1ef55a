"""V7: A cantilever of 10 x 1 x 1 (E = rho = 1, nu = 0.3), clamped at one end, starts with a
rotation about the clamp and vibrates. The angular frequency of its first bending mode is 0.010114
in converged three-dimensional elasticity (0.010150 for the Euler-Bernoulli beam, which has neither
shear deformation nor a clamped cross-section). Elements that lock in bending are far too stiff with
one element through the depth. The strain of bending is linear over the depth; its variation within
elements is hourglass energy, 1/n^2 of the whole with n elements through the depth."""
from framework.figures import draw_slope
from framework.meshes import box
from framework.signals import fit_frequency, tip_deflection

NAME = "V7"
TITLE = "cantilever's first bending frequency"
DECK = "v07_cantilever.toml"
SECONDS = 100
CONVERGED = 0.010114  # to 1e-6; 0.0101216 and 0.0101178 of 80 x 8 x 8 and 160 x 16 x 16 elements give 0.0101139 with order 1
MESHES = [(10, 1, 1), (10, 2, 2), (20, 2, 2), (40, 4, 4), (80, 8, 8)]


def frequency(lab, elements, element="one_point"):
    """(angular frequency, times, mean deflection of the free end, peak hourglass over peak internal energy)."""
    run = lab.run(f"{element}_{'x'.join(map(str, elements))}", {"element.formulation": element},
                  mesh=box((10, 1, 1), elements, name="beam"))
    results = run.results
    deflection = tip_deflection(results)
    share = run.history["hourglass_energy"].max() / run.history["internal_energy"].max()
    return fit_frequency(results.times, deflection, CONVERGED), results.times, deflection, share


def evaluate(lab):
    meshes = MESHES[:4] if lab.quick else MESHES
    found = {elements: frequency(lab, elements) for elements in meshes}
    errors = {elements: omega / CONVERGED - 1 for elements, (omega, *_) in found.items()}
    lab.check(found[10, 1, 1][0], CONVERGED, 0.01)
    for elements in meshes[1:]:  # elements twice as long as deep are the stiffest
        lab.check(found[elements][0], CONVERGED, 0.013 if elements == (10, 2, 2) else 0.01, "x".join(map(str, elements)))
    series = meshes[1:]  # two and more elements resolve bending; one element has an error of the opposite sign
    series = [elements for elements in series if elements != (10, 2, 2)]
    if not lab.quick:
        # The singularity at the clamp allows order 1 only.
        lab.check_order([1 / m[2] for m in series], [errors[m] for m in series], least=0.7, exact=1)
    for elements in ((10, 1, 1), (20, 2, 2), (40, 4, 4)):
        # Shear has about 3.6 E I/(G A L^2) = 1 % of the energy, the clamp's singularity some.
        lab.check(found[elements][3], 1 / elements[2]**2, 0.05, f"hourglass_share_{elements[2]}")
    full = {elements: frequency(lab, elements, "full")[0] / CONVERGED - 1 for elements in meshes[:3]}
    lab.table("Relative errors of the frequency:", ["elements", "one_point", "full (2x2x2 points)", "hourglass share"],
              [["x".join(map(str, m)), errors[m], full.get(m, ""), found[m][3]] for m in meshes])
    with lab.figure("Deflection of the free end; error of the frequency", panels=2) as (tip, error):
        _, times, deflection, _ = found[10, 1, 1]
        tip.plot(times, deflection, label="10x1x1", linewidth=1)
        tip.set(xlabel="t", ylabel="u_z")
        sizes = [1 / m[2] for m in series]
        error.loglog(sizes, [abs(errors[m]) for m in series], "o-", label="one_point")
        draw_slope(error, sizes, [abs(errors[m]) for m in series], 1)
        error.set(xlabel="element size / depth", ylabel="relative error")
