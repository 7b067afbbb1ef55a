"""The command and the environment that start a run on ranks and threads."""
import numbers
import os
import shlex
from pathlib import Path


def launcher(program):
    """Words before "-n RANKS": BRICKWALL_MPIEXEC, the mpiexec of the program's build, or that of the PATH."""
    if os.environ.get("BRICKWALL_MPIEXEC"):
        return shlex.split(os.environ["BRICKWALL_MPIEXEC"])
    cache = Path(program).resolve().parent.parent / "CMakeCache.txt"
    for line in cache.read_text().splitlines() if cache.exists() else ():
        if line.startswith("MPIEXEC_EXECUTABLE:"):
            return [line.split("=", 1)[1]]
    return ["mpiexec"]


def environment(ranks, threads, cores):
    """Variables of a run, as run.sh sets them; those that the user has set stay. Threads are bound to cores only if no
    other rank would take the same ones, and wait without spinning if they share cores."""
    found = {"OMP_NUM_THREADS": str(threads)}
    usual = {"OMP_PLACES": "cores", "OMP_PROC_BIND": "close" if ranks == 1 and threads <= cores else "false",
             "OMPI_MCA_hwloc_base_binding_policy": "none", "PRTE_MCA_hwloc_default_binding_policy": "none",
             "OMPI_MCA_rmaps_base_oversubscribe": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
             "OMPI_MCA_orte_execute_quiet": "1", "OMPI_MCA_odls_base_sigkill_timeout": "0"}
    usual.update({f"{name}_ALLOW_RUN_AS_ROOT{more}": "1" for name in ("OMPI", "PRTE") for more in ("", "_CONFIRM")})
    if ranks * threads > cores:
        usual.update({"OMP_WAIT_POLICY": "passive", "OMPI_MCA_mpi_yield_when_idle": "1", "KOKKOS_DISABLE_WARNINGS": "1"})
    return {**found, **{name: os.environ.get(name, value) for name, value in usual.items()}}


def spell(value):
    """A value for --set, in TOML. Numbers keep all their bits; a text stands without quotes, as the program takes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, dict):
        return "{" + ",".join(f"{key}={quoted(item)}" for key, item in value.items()) + "}"
    return "[" + ",".join(quoted(item) for item in value) + "]"


def quoted(value):
    """A value inside a list or a table."""
    return f'"{value}"' if isinstance(value, str) else spell(value)
