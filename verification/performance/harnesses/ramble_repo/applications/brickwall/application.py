"""The Ramble application, which Benchpark uses too; verification/performance/harnesses/README.md."""
from ramble.appkit import *

SIZE = "--set 'wall.bricks=[{bricks_along},1,{courses}]' --set 'wall.elements=[{elements},{half},{half}]'"
NUMBER = r"(?P<rate>[0-9.]+(e[+-]?[0-9]+)?)"


class Brickwall(ExecutableApplication):
    """A wall of bricks, all pressed, so that all joints are in contact; its size is given in integers."""

    name = "brickwall"

    tags("mini-app", "contact", "explicit-dynamics", "finite-elements", "kokkos", "mpi", "openmp", "cuda")

    software_spec("brickwall", pkg_spec="brickwall@main +openmp", package_manager="spack*")
    required_package("brickwall", package_manager="spack*")

    executable("run", "{brickwall_path}/bin/brickwall run {deck} -q -o {experiment_run_dir}/results --steps {steps} " + SIZE +
               " --set time.end=1e3 --set output.interval=0.0 --set output.history_interval=1e3 --set 'load.pressure[0].peak=0.0'"
               " --set 'initial.deformation[0].gradient=[-0.002,0,0,0,0,0,0,0,-0.002]'", use_mpi=True)
    executable("search", "{brickwall_path}/bin/brickwall search {deck} -q -o {experiment_run_dir}/results "
               "--set search.repetitions={steps} " + SIZE, use_mpi=True)

    workload("wall", executables=["run"])  # coupled steps
    workload("search", executables=["search"])  # the contact search alone

    for variable, default, meaning in (
            ("deck", "{brickwall_path}/share/brickwall/inputs/wall_17k.toml", "deck of a wall"),
            ("steps", "20", "time steps, or searches"),
            ("bricks_along", "15", "bricks along the wall"),
            ("courses", "29", "bricks upwards"),
            ("elements", "8", "elements along a brick"),
            ("half", "4", "elements across and upwards in a brick")):
        workload_variable(variable, default=default, description=meaning, workloads=["wall", "search"])

    # A run prints the first, a search the second.
    figure_of_merit("element steps per second", fom_regex="FOM element_steps_per_second=" + NUMBER, group_name="rate", units="1/s")
    figure_of_merit("face searches per second", fom_regex="FOM (element_steps_per_second=[^ ]+ )?face_searches_per_second=" + NUMBER,
                    group_name="rate", units="1/s")
    success_criteria("pass", mode="string", match="^PASS$", file="{log_file}")
