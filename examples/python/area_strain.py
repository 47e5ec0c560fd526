#!/usr/bin/python3
"""Area strain of an electrode from pictures of it: NAME.csv for `dea compare` and `dea fit`.

    area_strain.py measured.csv 0kV.png 1.5kV.png 3kV.png ... [--scale 0.021] [--distortion 0.03]

The voltage is in each name; the first picture is the state at rest. The electrode is the largest thing that is darker or
brighter than what surrounds it. A pixel counts by how far its grey is between that of the surroundings, a parabola in
x and y, and that of the electrode, so that the edge need not follow pixels. scale: mm a pixel, for the area in mm2; the
strain does not need it. distortion: k1 of r_true = r (1 + k1 r^2), r from the middle of the picture over half its width.

Standard uncertainty: that of the edge, half of what a value changes by if the edge is taken at 40 and at 60 % of the
contrast in all pictures alike, and 0.1 pixel all around. What the lens distorts is in it only where k1 is given.
"""
import argparse
import pathlib
import re
import sys

import numpy as np
from PIL import Image
from scipy import ndimage

EDGE_PX = 6  # how far a blurred edge may reach


def surroundings(grey, outside):
    """Parabola in x and y through what is outside of the electrode."""
    y, x = np.mgrid[-1 : 1 : grey.shape[0] * 1j, -1 : 1 : grey.shape[1] * 1j]
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    found = np.linalg.lstsq(terms[outside], grey[outside], rcond=None)[0]
    return terms @ found


def largest(mask):
    """The largest thing of a mask, without its holes."""
    labels, count = ndimage.label(mask)
    if count == 0:
        return mask
    sizes = ndimage.sum_labels(mask, labels, range(1, count + 1))
    return ndimage.binary_fill_holes(labels == 1 + int(np.argmax(sizes)))


def area_px(path, distortion=0.0):
    """Area, and with the edge at 40 and at 60 % of the contrast (pixels); ValueError: no electrode is seen as a whole."""
    grey = np.asarray(Image.open(path).convert("F"))
    seen = np.abs(grey - np.median(grey[[0, -1], :])) / max(np.ptp(grey), 1)
    body = largest(ndimage.gaussian_filter(seen, 2) > 0.5 * np.percentile(seen, 99.5))
    for _ in range(2):  # what surrounds it, then where it is
        near = ndimage.binary_dilation(body, iterations=EDGE_PX)
        core = ndimage.binary_erosion(body, iterations=EDGE_PX)
        if not core.any() or near[[0, -1], :].any() or near[:, [0, -1]].any():
            raise ValueError(f"{path}: no electrode that is seen as a whole, with something around it")
        contrast = grey - surroundings(grey, ~near)
        share = contrast / np.median(contrast[core])
        body = largest(share > 0.5)
    near, core = ndimage.binary_dilation(body, iterations=EDGE_PX), ndimage.binary_erosion(body, iterations=EDGE_PX)
    y, x = np.indices(grey.shape, dtype=float)
    r2 = ((x - (grey.shape[1] - 1) / 2) ** 2 + (y - (grey.shape[0] - 1) / 2) ** 2) / (grey.shape[1] / 2) ** 2
    true = (1 + distortion * r2) * (1 + 3 * distortion * r2)
    cover = np.where(core, 1, np.where(near, np.clip(share, 0, 1), 0))
    return float(np.sum(cover * true)), *(float(np.sum(true[near & (share > level) | core])) for level in (0.4, 0.6))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("table")
    parser.add_argument("pictures", nargs="+")
    parser.add_argument("--scale", type=float, help="mm a pixel")
    parser.add_argument("--distortion", type=float, default=0.0)
    given = parser.parse_args()
    rows = []
    for picture in given.pictures:
        kilovolts = re.search(r"(\d+(?:\.\d+)?) ?kV", pathlib.Path(picture).name)
        if not kilovolts:
            sys.exit(f"{picture}: no voltage such as 1.5kV in its name")
        try:
            rows.append((float(kilovolts[1]), *area_px(picture, given.distortion)))
        except (OSError, ValueError) as error:
            sys.exit(str(error))
    with open(given.table, "w", encoding="utf-8") as out:
        out.write("V (kV),electrode stretch,electrode stretch std" + (",area (mm2),area std (mm2)" if given.scale else "") + "\n")
        for kilovolts, *areas in rows:
            stretches = [(area / rest) ** 0.5 for area, rest in zip(areas, rows[0][1:])]
            pixel = 0.1 * (np.pi / areas[0]) ** 0.5  # of the radius of a circle of that area
            own = np.hypot((stretches[1] - stretches[2]) / 2, pixel * 2**0.5) if areas[0] != rows[0][1] else 0
            size = ""
            if given.scale:
                std = np.hypot((areas[1] - areas[2]) / 2, 2 * pixel * areas[0])
                size = f",{areas[0] * given.scale**2:.6g},{std * given.scale**2:.2g}"
            out.write(f"{kilovolts:g},{stretches[0]:.6f},{own:.2g}{size}\n")
            print(f"{kilovolts:g} kV: area strain {100 * (stretches[0] ** 2 - 1):.2f} +- {200 * own * stretches[0]:.2f} %")


if __name__ == "__main__":
    main()
