"""Paints the surface: hidden surfaces, light, colours of a field, outlines of bodies, shadow on the ground."""
from dataclasses import dataclass

import numpy as np

from .raster import gradients, visible_triangles

OUTLINE = np.array([26, 23, 23])
MISSING = np.array([170, 170, 170], dtype=np.uint8)  # where the field has no value
BRIGHTEST = 1.05  # of a face, over one that shows the colours of the bar
SHADOW = 0.16  # darkness of the shadow on the ground
BAND = 48  # rows of pixels that are painted at once, so that arrays stay in the cache


@dataclass
class Canvas:
    """A picture of width x height pixels; `low` and `high` are the corners of what it shows in the camera's x, y."""

    width: int
    height: int
    low: np.ndarray
    high: np.ndarray
    samples: int = 3  # along a side of each pixel
    outline: float = 1.2  # width of the outlines of bodies, pixels
    mesh: bool = False  # draws the edges of elements too
    plain: bool = False  # the colours of the map as they are, without light and shadow

    def __post_init__(self):
        self.scale = min(self.width / max(self.high[0] - self.low[0], 1e-300),
                         self.height / max(self.high[1] - self.low[1], 1e-300))  # pixels/length

    def pixels(self, flat):
        """Places of points [point][camera's x, y], in pixels from the upper left corner."""
        return (flat - (self.low + self.high) / 2) * [self.scale, -self.scale] + [self.width / 2, self.height / 2]


class Painter:
    """Paints pictures of a surface; `colours` [shade][rgb], uint8. The light is the same in all pictures."""

    def __init__(self, canvas, camera, surface, colours):
        self.canvas, self.camera, self.surface = canvas, camera, surface
        self._colours = np.concatenate([colours, [MISSING]]).astype(np.float32)
        self._light = None

    def paint(self, points, values):
        """The picture [row][column][rgb], uint8. `points` are those of the vertices of the surface; `values` are 0 to 1, at
        the triangles [triangle] or the vertices [vertex], or None for the first colour."""
        canvas, surface = self.canvas, self.surface
        samples, width, height = canvas.samples, canvas.width * canvas.samples, canvas.height * canvas.samples
        flat, q, nearness = self.camera.project(points)
        corners = np.column_stack([canvas.pixels(flat) * samples - 0.5, nearness])[surface.triangles]
        front = np.flatnonzero(facing(corners))
        seen = visible_triangles(corners[front], width, height)
        front = np.append(front, -1)  # the background, also for seen == -1
        field = None
        if values is not None and len(values) == len(points):
            field = AffineField(corners, values[surface.triangles], q[surface.triangles])
        elif values is not None:
            shade_of = shades(values, len(self._colours) - 1)
        if not canvas.plain:
            if self._light is None:
                self._light = Light(self.camera, surface, points, np.bincount(front[seen[seen >= 0]], minlength=len(surface.triangles)))
            light, background = self._light.on(surface, points), ground(canvas, self.camera, surface, points, self._light.side)
        picture = np.empty((canvas.height, canvas.width, 3), dtype=np.uint8)
        margin = int(np.ceil(canvas.outline * samples / 2)) + 1
        for top in range(0, canvas.height, BAND):
            bottom = min(top + BAND, canvas.height)
            first, last = max(top * samples - margin, 0), min(bottom * samples + margin, height)
            triangles = front[seen[first:last]]
            row, column = np.nonzero(triangles >= 0)
            triangle = triangles[row, column]
            if field:
                shade = shades(field.at(triangle, row + first, column), len(self._colours) - 1)
            else:
                shade = shade_of[triangle] if values is not None else np.zeros(len(triangle), dtype=np.int32)
            painted = self._colours[shade]
            if not canvas.plain:
                painted = np.minimum(painted * light[triangle, None], 255)
            band = np.full((last - first, width, 3), 255, dtype=np.float32)
            if not canvas.plain:
                band *= background[np.arange(first, last) // samples].repeat(samples, axis=1)[:, :, None]
            band[row, column] = painted
            if canvas.mesh:
                band[borders(numbered(surface.face, triangles), 1)] *= 0.75
            if canvas.outline:
                band[borders(numbered(surface.side, triangles), canvas.outline * samples)] = OUTLINE
            band = band[top * samples - first:bottom * samples - first]
            total = sum(band[i::samples, j::samples] for i in range(samples) for j in range(samples))
            picture[top:bottom] = np.rint(total / samples**2)
        return picture


def facing(corners):
    """The triangles whose outer side is seen; rows count downwards."""
    (x1, y1), (x2, y2) = ((corners[:, i, :2] - corners[:, 0, :2]).T for i in (1, 2))
    return x1 * y2 - x2 * y1 < 0


def shades(values, count):
    """The number of the colour of values 0 to 1; the one after the last where there is no value."""
    shade = np.clip(np.nan_to_num(values) * count, 0, count - 1).astype(np.int32)
    shade[np.isnan(values)] = count
    return shade


class AffineField:
    """A nodal field at samples: it is affine on the triangles in space, thus q times it is affine in the picture."""

    def __init__(self, corners, values, q):
        self._corners = corners[:, 0, :2].astype(np.float32)
        self._weighted, self._q = (self._plane(corners, part) for part in (values * q, q))
        self._low, self._high = values.min(axis=1).astype(np.float32), values.max(axis=1).astype(np.float32)

    def at(self, triangle, row, column):
        """Values at samples of triangles."""
        across, down = (place - self._corners[triangle, i] for i, place in enumerate((column, row)))

        def value(plane):
            start, along_x, along_y = plane
            return start[triangle] + along_x[triangle] * across + along_y[triangle] * down

        # On a triangle that is seen nearly edge-on, rounding may lead beyond its corners.
        return np.clip(value(self._weighted) / value(self._q), self._low[triangle], self._high[triangle])

    @staticmethod
    def _plane(corners, field):
        return [part.astype(np.float32) for part in (field[:, 0], *gradients(corners, field))]


class Light:
    """A key light from above and the side to which most of the faces turn that are seen, a fill light from the other side,
    and the sky. `seen` counts the samples [triangle] of the first picture, in which the mean brightness is 1."""

    def __init__(self, camera, surface, points, seen):
        self._camera, self.side, self._mean = camera, camera.right, 1.0
        normal = face_normals(surface, points)
        if seen @ normal @ camera.right < 0:
            self.side = -camera.right
        self._mean = seen @ self._brightness(normal) / max(seen.sum(), 1)

    def on(self, surface, points):
        """Brightness [triangle] of its face."""
        return np.minimum(self._brightness(face_normals(surface, points)), BRIGHTEST).astype(np.float32)

    def _brightness(self, normal):
        eye, up = self._camera.towards_eye, self._camera.up
        lights = (eye + 0.7 * up + 0.6 * self.side, eye - 1.2 * self.side)
        key, fill = (np.maximum(normal @ (light / np.linalg.norm(light)), 0) for light in lights)
        return (0.45 + 0.50 * key + 0.12 * fill + 0.08 * (1 + normal[:, 2]) / 2) / self._mean


def face_normals(surface, points):
    """The mean unit normal [triangle] of its face."""
    corner = points[surface.triangles]
    twice_area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal = np.stack([np.bincount(surface.face, twice_area[:, i]) for i in range(3)], axis=1)
    return (normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))[surface.face]


