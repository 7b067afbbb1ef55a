#!/usr/bin/python3
"""Skin, sections, hidden surfaces and colours of brickwall-plot against exact answers."""
import unittest

from support import box, cubes, np
from brickwall_plot.camera import Camera
from brickwall_plot.colours import BRICK, NIGHT, cielab, colour_map, even_steps
from brickwall_plot.painter import Canvas, Painter
from brickwall_plot.raster import visible_triangles
from brickwall_plot.skin import exterior_faces, sides_of_bodies, normals
from brickwall_plot.surface import Surface
from brickwall_plot.units import Units, quantity_of, round_below

GREY = np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1)


def areas(surface, points):
    corner = points[surface.triangles]
    return np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2


def enclosed_volume(surface, points):
    """By the divergence theorem; exact for closed surfaces of triangles."""
    return (areas(surface, points) * points[surface.triangles].mean(axis=1)).sum() / 3


class Skin(unittest.TestCase):
    def test_has_the_outer_faces_and_the_sides_of_each_body(self):
        mesh = cubes((0, 0, 0), (1, 0, 0), elements=(3, 2, 4))  # two flush blocks
        faces, owners = exterior_faces(mesh.hexes, len(mesh.nodes))
        self.assertEqual(len(faces), 2 * 2 * (3 * 2 + 2 * 4 + 4 * 3))
        self.assertTrue((np.isin(faces, mesh.hexes[owners]).all(axis=1)).all())
        outward = normals(mesh.nodes, faces) * (mesh.nodes[faces].mean(axis=1) - mesh.nodes[mesh.hexes[owners]].mean(axis=1))
        self.assertTrue((outward.sum(axis=1) > 0).all())
        sides = sides_of_bodies(faces, normals(mesh.nodes, faces), len(mesh.nodes))
        self.assertEqual(sorted(np.unique(sides, return_counts=True)[1]), sorted(2 * [6, 6, 8, 8, 12, 12]))

    def test_follows_a_bend_below_40_degrees_and_ends_at_a_sharper_one(self):
        for degrees, number in ((35, 6), (45, 8)):
            mesh = box((2, 1, 1), (2, 1, 1))
            beyond, angle = mesh.nodes[:, 0] > 1.5, np.radians(degrees)
            mesh.nodes[beyond] += [np.cos(angle) - 1, 0, np.sin(angle)]
            faces, _ = exterior_faces(mesh.hexes, len(mesh.nodes))
            sides = sides_of_bodies(faces, normals(mesh.nodes, faces), len(mesh.nodes))
            self.assertEqual(len(np.unique(sides)), number)


class Section(unittest.TestCase):
    def test_through_the_middle_of_a_cube_is_a_regular_hexagon(self):
        mesh = box((1, 1, 1), (3, 3, 3))
        normal = np.ones(3) / np.sqrt(3)
        surface = Surface(mesh.hexes, mesh.nodes, (np.full(3, 0.5), normal))
        points = surface.evaluate(mesh.nodes)
        # Rounding, and the 1e-9 of the diagonal by which the plane is shifted.
        self.assertAlmostEqual(enclosed_volume(surface, points), 0.5, delta=4e-9)
        area = areas(surface, points) @ normal
        cut = abs((points[surface.triangles].mean(axis=1) - 0.5) @ normal) < 1e-8
        self.assertAlmostEqual(area[cut].sum(), 0.75 * np.sqrt(3), delta=1e-8)
        self.assertTrue((area[cut] >= 0).all())  # it faces the removed half

    def test_is_closed_at_any_angle_also_of_a_deformed_body(self):
        random = np.random.default_rng(7)
        for _ in range(20):
            mesh = box((1, 1, 1), (2, 3, 2), (-0.5, -0.5, -0.5))
            normal = random.normal(size=3)
            surface = Surface(mesh.hexes, mesh.nodes, (random.uniform(-0.2, 0.2, 3), normal / np.linalg.norm(normal)))
            points = surface.evaluate(mesh.nodes + random.uniform(-0.05, 0.05, mesh.nodes.shape))
            self.assertLess(np.abs(areas(surface, points).sum(axis=0)).max(), 1e-12)  # of a closed surface: zero

    def test_on_a_plane_of_the_mesh_shows_the_half_that_stays(self):
        mesh = cubes((0, 0, 0), (1, 0, 0), elements=(2, 1, 1))
        for place, elements in ((1.0, {0, 1}), (0.5, {0}), (1.5, {0, 1, 2})):
            surface = Surface(mesh.hexes, mesh.nodes, (np.array([place, 0, 0]), np.array([1.0, 0, 0])))
            self.assertEqual(set(surface.element), elements)
            self.assertAlmostEqual(enclosed_volume(surface, surface.evaluate(mesh.nodes)), place, delta=1e-8)


