"""A ReFrame test: a pressed wall that grows with the ranks, coupled steps and the search alone; README.md beside this file."""
from pathlib import Path

import reframe as rfm
import reframe.utility.sanity as sn

DECK = Path(__file__).resolve().parents[3] / "inputs/wall_17k.toml"


@rfm.simple_test
class Brickwall(rfm.RunOnlyRegressionTest):
    descr = "Brickwall: coupled steps or searches of a wall of 15 bricks along for each rank"
    program = variable(str, value="brickwall")
    threads = variable(int, value=1)
    bricks_along = variable(int, value=15)  # of each rank
    command = parameter(["run", "search"])
    ranks = parameter([1, 2, 4])
    valid_systems = ["*"]
    valid_prog_environs = ["*"]

    @run_after("init")
    def set_up(self):
        self.executable = self.program
        self.num_tasks, self.num_cpus_per_task = self.ranks, self.threads
        self.env_vars["OMP_NUM_THREADS"] = self.threads
        settings = [f"wall.bricks=[{self.bricks_along * self.ranks},1,29]", "wall.elements=[8,4,4]"]
        if self.command == "run":
            settings += ["time.end=1e3", "output.interval=0.0", "output.history_interval=1e3", "load.pressure[0].peak=0.0",
                         "initial.deformation[0].gradient=[-0.002,0,0,0,0,0,0,0,-0.002]"]
        self.executable_opts = [self.command, str(DECK), "-q", "-o", "results", *(f"--set '{one}'" for one in settings)]

    @sanity_function
    def passes(self):
        return sn.assert_found(r"^PASS$", self.stdout)

    @performance_function("1/s")
    def rate(self):
        what = "element_steps" if self.command == "run" else "face_searches"
        return sn.extractsingle(rf"^FOM {what}_per_second=(\S+)", self.stdout, 1, float)
