"""The Benchpark experiment, experiments/brickwall/experiment.py there; README.md beside this file."""
from benchpark.cuda import CudaExperiment
from benchpark.directives import variant
from benchpark.experiment import Experiment
from benchpark.mpi import MpiOnlyExperiment
from benchpark.openmp import OpenMPExperiment
from benchpark.scaling import Scaling, ScalingMode


def keep(variable, iteration, dimension, factor):
    return variable.val(dimension)


def grow(variable, iteration, dimension, factor):
    return variable.val(dimension) * factor


class Brickwall(Experiment, MpiOnlyExperiment, OpenMPExperiment, CudaExperiment,
                Scaling(ScalingMode.Strong, ScalingMode.Weak, ScalingMode.Throughput)):
    variant("workload", default="wall", values=("wall", "search"), description="coupled steps, or the search alone")
    variant("version", default="main", description="version of the Spack package")

    def compute_applications_section(self):
        self.add_experiment_variable("resources", 1, False)
        self.add_experiment_variable("bricks_along", 2 if self.spec.satisfies("exec_mode=test") else 15, True)
        # A wall of 29 courses of bricks with 8 x 4 x 4 elements grows along its length.
        self.register_scaling_config({
            ScalingMode.Strong: {"resources": grow, "bricks_along": keep},
            ScalingMode.Weak: {"resources": grow, "bricks_along": grow},
            ScalingMode.Throughput: {"resources": keep, "bricks_along": grow}})
        self.set_required_variables(n_resources="{resources}", total_problem_size="{bricks_along}*29*8*4*4",
                                    process_problem_size="{bricks_along}*29*8*4*4/{resources}")
        if self.spec.satisfies("+openmp"):
            self.add_experiment_variable("n_threads_per_proc", 1, True)
            self.set_environment_variable("OMP_NUM_THREADS", "{n_threads_per_proc}")
        self.add_experiment_variable("n_gpus" if self.spec.satisfies("+cuda") else "n_ranks", "{resources}", True)

    def compute_package_section(self):
        self.add_package_spec(self.name, [f"brickwall@{self.spec.variants['version'][0]}"])
