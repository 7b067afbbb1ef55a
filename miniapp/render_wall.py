#!/usr/bin/python3
"""Draws the deformed mesh of an Exodus results file, coloured by a field: the picture of the wall.

Exterior faces of the hex8 blocks are moved by the displacement, lit, sorted from far to near (painter's algorithm)
and drawn with the outlines of the bricks. Needs netCDF4 and matplotlib only; no display.
"""
import argparse
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import netCDF4
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap

# Corners of the six sides of a hex8, outward normals (Exodus order, 0-based).
HEX_SIDES = np.array(
    [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [0, 4, 7, 3], [0, 3, 2, 1], [4, 5, 6, 7]]
)
# SI units, unless the deck states others.
UNITS = {"displacement": "m", "velocity": "m/s", "force_contact": "N", "stress": "Pa", "pressure": "Pa",
         "energy_density": "J/m³", "contact_gap": "m"}
BACKGROUND = "#ffffff"
# From sand to burnt brick to plum: the lightness falls evenly, so that the map also works in grey.
BRICK_COLOURS = LinearSegmentedColormap.from_list(
    "brick", ["#efe3cf", "#f3c48a", "#ea9152", "#d1603d", "#a8324a", "#6d1c55", "#35124a"]
)


class Results:
    """Mesh and one time step of an Exodus file."""

    def __init__(self, path, step):
        self.file = netCDF4.Dataset(path)
        self.file.set_auto_mask(False)
        variables = self.file.variables
        if "coord" in variables:
            self.coordinates = np.array(variables["coord"][:]).T
        else:
            self.coordinates = np.stack([variables["coord" + axis][:] for axis in "xyz"], axis=1)
        self.times = np.array(variables["time_whole"][:]) if "time_whole" in variables else np.zeros(0)
        self.step = step if step >= 0 else len(self.times) + step
        if len(self.times) and not 0 <= self.step < len(self.times):
            sys.exit(f"{path}: step {step} of {len(self.times)} requested")
        self.nodal_names = self._names("name_nod_var")
        self.element_names = self._names("name_elem_var")
        self.blocks = []  # (block number, connectivity [element][8])
        block = 1
        while f"connect{block}" in variables:
            connectivity = variables[f"connect{block}"]
            if connectivity.elem_type.upper().startswith("HEX") and connectivity.shape[0]:
                self.blocks.append((block, np.array(connectivity[:, :8], dtype=np.int64) - 1))
            block += 1
        if not self.blocks:
            sys.exit(f"{path}: no block of hexahedra")
        self.hexes = np.concatenate([connectivity for _, connectivity in self.blocks])

    def _names(self, name):
        if name not in self.file.variables:
            return []
        return [b"".join(row).split(b"\0")[0].decode().strip() for row in self.file.variables[name][:]]

    def title(self):
        """The title of the file; epu drops it, but the information records hold the deck with its title."""
        for record in self._names("info_records"):
            key, _, value = record.partition("=")
            if key.strip() == "title":
                return value.split('"')[1] if value.count('"') >= 2 else value.strip()
        return getattr(self.file, "title", "").strip()

    def nodal(self, name):
        return np.array(self.file.variables[f"vals_nod_var{self.nodal_names.index(name) + 1}"][self.step])

    def element(self, name):
        variable = self.element_names.index(name) + 1
        values = [np.full(len(connectivity), np.nan) for _, connectivity in self.blocks]
        for part, (block, _) in zip(values, self.blocks):
            key = f"vals_elem_var{variable}eb{block}"
            if key in self.file.variables:
                part[:] = self.file.variables[key][self.step]
        return np.concatenate(values)

    def vector(self, prefix):
        """The three components prefix_x, prefix_y, prefix_z, or None."""
        names = [f"{prefix}_{axis}" for axis in "xyz"]
        if not all(name in self.nodal_names for name in names):
            return None
        return np.stack([self.nodal(name) for name in names], axis=1)

    def field(self, name, faces, owners):
        """One value per face, and the label of the field."""
        vector = self.vector(name)
        unit = next((u for prefix, u in UNITS.items() if name.startswith(prefix)), "")
        unit = f" ({unit})" if unit else ""
        label = name.replace("_", " ")
        if vector is not None:
            return np.linalg.norm(vector, axis=1)[faces].mean(axis=1), f"{label} magnitude{unit}"
        if name in self.nodal_names:
            return self.nodal(name)[faces].mean(axis=1), label + unit
        if name in self.element_names:
            return self.element(name)[owners], label + unit
        vectors = sorted({n[:-2] for n in self.nodal_names if n.endswith("_x")})
        sys.exit(f"no field {name}; the file has: {', '.join(vectors + self.nodal_names + self.element_names)}")


