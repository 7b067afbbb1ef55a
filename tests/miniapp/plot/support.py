"""Scenes of the tests of brickwall-plot: meshes of verification/framework, with fields."""
import sys
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "verification"), str(ROOT / "miniapp" / "plot")]
import matplotlib

matplotlib.use("Agg")
import netCDF4
import numpy as np
from framework.exodus import _write_names, write_mesh
from framework.meshes import box, together

__all__ = ["ROOT", "box", "cubes", "np", "together", "write_results"]


def cubes(*origins, size=(1, 1, 1), elements=(1, 1, 1)):
    """Blocks of one size that share no nodes."""
    return together(*(box(size, elements, origin, f"cube{i}") for i, origin in enumerate(origins)))


def write_results(path, mesh, times=(0.0,), nodal=None, element=None):
    """An Exodus file with {name: [step][node]} and {name: [step][element]}."""
    write_mesh(path, mesh)
    with netCDF4.Dataset(path, "r+") as file:
        file["time_whole"][:] = times
        for kind, fields in (("nod", nodal or {}), ("elem", element or {})):
            if not fields:
                continue
            file.createDimension(f"num_{kind}_var", len(fields))
            _write_names(file, f"name_{kind}_var", f"num_{kind}_var", list(fields))
            for number, values in enumerate(fields.values(), 1):
                if kind == "nod":
                    file.createVariable(f"vals_nod_var{number}", "f8", ("time_step", "num_nodes"))[:] = values
                    continue
                ends = np.cumsum(list(mesh.blocks.values()))[:-1]
                for block, part in enumerate(np.split(np.asarray(values, dtype=float), ends, axis=1), 1):
                    file.createVariable(f"vals_elem_var{number}eb{block}", "f8", ("time_step", f"num_el_in_blk{block}"))[:] = part
    return str(path)