class HiddenSurfaces(unittest.TestCase):
    def test_are_those_of_an_exhaustive_search(self):
        random = np.random.default_rng(3)
        width, height = 60, 40
        corners = random.uniform(-15, 75, (300, 3, 3)) * [1, 0.8, 1]
        corners[:100] = corners[:100, :1] + 0.1 * (corners[:100] - corners[:100, :1])  # small ones too
        seen = visible_triangles(corners, width, height)
        x, y = np.meshgrid(np.arange(width), np.arange(height))
        best, nearest = np.full((height, width), -np.inf), np.full((height, width), -1)
        near_an_edge = np.zeros((height, width), dtype=bool)
        for number, triangle in enumerate(corners):
            matrix = np.linalg.inv(np.column_stack([triangle[:, :2], np.ones(3)]).T)
            weights = np.einsum("ij,jyx->iyx", matrix, np.stack([x, y, np.ones_like(x)]))
            near_an_edge |= (abs(weights) < 1e-9).any(axis=0)
            nearness = np.where((weights >= 0).all(axis=0), np.einsum("iyx,i->yx", weights, triangle[:, 2]), -np.inf)
            nearest[nearness > best] = number
            best = np.maximum(best, nearness)
        self.assertTrue((seen == nearest)[~near_an_edge].all())
        self.assertLess(near_an_edge.mean(), 0.01)

    def test_leave_no_gap_between_neighbours(self):
        random = np.random.default_rng(5)
        x, y = np.meshgrid(np.linspace(-1, 50, 30), np.linspace(-1, 50, 30))
        inner = (slice(1, -1), slice(1, -1))
        x[inner] += random.uniform(-0.5, 0.5, x[inner].shape)
        y[inner] += random.uniform(-0.5, 0.5, y[inner].shape)
        x[5, 5], y[5, 5] = 7, 8  # a common corner on a sample
        points = np.stack([x, y, np.zeros_like(x)], axis=-1)
        a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
        corners = np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
        self.assertTrue((visible_triangles(corners, 50, 50) >= 0).all())


class Painting(unittest.TestCase):
    def paint(self, mesh, values, view, parallel=True, size=(108, 108), plane=None, **how):
        surface = Surface(mesh.hexes, mesh.nodes, plane)
        points = surface.evaluate(mesh.nodes)
        if len(values) == len(mesh.nodes):
            values = surface.evaluate(values)
        else:
            values = np.asarray(values, dtype=float)[surface.element]
        camera = Camera(points.min(axis=0), points.max(axis=0), *view, parallel)
        canvas = Canvas(*size, np.full(2, -0.54), np.full(2, 0.54), outline=0, plain=True, **how)
        return Painter(canvas, camera, surface, GREY).paint(points, values), canvas, camera

    def test_of_a_cube_along_an_axis_fills_its_square_with_its_colour(self):
        mesh = box((1, 1, 1), (1, 1, 1))
        for view in ((-90, 0), (90, 0), (0, 0), (180, 0), (-90, 90), (-90, -90)):
            picture, _, _ = self.paint(mesh, [0.25], view)  # 100 pixels/length
            self.assertTrue((picture[4:104, 4:104] == 64).all())
            picture[4:104, 4:104] = 255
            self.assertTrue((picture == 255).all())

    def test_of_a_missing_value_is_grey(self):
        self.assertTrue((self.paint(box((1, 1, 1), (1, 1, 1)), [np.nan], (0, 0))[0][50, 50] == 170).all())

    def test_of_a_linear_field_is_linear_in_a_parallel_view(self):
        mesh = box((1, 1, 1), (2, 3, 2))
        picture, _, _ = self.paint(mesh, mesh.nodes[:, 0], (-90, 0))
        exact = np.floor(256 * (np.arange(100) + 0.5) / 100)
        self.assertLessEqual(abs(picture[50, 4:104, 0] - exact).max(), 1.5)  # the mean of three shades per pixel

    def test_of_a_linear_field_is_exact_in_perspective(self):
        mesh = box((1, 1, 1), (1, 1, 1))
        picture, canvas, camera = self.paint(mesh, mesh.nodes[:, 0], (-40, 25), parallel=False, size=(300, 300), samples=1)
        checked = 0
        for row in range(0, 300, 7):
            for column in range(0, 300, 7):
                flat = (np.array([column, row]) + 0.5 - 150) / [canvas.scale, -canvas.scale]
                eye = camera.middle + camera.distance * camera.towards_eye
                ray = camera.middle + flat[0] * camera.right + flat[1] * camera.up - eye
                hit = eye + ray * (0 - eye[1]) / ray[1]  # on the front face, y = 0
                if (hit[[0, 2]] > 0.01).all() and (hit[[0, 2]] < 0.99).all():
                    self.assertLessEqual(abs(picture[row, column, 0] - 256 * hit[0]), 1.01)
                    checked += 1
        self.assertGreater(checked, 300)

    def test_shows_the_nearer_of_two_bricks(self):
        mesh = cubes((0, 0, 0), (0, 1, 0))
        for view, shade in (((-90, 0), 51), ((90, 0), 204)):
            picture, _, _ = self.paint(mesh, [0.2, 0.8], view)
            self.assertEqual(set(picture[4:104, 4:104].ravel()), {shade})

    def test_shows_the_section_of_a_cut(self):
        mesh = box((1, 1, 1), (1, 4, 1))
        picture, _, _ = self.paint(mesh, [0.1, 0.3, 0.5, 0.7], (-90, 0), plane=(np.array([0, 0.6, 0]), np.array([0, -1.0, 0])))
        self.assertEqual(set(picture[4:104, 4:104].ravel()), {128})

    def test_draws_outlines_between_bricks_and_edges_of_elements(self):
        mesh = cubes((0, 0, 0), (0.5, 0, 0), size=(0.5, 1, 1), elements=(1, 1, 2))
        surface = Surface(mesh.hexes, mesh.nodes)
        camera = Camera(mesh.nodes.min(axis=0), mesh.nodes.max(axis=0), -90, 0, True)
        for mesh_lines in (False, True):
            canvas = Canvas(108, 108, np.full(2, -0.54), np.full(2, 0.54), outline=2, mesh=mesh_lines, plain=True)
            picture = Painter(canvas, camera, surface, GREY).paint(surface.evaluate(mesh.nodes), np.full(len(surface.triangles), 0.5))
            dark = picture[:, :, 0] < 60
            self.assertTrue(dark[6:102, 53:55].all())  # between the bricks
            self.assertEqual(dark[20].sum(), 6)  # and 2 pixels at either end
            self.assertEqual((picture[45:60, 30, 0] < 128).any(), mesh_lines)

    def test_draws_outlines_that_are_thinner_than_a_sample(self):
        mesh = cubes((0, 0, 0), (0.5, 0, 0), size=(0.5, 1, 1))
        surface = Surface(mesh.hexes, mesh.nodes)
        camera = Camera(mesh.nodes.min(axis=0), mesh.nodes.max(axis=0), -90, 0, True)
        canvas = Canvas(108, 108, np.full(2, -0.54), np.full(2, 0.54), samples=2, outline=0.1, plain=True)
        picture = Painter(canvas, camera, surface, GREY).paint(surface.evaluate(mesh.nodes), np.full(len(surface.triangles), 0.5))
        self.assertTrue((picture[6:102, 53:55, 0].min(axis=1) < 100).all())  # between the bricks


