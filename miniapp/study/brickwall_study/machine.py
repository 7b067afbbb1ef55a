"""The machine of a study: cores, memory, system and load, read from Linux."""
import os
import platform
import subprocess


def physical_cores():
    """The number of cores that this process may use; the hardware threads of a core count once."""
    usable = os.sched_getaffinity(0)
    try:
        text = subprocess.run(["lscpu", "-p=CPU,CORE,SOCKET"], capture_output=True, text=True, check=True).stdout
        rows = [line.split(",") for line in text.splitlines() if line and not line.startswith("#")]
        return len({(core, socket) for cpu, core, socket in rows if int(cpu) in usable}) or len(usable)
    except (OSError, subprocess.CalledProcessError, ValueError):
        return len(usable)


def memory_bytes(name):
    """"MemTotal" or "MemAvailable" of /proc/meminfo."""
    with open("/proc/meminfo") as file:
        for line in file:
            if line.startswith(name + ":"):
                return 1024 * int(line.split()[1])
    return 0


def system_name():
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except OSError:
        return platform.system()


def describe():
    return {
        "host": platform.node(),
        "system": system_name(),
        "kernel": platform.release(),
        "physical_cores": physical_cores(),
        "logical_cpus": len(os.sched_getaffinity(0)),
        "memory_bytes": memory_bytes("MemTotal"),
        "load_average": os.getloadavg()[0],
    }