def exterior_faces(hexes):
    """Faces of exactly one hexahedron: [face][corner], and the hexahedron of each."""
    faces = hexes[:, HEX_SIDES].reshape(-1, 4)
    key = np.sort(faces, axis=1)
    _, first, count = np.unique(key, axis=0, return_index=True, return_counts=True)
    alone = np.sort(first[count == 1])
    return faces[alone], alone // 6


def normals_of(points, faces):
    corner = points[faces]
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def outline_edges(faces, normals):
    """Edges where the undeformed surface bends by more than 40 degrees: (end nodes, the two faces)."""
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    owner = np.repeat(np.arange(len(faces)), 4)
    key = np.sort(ends, axis=1)
    order = np.lexsort((key[:, 1], key[:, 0]))
    key, owner = key[order], owner[order]
    pair = np.flatnonzero((key[1:] == key[:-1]).all(axis=1))
    sharp = (normals[owner[pair]] * normals[owner[pair + 1]]).sum(axis=1) < np.cos(np.radians(40))
    pair = pair[sharp]
    return key[pair], np.stack([owner[pair], owner[pair + 1]], axis=1)


def quarter(flat, depth):
    """Each face in four pieces, for a finer order of depth: corners [piece][4][2], depth [piece]."""
    both = np.concatenate([flat, depth[:, :, None]], axis=2)
    middle = both.mean(axis=1, keepdims=True)
    after = (both + np.roll(both, -1, axis=1)) / 2
    before = (both + np.roll(both, 1, axis=1)) / 2
    pieces = np.stack([both, after, np.broadcast_to(middle, both.shape), before], axis=2).reshape(-1, 4, 3)
    return pieces[:, :, :2], pieces[:, :, 2].mean(axis=1)


