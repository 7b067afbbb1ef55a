"""Exodus files by netCDF4: writes meshes of hexahedra and reads the program's results."""
import netCDF4
import numpy as np

from brickwall_plot.exodus import HEX_SIDES, ExodusResults

# Offsets of the corners of a hex8 from the first one, in the order of Exodus, counted from 0.
HEX_CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
NAME_LENGTH = 33  # with the terminating zero


def write_mesh(path, mesh):
    """Writes a `meshes.Mesh`: one block for each name in mesh.blocks, its node sets and side
    sets."""
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.setncatts({"title": "written by verification/framework", "api_version": np.float32(5.1),
                        "version": np.float32(5.1), "floating_point_word_size": np.int32(8), "file_size": np.int32(1)})
        for name, length in (("len_string", NAME_LENGTH), ("len_name", NAME_LENGTH), ("num_dim", 3), ("time_step", None),
                             ("num_nodes", len(mesh.nodes)), ("num_elem", len(mesh.hexes)),
                             ("num_el_blk", len(mesh.blocks))):
            file.createDimension(name, length)
        file.createVariable("time_whole", "f8", ("time_step",))
        for axis, values in zip("xyz", mesh.nodes.T):
            file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values
        _write_names(file, "coor_names", "num_dim", "xyz")
        _write_ids(file, "eb", "num_el_blk", list(mesh.blocks))
        for number, hexes in enumerate(mesh.hexes_by_block(), 1):
            file.createDimension(f"num_el_in_blk{number}", len(hexes))
            file.createDimension(f"num_nod_per_el{number}", 8)
            connect = file.createVariable(f"connect{number}", "i4", (f"num_el_in_blk{number}", f"num_nod_per_el{number}"))
            connect.elem_type = "HEX8"
            connect[:] = hexes + 1
        _write_sets(file, "ns", "node", {name: {"node": nodes + 1} for name, nodes in mesh.node_sets.items()})
        _write_sets(file, "ss", "side", {name: {"elem": sides[:, 0] + 1, "side": sides[:, 1] + 1}
                                         for name, sides in mesh.side_sets.items()})


def _write_ids(file, kind, dimension, names):
    file.createVariable(f"{kind}_status", "i4", (dimension,))[:] = 1
    ids = file.createVariable(f"{kind}_prop1", "i4", (dimension,))
    ids.setncattr("name", "ID")  # netCDF4 reserves plain assignment of `name`
    ids[:] = np.arange(1, len(names) + 1)
    _write_names(file, f"{kind}_names", dimension, names)


def _write_names(file, variable, dimension, names):
    text = np.zeros((len(names), NAME_LENGTH), dtype="S1")
    for row, name in zip(text, names):
        row[:len(name)] = list(name)
    file.createVariable(variable, "S1", (dimension, "len_name"))[:] = text


def _write_sets(file, kind, word, sets):
    sets = {name: columns for name, columns in sets.items() if len(next(iter(columns.values())))}
    if not sets:
        return
    file.createDimension(f"num_{word}_sets", len(sets))
    _write_ids(file, kind, f"num_{word}_sets", list(sets))
    for number, columns in enumerate(sets.values(), 1):
        dimension = f"num_nod_ns{number}" if kind == "ns" else f"num_side_ss{number}"
        file.createDimension(dimension, len(next(iter(columns.values()))))
        for column, values in columns.items():
            file.createVariable(f"{column}_{kind}{number}", "i4", (dimension,))[:] = values


class Results(ExodusResults):
    """Mesh and fields of a results file of one rank, or of a joined one. Steps count from 0; -1 is
    the last."""

    def __init__(self, path):
        super().__init__(path)
        self.file = self.files[0]
        self.variables = self.file.variables

    def stress(self, step=-1):
        """Cauchy stress [element][3][3]."""
        order = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "yz": (1, 2), "zx": (2, 0)}
        sigma = np.empty((len(self.hexes), 3, 3))
        for name, (i, j) in order.items():
            sigma[:, i, j] = sigma[:, j, i] = self.element(f"stress_{name}", step)
        return sigma

    def centroids(self):
        return self.nodes[self.hexes].mean(axis=1)

    def nodes_of_block(self, block):
        """The nodes of a block, ascending; blocks count from 0."""
        return np.unique(self.hexes_of_block[block])
