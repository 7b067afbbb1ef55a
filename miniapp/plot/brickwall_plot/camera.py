"""A camera that looks at the middle of the scene: x to the right, y up, depth away from the eye."""
import numpy as np

VIEWS = {"front": (-90, 0), "back": (90, 0), "left": (180, 0), "right": (0, 0), "top": (-90, 90), "bottom": (-90, -90)}
DISTANCE = 4.0  # of the eye, over the radius of the scene: the perspective of a long lens


class Camera:
    """Looks from azimuth (from x towards y) and elevation (from the ground), in degrees, at the box low, high."""

    def __init__(self, low, high, azimuth, elevation, parallel=False):
        azimuth, elevation = np.radians(azimuth), np.radians(elevation)
        self.towards_eye = np.array(
            [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
        self.right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        self.up = np.cross(self.towards_eye, self.right)
        self.middle, self.parallel = (low + high) / 2, parallel
        self.distance = DISTANCE * max(np.linalg.norm(high - low) / 2, 1e-300)

    def project(self, points):
        """(x, y [point][2], reciprocal homogeneous coordinate q [point], nearness [point]). Lengths at the distance
        of the middle are true. Nearness, q, and q times any field are affine in x and y on a flat face."""
        relative = points - self.middle
        depth = self.distance - relative @ self.towards_eye
        q = np.ones(len(points)) if self.parallel else self.distance / depth
        flat = np.stack([relative @ self.right, relative @ self.up], axis=1) * q[:, None]
        return flat, q, (-depth if self.parallel else q)