class Camera:
    """Perspective camera that looks at the middle of the points; x right, y up, depth away from the eye."""

    def __init__(self, points, azimuth, elevation, distance=4.0):
        low, high = points.min(axis=0), points.max(axis=0)
        azimuth, elevation = np.radians(azimuth), np.radians(elevation)
        towards_eye = np.array(
            [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
        )
        self.eye = (low + high) / 2 + towards_eye * distance * np.linalg.norm(high - low) / 2
        self.right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        self.forward = -towards_eye
        self.up = np.cross(self.right, self.forward)

    def project(self, points):
        relative = points - self.eye
        depth = relative @ self.forward
        return np.stack([relative @ self.right, relative @ self.up], axis=-1) / depth[..., None], depth


def draw(results, options):
    faces, owners = exterior_faces(results.hexes)
    reference = results.coordinates
    displacement = next(
        (v for v in map(results.vector, ("displacement", "displ", "disp")) if v is not None),
        np.zeros_like(reference),
    ) if len(results.times) else np.zeros_like(reference)
    points = reference + options.scale * displacement
    normals = normals_of(points, faces)
    camera = Camera(points, *options.view)
    flat, depth = camera.project(points)
    centres = points[faces].mean(axis=1)
    front = ((camera.eye - centres) * normals).sum(axis=1) > 0

    # Colour: the field, shaded by a key light over the viewer's shoulder, a fill light and the sky.
    if len(results.times):
        values, label = results.field(options.field, faces, owners)
    else:
        values, label = np.zeros(len(faces)), ""
    low, high = options.range or (np.nanmin(values), np.nanmax(values))
    norm = plt.Normalize(low, high if high > low else low + 1.0)
    palette = plt.get_cmap(options.colours) if options.colours else BRICK_COLOURS
    colours = palette(norm(values))[:, :3]
    key = -camera.forward + 0.7 * camera.up + 0.6 * camera.right
    fill = -camera.forward - 1.2 * camera.right
    light = 0.45 + 0.50 * np.maximum(normals @ (key / np.linalg.norm(key)), 0)
    light += 0.12 * np.maximum(normals @ (fill / np.linalg.norm(fill)), 0) + 0.08 * normals[:, 2]
    light /= np.percentile(light[front], 90) if front.any() else 1.0
    colours = np.clip(colours * light[:, None], 0, 1)

    # Faces and outlines in one list, far to near; an outline is a polygon of two corners, drawn just
    # after the nearer of its faces.
    edges, edge_faces = outline_edges(faces, normals_of(reference, faces))
    seen = front[edge_faces].any(axis=1)
    edges, edge_faces = edges[seen], edge_faces[seen]
    extent = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
    pieces, piece_depth, per_face = flat[faces[front]], depth[faces[front]].mean(axis=1), 1
    if not options.mesh:
        pieces, piece_depth = quarter(pieces, depth[faces[front]])
        per_face = 4
    nearest_piece = np.full(len(faces), np.inf)
    nearest_piece[front] = piece_depth.reshape(-1, per_face).min(axis=1)
    polygons = list(pieces) + list(flat[edges])
    depths = np.concatenate([piece_depth, nearest_piece[edge_faces].min(axis=1) - 1e-4 * extent])
    face_lines = np.clip(colours[front] * 0.86, 0, 1) if options.mesh else colours[front]
    face_lines = np.repeat(face_lines, per_face, axis=0)
    line_colours = np.concatenate([face_lines, np.tile([0.10, 0.09, 0.09], (len(edges), 1))])
    fills = np.concatenate([np.repeat(colours[front], per_face, axis=0), np.zeros((len(edges), 3))])
    widths = np.concatenate([np.full(len(pieces), 0.25 if options.mesh else 0.6), np.full(len(edges), options.outline)])
    order = np.argsort(-depths, kind="stable")

    figure = plt.figure(figsize=(10, 7.5), facecolor=BACKGROUND)
    axes = figure.add_axes([0.02, 0.02, 0.84, 0.90])
    axes.set_axis_off()
    axes.set_aspect("equal")
    ground = points[:, 2].min()
    if camera.eye[2] > ground + 0.05 * extent:
        draw_shadow(axes, camera, points, faces, key, ground)
    axes.add_collection(
        PolyCollection(
            [polygons[i] for i in order],
            facecolors=fills[order],
            edgecolors=line_colours[order],
            linewidths=widths[order],
            joinstyle="round",
            capstyle="round",
        )
    )
    margin = 0.03 * np.ptp(flat, axis=0).max()
    axes.set_xlim(flat[:, 0].min() - margin, flat[:, 0].max() + margin)
    axes.set_ylim(flat[:, 1].min() - margin, flat[:, 1].max() + margin)

    title = options.title if options.title is not None else results.title()
    figure.text(0.04, 0.955, title, fontsize=15, weight="semibold", va="center")
    if len(results.times):
        note = f"t = {results.times[results.step]:.4g} s"
        if options.scale != 1.0:
            note += f",  displacements × {options.scale:g}"
        figure.text(0.04, 0.920, note, fontsize=11, color="#555555", va="center")
        bar = figure.colorbar(
            plt.cm.ScalarMappable(norm, palette), cax=figure.add_axes([0.885, 0.16, 0.022, 0.66])
        )
        bar.set_label(label, fontsize=11)
        bar.outline.set_visible(False)
        bar.formatter.set_powerlimits((-3, 4))
        bar.update_ticks()
    figure.savefig(options.output, dpi=options.dpi, facecolor=BACKGROUND)


def draw_shadow(axes, camera, points, faces, light, ground):
    """The shadow on the ground of a light that is higher than the key light."""
    light = light / np.linalg.norm(light)
    light = light + np.array([0, 0, 1.2])
    shadow = points - ((points[:, 2] - ground) / light[2])[:, None] * light
    flat, _ = camera.project(shadow)
    axes.add_collection(
        PolyCollection(
            flat[faces], facecolors="#e4e2df", edgecolors="#e4e2df", linewidths=0.4, zorder=0, clip_on=False
        )
    )


def parse(arguments):
    def view(text):
        azimuth, elevation = text.split(",")
        return float(azimuth), float(elevation)

    def limits(text):
        low, high = text.split(",")
        return float(low), float(high)

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", help="Exodus file of one rank, or the joined file")
    parser.add_argument("--output", help="file of the picture (default: beside the results, .png)")
    parser.add_argument(
        "--field",
        default="displacement",
        help="colour: a vector (its magnitude), a nodal or an element field, e.g. displacement, velocity, pressure, "
        "stress_xx (default %(default)s)",
    )
    parser.add_argument("--step", type=int, default=-1, help="output step, 0 is the first, -1 the last (default)")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the displacements (default 1)")
    parser.add_argument(
        "--view",
        type=view,
        default=(62.0, 18.0),
        metavar="AZIMUTH,ELEVATION",
        help="position of the eye in degrees: azimuth from x towards y, elevation from the ground (default 62,18; "
        "--view=-60,20 for the front)",
    )
    parser.add_argument("--range", type=limits, metavar="LOW,HIGH", help="limits of the colours (default: those of the field)")
    parser.add_argument("--colours", help="a colour map of matplotlib, e.g. viridis (default: sand to plum)")
    parser.add_argument("--mesh", action="store_true", help="shows the element edges")
    parser.add_argument("--outline", type=float, default=0.9, help="width of the brick outlines (default %(default)s)")
    parser.add_argument("--title", help="default: the title in the file")
    parser.add_argument("--dpi", type=int, default=150, help="resolution (default %(default)s: 1500 x 1125 pixels)")
    options = parser.parse_args(arguments)
    if options.output is None:
        options.output = options.results.rsplit(".", 1)[0] + ".png"
    return options


if __name__ == "__main__":
    options = parse(sys.argv[1:])
    draw(Results(options.results, options.step), options)
