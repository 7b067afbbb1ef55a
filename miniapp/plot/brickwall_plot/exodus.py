"""Reads hexahedra and fields of Exodus files: of one file, or of the files of all ranks as if they were joined."""
import numpy as np

from .errors import PlotError
from .netcdf import open_netcdf

# Corners of the six sides of a hex8, counted from 0; normals point outward by the right-hand rule.
HEX_SIDES = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [0, 4, 7, 3], [0, 3, 2, 1], [4, 5, 6, 7]])


class ExodusResults:
    """Mesh and fields of one file (a path), or of the files of all ranks (a list of paths), in the order of the
    joined file: nodes and the elements of each block by their global numbers. Indices and steps count from 0; step
    -1 is the last. Raises PlotError for files that cannot be read."""

    def __init__(self, paths):
        self.paths = list(paths) if isinstance(paths, (list, tuple)) else [paths]
        self.files = [open_netcdf(path) for path in self.paths]
        blocks = len(self._dimension(0, "num_el_blk"))
        times = [self._all(f, "time_whole") if "time_whole" in file.variables else np.zeros(0)
                 for f, file in enumerate(self.files)]
        self.times = min(times, key=len)  # files of a running program may differ by a step
        self.names = {kind: self._text(f"name_{kind}_var") for kind in ("nod", "elem", "glo")}
        self._read_nodes()
        self.block_names = self._text("eb_names") or [""] * blocks
        self.hexes_of_block, self._order = [], []  # [element][corner]; None or the order by global number
        numbers = [self._numbers(f, "elem_num_map", len(self._dimension(f, "num_elem"))) for f in range(len(self.files))]
        first = [0] * len(self.files)
        for block in range(1, blocks + 1):
            hexes, ids = [], []
            for f in range(len(self.files)):
                corners = self._connectivity(f, block)
                hexes.append(self._local[f][corners] if self._local else corners)
                ids.append(numbers[f][first[f]:first[f] + len(corners)])
                first[f] += len(corners)
            self._order.append(np.argsort(np.concatenate(ids), kind="stable") if self._local else None)
            hexes = np.concatenate(hexes)
            self.hexes_of_block.append(hexes if self._order[-1] is None else hexes[self._order[-1]])
        if not sum(map(len, self.hexes_of_block)):
            raise PlotError(f"{self.paths[0]}: no hexahedra")
        self.hexes = np.concatenate(self.hexes_of_block)

    def nodal(self, name, step=-1):
        """[node] for the name of a scalar, [node][xyz] for that of a vector."""
        if self.is_vector(name):
            return np.stack([self.nodal(f"{name}_{axis}", step) for axis in "xyz"], axis=1)
        variable = f"vals_nod_var{self.names['nod'].index(name) + 1}"
        step = self.step(step)
        if not self._local:
            return self._at(0, variable, step)
        values = np.empty(len(self.nodes))
        for f, local in enumerate(self._local):
            values[local] = self._at(f, variable, step)
        return values

    def element(self, name, step=-1):
        """[element]; NaN in blocks without the variable."""
        variable, step = self.names["elem"].index(name) + 1, self.step(step)
        parts = []
        for block, hexes in enumerate(self.hexes_of_block, 1):
            key = f"vals_elem_var{variable}eb{block}"
            values = [self._at(f, key, step) for f, file in enumerate(self.files) if key in file.variables]
            values = np.concatenate(values) if values else np.full(len(hexes), np.nan)
            parts.append(values if self._order[block - 1] is None else values[self._order[block - 1]])
        return np.concatenate(parts)

    def is_vector(self, name):
        return all(f"{name}_{axis}" in self.names["nod"] for axis in "xyz")

    def step(self, step):
        """The number of a step, counted from 0. Raises PlotError if there is none."""
        number = step if step >= 0 else len(self.times) + step
        if not 0 <= number < len(self.times):
            raise PlotError(f"{self.paths[0]}: there is no step {step}; the steps of the file are 0 to {len(self.times) - 1}")
        return number

    def title(self):
        """The title of the file. epu drops it, but the information records hold the deck with its title."""
        for record in self._text("info_records"):
            key, _, value = record.partition("=")
            if key.strip() == "title":
                return value.split('"')[1] if value.count('"') >= 2 else value.strip()
        return getattr(self.files[0], "title", "").strip()

    def _read_nodes(self):
        coordinates = [self._coordinates(f) for f in range(len(self.files))]
        self._local = None  # for each rank file, the index of its nodes
        self.nodes = coordinates[0]  # [node][xyz]
        if len(self.files) > 1:
            numbers = [self._numbers(f, "node_num_map", len(xyz)) for f, xyz in enumerate(coordinates)]
            _, first, self._local = np.unique(np.concatenate(numbers), return_index=True, return_inverse=True)
            self._local = np.split(self._local, np.cumsum([len(ids) for ids in numbers])[:-1])
            self.nodes = np.concatenate(coordinates)[first]

    def _coordinates(self, f):
        if "coord" in self.files[f].variables:
            return self._all(f, "coord").T
        return np.stack([self._all(f, "coord" + axis) for axis in "xyz"], axis=1)

    def _connectivity(self, f, block):
        if f"connect{block}" not in self.files[f].variables:
            return np.zeros((0, 8), dtype=np.int64)  # a block without elements on this rank
        corners = self._all(f, f"connect{block}").astype(np.int64) - 1
        kind = getattr(self.files[f].variables[f"connect{block}"], "elem_type", "HEX")
        if corners.shape[1] != 8 or not kind.upper().startswith("HEX"):
            raise PlotError(f"{self.paths[f]}: block {block} has no 8-node hexahedra")
        if corners.size and not 0 <= corners.min() <= corners.max() < len(self._dimension(f, "num_nodes")):
            raise PlotError(f"{self.paths[f]}: the elements of block {block} name nodes that do not exist")
        return corners

    def _numbers(self, f, name, count):
        if name in self.files[f].variables:
            return self._all(f, name)
        if len(self.files) > 1:
            raise PlotError(f"{self.paths[f]}: files of ranks need the map {name}")
        return np.arange(count)

    def _dimension(self, f, name):
        if name not in self.files[f].dimensions:
            raise PlotError(f"{self.paths[f]}: no Exodus file: it has no dimension {name}")
        return self.files[f].dimensions[name]

    def _all(self, f, name):
        return self._at(f, name, slice(None))

    def _at(self, f, name, index):
        try:
            return np.array(self.files[f].variables[name][index])
        except (KeyError, IndexError, OSError, RuntimeError) as error:
            raise PlotError(f"{self.paths[f]}: {name} cannot be read: {error}") from None

    def _text(self, name):
        if name not in self.files[0].variables:
            return []
        return [b"".join(row).split(b"\0")[0].decode(errors="replace").strip() for row in self._all(0, name)]