class Colours(unittest.TestCase):
    def test_are_even_in_cielab_and_darken_steadily(self):
        for anchors in (BRICK, NIGHT):
            lab = cielab(even_steps(anchors, 64))
            steps = np.linalg.norm(np.diff(lab, axis=0), axis=1)
            self.assertLess(steps.max() / steps.min(), 1.06)  # chords across the bends of the line
            self.assertLess(np.diff(lab[:, 0]).max(), 0)

    def test_of_white_and_black_have_their_known_lightness(self):
        self.assertLess(abs(cielab([[1, 1, 1], [0, 0, 0]]) - [[100, 0, 0], [0, 0, 0]]).max(), 0.02)

    def test_have_sand_at_zero_and_equal_distances_on_both_sides(self):
        sand = colour_map(None, 0, 1)(0.0)
        for low, high in ((-1, 1), (-1, 3), (-3, 1)):
            found = colour_map(None, low, high)
            self.assertLess(abs(np.array(found(-low / (high - low))) - sand).max(), 0.02)
        self.assertEqual(colour_map(None, -1, 3)(1.0), colour_map(None, 0, 1)(1.0))

    def test_have_units_with_prefixes(self):
        scaled = Units().scaled
        self.assertEqual(scaled("stress", 3.2e6), (1e-6, "MPa"))
        self.assertEqual(scaled("length", 0.16), (1.0, "m"))
        self.assertEqual(scaled("length", 2e-4)[1], "µm")
        self.assertEqual(scaled("", 1e9), (1.0, ""))
        self.assertEqual(scaled("acceleration", 3), (1.0, "m/s²"))
        self.assertEqual(scaled("angular momentum", 3), (1.0, "N m s"))
        self.assertEqual([round_below(value) for value in (1, 4.9, 5, 0.0021)], [1, 2, 5, 0.002])

    def test_have_the_units_of_the_deck_without_prefixes_in_others_than_si(self):
        tonnes = Units("mm-t-s")
        self.assertEqual(tonnes.scaled(quantity_of("displacement"), 1600), (1.0, "mm"))
        self.assertEqual(tonnes.scaled(quantity_of("stress_xx"), 3.2e6), (1.0, "MPa"))
        self.assertEqual(tonnes.scaled(quantity_of("energy_density"), 1)[1], "mJ/mm³")
        self.assertEqual(tonnes.scaled(quantity_of("search_time"), 1)[1], "s")
        self.assertEqual(Units("none").scaled("energy", 1e-12), (1.0, ""))


if __name__ == "__main__":
    unittest.main()
