#!/usr/bin/python3
"""harnesses_test.py BRICKWALL BUILD: the files of verification/performance/harnesses with stand-ins for Spack, Ramble, Benchpark and
ReFrame: options that CMake knows, commands that run, expressions that match what the program prints."""
import importlib.util
import json
import re
import shlex
import subprocess
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
HARNESSES = ROOT / "verification/performance/harnesses"
brickwall, build = sys.argv[1:3]


def stand_in(name, **content):
    """Makes `name` importable, with its parents."""
    words = name.split(".")
    for i in range(1, len(words) + 1):
        module = sys.modules.setdefault(".".join(words[:i]), types.ModuleType(words[i - 1]))
        module.__dict__.update(__all__=list(content), **content if i == len(words) else {})
        if i > 1:
            setattr(sys.modules[".".join(words[:i - 1])], words[i - 1], module)


class Directives:
    """Records calls, by the name of the function."""

    def __init__(self, *names):
        self.calls = {name: [] for name in names}
        self.functions = {name: lambda *words, _to=calls, **options: _to.append((words, options)) for name, calls in self.calls.items()}

    def first_words(self, name):
        return [words[0] for words, _ in self.calls[name]]


def load(path):
    specification = importlib.util.spec_from_file_location("harness", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def output_of(command, folder):
    """What a command with `{variables}` already replaced prints."""
    done = subprocess.run(command if isinstance(command, list) else shlex.split(command), capture_output=True, text=True, cwd=folder, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Spec:
    """A spec such as "+openmp ~cuda", of which satisfies() asks single words."""

    def __init__(self, words, **variants):
        self.words, self.variants = words.split(), variants

    def satisfies(self, word):
        return word in self.words


class HarnessTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def matches(self, pattern, text):
        found = [match for line in text.splitlines() if (match := re.match(pattern, line))]
        self.assertEqual(len(found), 1, (pattern, text))
        return found[0]


class SpackPackage(HarnessTest):
    def setUp(self):
        super().setUp()
        self.directives = Directives("version", "variant", "depends_on", "conflicts", "license")
        base = type("CMakePackage", (), {"define": lambda self, name, value: (name, value),
                                         "define_from_variant": lambda self, name, variant: (name, variant)})
        stand_in("spack.package", **self.directives.functions)
        stand_in("spack_repo.builtin.build_systems.cmake", CMakePackage=base)
        stand_in("spack_repo.builtin.build_systems.cuda", CudaPackage=type("CudaPackage", (), {"cuda_arch_values": ("90", "100")}))
        self.package = load(HARNESSES / "spack_repo/brickwall/packages/brickwall/package.py").Brickwall

    def arguments(self, spec):
        package = type("Package", (self.package,), {"__getitem__": lambda self, name: types.SimpleNamespace(kokkos_cxx="nvcc_wrapper")})()
        package.spec = Spec(spec)
        return dict(package.cmake_args())

    def test_names_options_that_cmake_knows(self):
        known = {line.split(":")[0] for line in (Path(build) / "CMakeCache.txt").read_text().splitlines() if ":" in line}
        for spec, space in (("+openmp", "OpenMP"), ("", "Serial"), ("+openmp +cuda", "Cuda")):
            arguments = self.arguments(spec)
            self.assertEqual(arguments["BRICKWALL_EXECUTION_SPACE"], space)
            self.assertLessEqual(set(arguments), known)
            for name in ("BUILD_TESTING", "BRICKWALL_ADIAK"):
                self.assertIn(arguments[name], self.directives.first_words("variant"))

    def test_names_what_cmake_looks_for(self):
        package_of = {"MPI": "mpi", "Kokkos": "kokkos", "Zoltan": "seacas", "SEACASExodus": "seacas", "nlohmann_json": "nlohmann-json",
                      "toml11": "toml11", "CLI11": "cli11", "GTest": "googletest", "Threads": "c", "adiak": "adiak"}
        text = "".join((ROOT / name).read_text() for name in ("CMakeLists.txt", "cmake/BrickwallDependencies.cmake"))
        needed = {package_of[name] for name in re.findall(r"find_package\((\w+)[^)]*\bREQUIRED", text)}
        named = {re.match(r"[\w-]+", spec)[0] for spec in self.directives.first_words("depends_on")}
        self.assertEqual(needed, named - {"cxx", "cmake"})

    def test_builds_the_clone_that_holds_it(self):
        self.assertEqual(self.package.git, ROOT.as_uri())
        self.assertEqual(self.directives.calls["version"], [(("main",), {"branch": "main"})])


class RambleApplication(HarnessTest):
    def setUp(self):
        super().setUp()
        self.directives = Directives("tags", "software_spec", "required_package", "executable", "workload", "workload_variable",
                                     "figure_of_merit", "success_criteria")
        stand_in("ramble.appkit", ExecutableApplication=object, **self.directives.functions)
        load(HARNESSES / "ramble_repo/applications/brickwall/application.py")
        self.variables = {words[0]: options["default"] for words, options in self.directives.calls["workload_variable"]}
        (self.folder / "bin").mkdir()
        (self.folder / "share/brickwall").mkdir(parents=True)
        (self.folder / "bin/brickwall").symlink_to(brickwall)
        (self.folder / "share/brickwall/inputs").symlink_to(ROOT / "inputs")  # as cmake --install does

    def run_small(self, executable):
        command = next(words[1] for words, _ in self.directives.calls["executable"] if words[0] == executable)
        values = {**self.variables, "steps": "3", "bricks_along": "2", "brickwall_path": str(self.folder), "experiment_run_dir": str(self.folder)}
        for _ in range(2):  # a default names another variable
            command = re.sub(r"{(\w+)}", lambda match: values[match[1]], command)
        return output_of(command, self.folder)

    def rates(self, text):
        patterns = {words[0]: options["fom_regex"] for words, options in self.directives.calls["figure_of_merit"]}
        return {name: float(match["rate"]) for name, pattern in patterns.items() for line in text.splitlines() if (match := re.match(pattern, line))}

    def test_runs_print_one_figure_of_each_kind_and_one_verdict(self):
        for executable, file, names in (("run", "report.json", ("element steps per second", "face searches per second")),
                                        ("search", "search.json", ("face searches per second",))):
            text = self.run_small(executable)
            rates, fom = self.rates(text), json.loads((self.folder / "results" / file).read_text())["fom"]
            self.assertEqual(tuple(rates), names)
            for name, rate in rates.items():  # printed with six digits
                self.assertAlmostEqual(rate, fom[name.replace(" ", "_")], delta=1e-5 * rate)
            (_, criteria), = self.directives.calls["success_criteria"]
            self.matches(criteria["match"], text)

    def test_benchpark_scales_what_the_application_takes(self):
        modes = types.SimpleNamespace(Strong="strong", Weak="weak", Throughput="throughput")
        recorded = {}

        class Scaling:
            def register_scaling_config(self, config):
                recorded.update(config)

        class Experiment:
            name = "brickwall"

            def __init__(self, spec):
                self.spec, self.values, self.required = spec, {}, {}

            def add_experiment_variable(self, name, value, named):
                self.values[name] = value

            def set_required_variables(self, **values):
                self.required = values

            def set_environment_variable(self, name, value):
                self.environment = {name: value}

        stand_in("benchpark.directives", variant=lambda *words, **options: None)
        stand_in("benchpark.experiment", Experiment=Experiment)
        for name, kind in (("cuda", "CudaExperiment"), ("mpi", "MpiOnlyExperiment"), ("openmp", "OpenMPExperiment")):
            stand_in(f"benchpark.{name}", **{kind: type(kind, (), {})})
        stand_in("benchpark.scaling", ScalingMode=modes, Scaling=lambda *_: Scaling)
        kind = load(HARNESSES / "benchpark_experiment.py").Brickwall
        for words, own in (("exec_mode=test", {"n_ranks"}), ("+openmp", {"n_ranks", "n_threads_per_proc"}), ("+cuda", {"n_gpus"})):
            experiment = kind(Spec(words))
            experiment.compute_applications_section()
            self.assertLessEqual(set(experiment.values) - own - {"resources"}, set(self.variables))
        expected = {"strong": ((2, 4), (15, 15)), "weak": ((2, 4), (30, 60)), "throughput": ((1, 1), (30, 60))}
        for mode, functions in recorded.items():
            found = []
            for name, function in functions.items():
                values = [experiment.values[name]]
                for iteration in range(2):
                    values.append(function(types.SimpleNamespace(val=lambda dimension: values[-1]), iteration, 0, 2))
                found.append(tuple(values[1:]))
            self.assertEqual(tuple(found), expected[mode])
        # The stated size is that of the run.
        self.run_small("run")
        elements = json.loads((self.folder / "results/report.json").read_text())["elements"]
        self.assertEqual(eval(experiment.required["total_problem_size"].format(bricks_along=2)), elements)


class ReframeTest(HarnessTest):
    def test_runs_are_judged_and_measured(self):
        same = lambda function: function
        stand_in("reframe", simple_test=same, RunOnlyRegressionTest=object)
        stand_in("reframe.utility.sanity", assert_found=self.matches,
                 extractsingle=lambda pattern, text, group, kind: kind(self.matches(pattern, text)[group]))
        # ReFrame puts these into the body of the class.
        in_classes = {"variable": lambda kind, value: value, "parameter": same, "sanity_function": same, "run_after": lambda stage: same,
                      "performance_function": lambda unit: same}
        with mock.patch.multiple("builtins", create=True, **in_classes):
            kind = load(HARNESSES / "reframe_brickwall.py").Brickwall
        for command in kind.command:
            test = kind()
            test.program, test.command, test.ranks, test.bricks_along, test.env_vars = brickwall, command, 1, 2, {}
            test.set_up()
            text = test.stdout = output_of(" ".join([test.executable, *test.executable_opts]), self.folder)
            test.passes()
            self.assertGreater(test.rate(), 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
