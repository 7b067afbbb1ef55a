"""Writes frames as MP4 (by ffmpeg) or as GIF (by pillow)."""
import shutil
import subprocess

import numpy as np
from PIL import Image

from .errors import PlotError

GIF_COLOURS = 255  # and one that leaves the pixel of the frame before
LAST_FRAME = 1.5  # seconds that a GIF rests before it begins again


def write_mp4(path, frames, rate):
    """Frames are arrays [row][column][rgb] of even size, uint8; `rate` is frames per second."""
    ffmpeg = shutil.which("ffmpeg")
    if ffmpeg is None:
        raise PlotError(f"{path}: MP4 needs ffmpeg (apt-get install ffmpeg); GIF does not")
    process = None
    for frame in frames:
        if process is None:
            size = f"{frame.shape[1]}x{frame.shape[0]}"
            process = subprocess.Popen(
                [ffmpeg, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", f"{rate:g}", "-i", "-",
                 "-c:v", "libx264", "-preset", "slow", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(path)],
                stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            process.stdin.write(frame.tobytes())
        except BrokenPipeError:
            break
    _, message = process.communicate()
    if process.returncode:
        raise PlotError(f"{path}: ffmpeg failed: {message.decode().strip().splitlines()[-1] if message else process.returncode}")


def write_gif(path, frames, rate):
    """One palette for all frames, no dither; pixels that do not change are transparent, which keeps the file small."""
    frames = [Image.fromarray(frame) for frame in frames]
    palette = common_palette([np.asarray(frames[i]) for i in {0, len(frames) // 2, len(frames) - 1}])
    images, before = [], None
    for frame in frames:
        shades = np.array(frame.quantize(palette=palette, dither=Image.Dither.NONE))
        shades[(np.asarray(frame) == 255).all(axis=2)] = 0  # which quantize takes for a pale grey
        image = Image.fromarray(shades if before is None else np.where(shades == before, GIF_COLOURS, shades).astype(np.uint8), "P")
        image.putpalette(palette.getpalette()[:3 * GIF_COLOURS] + [0, 0, 0])
        images.append(image)
        before = shades
    duration = [1000 / rate] * (len(images) - 1) + [1000 * max(LAST_FRAME, 1 / rate)]
    images[0].save(path, save_all=True, append_images=images[1:], duration=duration, loop=0, disposal=1, optimize=False,
                   transparency=GIF_COLOURS)


def common_palette(frames):
    """An image with the palette of the frames: white, and colours weighted by the square root of how often they occur, so
    that large areas leave some to small ones."""
    colours, counts = np.unique(np.concatenate(frames).reshape(-1, 3), axis=0, return_counts=True)
    sample = np.repeat(colours, np.ceil(np.sqrt(counts)).astype(int), axis=0)
    found = Image.fromarray(sample[None]).quantize(GIF_COLOURS - 1, method=Image.Quantize.MEDIANCUT, kmeans=1)
    palette = Image.new("P", (1, 1))
    palette.putpalette([255, 255, 255] + found.getpalette()[:3 * (GIF_COLOURS - 1)])
    return palette
