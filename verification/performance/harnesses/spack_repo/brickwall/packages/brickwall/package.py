"""The Spack package; verification/performance/harnesses/README.md."""
from pathlib import Path

from spack_repo.builtin.build_systems.cmake import CMakePackage
from spack_repo.builtin.build_systems.cuda import CudaPackage

from spack.package import *


class Brickwall(CMakePackage, CudaPackage):
    """Coupled explicit-dynamics mini-app: bricks of hexahedra, an MPI+X contact global search in Kokkos in every time step, and
    energy-neutral contact forces."""

    # The clone that holds this file: nothing is published yet, so that there is neither a host nor a checksum to name.
    git = Path(__file__).resolve().parents[7].as_uri()
    homepage = git
    tags = ["proxy-app"]
    license("BSD-3-Clause")

    version("main", branch="main")

    variant("openmp", default=True, description="Run on the cores of a rank with OpenMP")
    variant("adiak", default=False, description="Give the figures of a run to Adiak, whose metadata Caliper records")
    variant("tests", default=False, description="Build the tests")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("mpi")
    depends_on("kokkos@3.4:4")
    depends_on("kokkos+openmp", when="+openmp")
    depends_on("kokkos+serial", when="~openmp")
    depends_on("kokkos+wrapper", when="+cuda")
    for arch in CudaPackage.cuda_arch_values:
        depends_on(f"kokkos+cuda cuda_arch={arch}", when=f"+cuda cuda_arch={arch}")
    depends_on("seacas+mpi+applications")  # Exodus, epu, exodiff and, as one of its packages, Zoltan
    depends_on("nlohmann-json@3")
    depends_on("toml11@3")
    depends_on("cli11@2")
    depends_on("adiak+mpi", when="+adiak")
    depends_on("googletest", when="+tests")
    conflicts("+cuda", when="cuda_arch=none", msg="name the GPU, such as cuda_arch=90")

    def cmake_args(self):
        space = "Cuda" if self.spec.satisfies("+cuda") else "OpenMP" if self.spec.satisfies("+openmp") else "Serial"
        arguments = [
            self.define_from_variant("BUILD_TESTING", "tests"),
            self.define_from_variant("BRICKWALL_ADIAK", "adiak"),
            self.define("BRICKWALL_NATIVE", False),  # Spack's compiler wrappers add the flags of the target
            self.define("BRICKWALL_EXECUTION_SPACE", space),
        ]
        if space == "Cuda":
            arguments.append(self.define("CMAKE_CXX_COMPILER", self["kokkos"].kokkos_cxx))
        return arguments
