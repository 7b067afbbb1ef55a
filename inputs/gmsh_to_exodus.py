#!/usr/bin/python3
"""Writes a gmsh mesh of hexahedra as an Exodus file that Brickwall reads.

    gmsh -3 -format msh22 part.geo -o part.msh        # Debian package gmsh
    inputs/gmsh_to_exodus.py part.msh part.exo        # Debian package python3-netcdf4

Each physical volume becomes an element block, each physical surface a side set and a node set, with the names of the physical groups.
Reads the ASCII format 2.2 with eight-node hexahedra; needs no gmsh itself.
"""
import sys

import netCDF4
import numpy as np

QUADRILATERAL, HEXAHEDRON = 3, 5  # element types of gmsh
VOLUME, SURFACE = 3, 2  # dimensions of physical groups
# Corners of the six sides of an Exodus hexahedron, in the order of the side numbers 1 to 6; gmsh numbers the corners alike.
SIDES = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [0, 4, 7, 3], [0, 3, 2, 1], [4, 5, 6, 7]])


class MeshError(Exception):
    pass


def read_msh(path):
    """Points [node][xyz], corners {(dimension, tag): [element][corner]} from 0, names {(dimension, tag): text}."""
    with open(path, encoding="utf-8", errors="replace") as file:
        lines = iter(file.read().splitlines())
    names, points, index, corners, sizes = {}, None, None, {}, {QUADRILATERAL: (SURFACE, 4), HEXAHEDRON: (VOLUME, 8)}
    for line in lines:
        if line == "$MeshFormat":
            version = next(lines)
            if not version.startswith("2.2 0"):
                raise MeshError(f"found the format \"{version}\", expected 2.2 ASCII (gmsh -format msh22)")
        elif line == "$PhysicalNames":
            for _ in range(int(next(lines))):
                dimension, tag, name = next(lines).split(maxsplit=2)
                names[int(dimension), int(tag)] = name.strip("\"")
        elif line == "$Nodes":
            table = np.array([next(lines).split() for _ in range(int(next(lines)))], dtype=float).reshape(-1, 4)
            points = table[:, 1:4]
            index = {int(tag): node for node, tag in enumerate(table[:, 0])}
        elif line == "$Elements":
            for _ in range(int(next(lines))):
                entry = [int(word) for word in next(lines).split()]
                if entry[1] in sizes:
                    dimension, count = sizes[entry[1]]
                    if len(entry) != 3 + entry[2] + count:
                        raise MeshError(f"found {len(entry)} numbers for element {entry[0]}, expected {3 + entry[2] + count}")
                    unknown = [tag for tag in entry[-count:] if tag not in index]
                    if unknown:
                        raise MeshError(f"element {entry[0]} has node {unknown[0]}, expected one of $Nodes")
                    corners.setdefault((dimension, entry[3]), []).append([index[tag] for tag in entry[-count:]])
                elif entry[1] not in (1, 15):  # lines and points
                    raise MeshError(f"found an element of gmsh's type {entry[1]}, expected hexahedra and quadrilaterals of first order")
    if points is None or not any(dimension == VOLUME for dimension, _ in corners):
        raise MeshError("found no hexahedra, expected at least one in a Physical Volume (Recombine, Transfinite or Extrude with Layers)")
    return points, {group: np.array(rows) for group, rows in corners.items()}, names


def sides_of(faces, blocks):
    """Element and side numbers, both from 1, of faces given by their corners."""
    place = {tuple(sorted(elem[side])): (number, s + 1)
             for number, elem in enumerate(np.concatenate(blocks), 1) for s, side in enumerate(SIDES)}
    found = [place.get(tuple(sorted(face))) for face in faces]
    if None in found:
        raise MeshError("a Physical Surface has a face that is no side of a hexahedron in a Physical Volume")
    return np.array(found)


def write_names(file, variable, dimension, names):
    table = file.createVariable(variable, "S1", (dimension, "len_name"))
    for row, name in enumerate(names):
        table[row] = netCDF4.stringtochar(np.array([name.encode()], dtype=f"S{len(file.dimensions['len_name'])}"))[0]


def write_exodus(path, points, corners, names):
    volumes = sorted(group for group in corners if group[0] == VOLUME)
    surfaces = sorted(group for group in corners if group[0] == SURFACE)
    blocks = [corners[group] for group in volumes]
    sets = [(sides_of(corners[group], blocks), np.unique(corners[group]) + 1) for group in surfaces]
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.setncatts({"api_version": np.float32(8.03), "version": np.float32(8.03), "floating_point_word_size": np.int32(8),
                        "file_size": np.int32(1), "title": "gmsh mesh"})
        sizes = {"len_name": 1 + max([32, *(len(name.encode()) for name in names.values())]), "time_step": None, "num_dim": 3, "num_nodes": len(points), "num_elem": sum(map(len, blocks)),
                 "num_el_blk": len(blocks), "num_side_sets": len(surfaces), "num_node_sets": len(surfaces)}
        for name, size in sizes.items():
            if size != 0:
                file.createDimension(name, size)
        for d, axis in enumerate("xyz"):
            file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = points[:, d]
        for kind, dimension, groups in (("eb", "num_el_blk", volumes), ("ss", "num_side_sets", surfaces), ("ns", "num_node_sets", surfaces)):
            if groups:
                write_names(file, f"{kind}_names", dimension, [names.get(group, f"group_{group[1]}") for group in groups])
                file.createVariable(f"{kind}_status", "i4", (dimension,))[:] = 1
                ids = file.createVariable(f"{kind}_prop1", "i4", (dimension,))
                ids.setncattr("name", "ID")
                ids[:] = np.arange(1, len(groups) + 1)
        for number, block in enumerate(blocks, 1):
            file.createDimension(f"num_el_in_blk{number}", len(block))
            file.createDimension(f"num_nod_per_el{number}", 8)
            connect = file.createVariable(f"connect{number}", "i4", (f"num_el_in_blk{number}", f"num_nod_per_el{number}"))
            connect.elem_type = "HEX8"
            connect[:] = block + 1
        for number, (sides, nodes) in enumerate(sets, 1):
            file.createDimension(f"num_side_ss{number}", len(sides))
            file.createVariable(f"elem_ss{number}", "i4", (f"num_side_ss{number}",))[:] = sides[:, 0]
            file.createVariable(f"side_ss{number}", "i4", (f"num_side_ss{number}",))[:] = sides[:, 1]
            file.createDimension(f"num_nod_ns{number}", len(nodes))
            file.createVariable(f"node_ns{number}", "i4", (f"num_nod_ns{number}",))[:] = nodes
    for group, rows in sorted(corners.items(), reverse=True):
        kind = "block" if group[0] == VOLUME else "side set and node set"
        print(f"{kind} {names.get(group, f'group_{group[1]}')}: {len(rows)} {'elements' if group[0] == VOLUME else 'faces'}")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        write_exodus(sys.argv[2], *read_msh(sys.argv[1]))
    except (MeshError, OSError, ValueError) as error:
        print(f"gmsh_to_exodus: {sys.argv[1]}: {error}", file=sys.stderr)
        sys.exit(2)
    except (IndexError, StopIteration):
        print(f"gmsh_to_exodus: {sys.argv[1]}: the file ends too early, or a line is too short", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
