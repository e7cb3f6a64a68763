"""A frame as pixels: the rolling layer in colour over the hillshade of the surface."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray

from bcre_studies.on_plane.picture import shaded
from bcre_studies.playing.sandbox import Frame
from bcre_studies.scenes.domain import Array

MOST_PIXELS = 400
"""Along either side; of a larger plane every second, third, ... cell is shown."""

DECADES = 3
"""Of R that colours tell apart."""

COLOURS = (255 * colormaps["YlOrRd"](np.linspace(0, 1, 256))[:, :3]).astype(np.float64)
OPAQUE = 0.75
WALL = (20, 20, 20)


def pixels(frame: Frame, tilt: Array, d: float, walls: NDArray[np.bool_], highest: float) -> bytes:
    """Red, green, blue and 255 of each pixel, row by row downhill.

    Parameters
    ----------
    tilt: what is taken off h before it is shaded, shape (N, M) or (N, 1).
    walls: cells that are drawn dark.
    highest: the R of the darkest colour.
    """
    every = stride(frame.h.shape)
    cut = (slice(None, None, every), slice(None, None, every))
    shade = shaded((frame.h - tilt)[cut], every * d)
    grey = np.repeat((40 + 200 * shade)[..., None], 3, axis=2)
    R = frame.R[cut]
    part = np.log10(np.maximum(R / highest, 10.0**-DECADES)) / DECADES + 1
    colour = COLOURS[np.minimum((255 * part).astype(int), 255)]
    opacity = OPAQUE * (part > 0)[..., None]
    mixed = (1 - opacity) * grey + opacity * colour
    mixed[walls[cut]] = WALL
    image = np.full((*R.shape, 4), 255, np.uint8)
    image[..., :3] = mixed
    return image.tobytes()


def stride(shape: tuple[int, ...]) -> int:
    """Cells between two that are shown."""
    return -(-max(shape) // MOST_PIXELS)