def ground(canvas, camera, surface, points, side):
    """Brightness of the background [row][column]: a soft shadow of the bodies on the plane of their lowest point, of a light
    that is higher than the key light."""
    width, height = canvas.width, canvas.height
    bright = np.ones((height, width), dtype=np.float32)
    low = points[:, 2].min()
    if camera.towards_eye[2] > 0.02:
        light = camera.towards_eye + 0.7 * camera.up + 0.9 * side
        light = light / np.linalg.norm(light) + np.array([0, 0, 1.2])
        flat, _, nearness = camera.project(points - ((points[:, 2] - low) / light[2])[:, None] * light)
        corners = np.column_stack([canvas.pixels(flat) - 0.5, nearness])[surface.triangles]
        bright[visible_triangles(corners[facing(corners)], width, height) >= 0] = 0
        for axis in (0, 1, 0, 1):
            bright = blurred(bright, max(width // 150, 1), axis)
    return 1 - SHADOW * (1 - bright)


def blurred(picture, reach, axis):
    """The mean over 2 reach + 1 pixels."""
    margin = [(reach + 1, reach) if i == axis else (0, 0) for i in range(2)]
    total = np.cumsum(np.pad(picture, margin, mode="edge"), axis=axis, dtype=np.float64)
    one, other = (np.take(total, np.arange(picture.shape[axis]) + shift, axis) for shift in (2 * reach + 1, 0))
    return ((one - other) / (2 * reach + 1)).astype(np.float32)


def numbered(numbers, triangles):
    """Numbers of triangles at samples; -1 for the background."""
    return np.append(numbers, -1)[triangles]


def borders(number, width):
    """The samples within width / 2 of a change of the number, at least those beside it."""
    width = max(width, 1)
    changes = np.zeros(number.shape, dtype=bool)
    changes[:, :-1] |= number[:, 1:] != number[:, :-1]
    changes[:-1] |= number[1:] != number[:-1]
    reach = int(np.ceil(width / 2))
    result = np.zeros_like(changes)
    rows, columns = np.nonzero(changes)
    for down in range(-reach, reach + 1):
        for across in range(-reach, reach + 1):
            # A change lies between two samples, half a sample from the first.
            if (down - 0.5) ** 2 + (across - 0.5) ** 2 <= (width / 2) ** 2 + 0.25:
                result[np.clip(rows + down, 0, number.shape[0] - 1), np.clip(columns + across, 0, number.shape[1] - 1)] = True
    return result
