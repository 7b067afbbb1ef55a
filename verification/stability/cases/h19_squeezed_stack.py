"""H19: Three equal cubes between rigid plates are squeezed by 30 %; the one in the middle stands a
thousandth of an edge beside the others. With friction no contact may open or be released. Without
friction the cube in the middle slips out, like wet soap: beside the others it carries less, so the
stack releases energy. That is no error of contact: the energy stays, and a finer mesh slips
earlier. Walls whose bricks are all pressed at the start by 16, 23 and 30 % keep their contacts and
their energy too."""
import numpy as np
from _hard import energy_change
from framework.meshes import box, together

NAME = "H19"
TITLE = "squeezed stack"
DECK = "h19_squeezed_stack.toml"
SECONDS = 30
OFFSET, COMPRESSION = 1e-3, 0.3


def squeeze(lab, name, elements, settings):
    mesh = together(*(box((1, 1, 1), (elements,) * 3, (OFFSET * (block == "middle"), 0, z), block)
                      for z, block in enumerate(("low", "middle", "high"))))
    run = lab.run(name.replace(" ", "_").replace(",", ""), settings, mesh=mesh)
    history, results = run.history, run.results
    middle = results.nodes_of_block(1)
    slip = max(np.abs(results.nodal("displacement", step)[middle, 0].mean()) for step in range(len(results.times)))
    pressed = history["contacts"][len(history["contacts"]) // 3:]  # both joints are closed by then
    return [name, np.abs(energy_change(history)).max(), slip, int(pressed.min()), int(pressed.max()), int(history["lost_contacts"][-1])]


def evaluate(lab):
    fine = 8 if not lab.quick else 6
    slow = {"contact.friction": 0.0, "boundary.velocity[0].velocity": (0, 0, -0.005), "time.end": 50.0}
    held = [squeeze(lab, f"friction 0.05, nu = {poisson}", 4, {f"material.{block}.poissons_ratio": poisson for block in
                                                               ("low", "middle", "high")})
            for poisson in ((0.0,) if lab.quick else (0.0, 0.3))]
    slipping = [squeeze(lab, f"no friction, {elements} elements", elements, slow) for elements in (4, fine)]
    lab.check(max(row[1] for row in held), 0, 1e-3)
    lab.check(max(row[2] for row in held), 0, 0.01, "slip_with_friction")
    lab.check(max(abs(row[3] - row[4]) for row in held), 0, 0, "contacts_that_open_with_friction")
    lab.check(max(row[1] for row in slipping), 0, 5e-3, "energy_while_it_slips_out")
    lab.require(slipping[1][2] > slipping[0][2] > 0.1, "a_finer_mesh_slips_farther")
    pressed = []
    for compression in (0.16, 0.23, 0.3):
        run = lab.run(f"wall_{compression}", {"initial.deformation[0].gradient": (0.0,) * 8 + (-compression,)},
                      deck=lab.deck_path.with_name("h19_pressed_wall.toml"))
        history = run.history
        pressed.append([compression, np.abs(energy_change(history)).max(), int(history["contacts"].max()),
                        history["max_penetration"].max(), int(history["lost_contacts"][-1])])
    lab.check(max(row[1] for row in pressed), 0, 5e-3, "energy_of_pressed_walls")
    lab.check(max(row[-1] for row in held + slipping + pressed), 0, 0, "contacts_lost")
    lab.table(f"Stacks, squeezed by {100 * COMPRESSION:.0f} % with friction, by 8 % without:",
              ["stack", "energy, largest", "slip", "least contacts", "most contacts", "contacts lost"], held + slipping)
    lab.table("Walls pressed at the start:", ["compression", "energy, largest", "most contacts", "deepest / face", "contacts lost"],
              pressed)
