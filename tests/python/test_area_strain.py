"""examples/python/area_strain.py on pictures that are drawn: an ellipse whose area is known, with a blurred edge, noise,
uneven light, a lead that touches nothing, and a lens that distorts."""

import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from PIL import Image
from scipy import ndimage

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "examples/python/area_strain.py"
SIZE = (480, 640)


def draw(path, a_px, b_px, distortion=0.0, bright=False):
    """An ellipse of those half axes, seen through a lens with k1 of that size, four samples a pixel."""
    fine = 4
    y, x = (np.indices((SIZE[0] * fine, SIZE[1] * fine)) + 0.5) / fine - 0.5
    x, y = x - (SIZE[1] - 1) / 2, y - (SIZE[0] - 1) / 2
    out = 1 + distortion * (x * x + y * y) / (SIZE[1] / 2) ** 2
    inside = ((x * out - 12) / a_px) ** 2 + ((y * out + 7) / b_px) ** 2 < 1
    share = inside.reshape(SIZE[0], fine, SIZE[1], fine).mean(axis=(1, 3))
    share = ndimage.gaussian_filter(share, 1.5)
    light = 200 - 40 * np.hypot(*np.meshgrid(np.linspace(-1, 1, SIZE[1]), np.linspace(-1, 1, SIZE[0])))
    grey = light + (40 if bright else -110) * share
    grey[20:24, :] = 90  # a wire beside it
    grey += np.random.default_rng(1).normal(0, 2, SIZE)
    Image.fromarray(np.clip(grey, 0, 255).astype(np.uint8)).save(path)


class Area(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def measure(self, *arguments):
        done = subprocess.run([sys.executable, SCRIPT, "m.csv", *arguments], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = (self.folder / "m.csv").read_text().splitlines()
        return rows[0], [[float(x) for x in row.split(",")] for row in rows[1:]]

    def check(self, *arguments, **drawn):
        draw(self.folder / "0kV.png", 120, 110, **drawn)
        draw(self.folder / "2.5kV.png", 131, 118, **drawn)
        head, rows = self.measure("0kV.png", "2.5kV.png", *arguments)
        self.assertTrue(head.startswith("V (kV),electrode stretch,electrode stretch std"))
        self.assertEqual([row[0] for row in rows], [0, 2.5])
        wanted = math.sqrt(131 * 118 / (120 * 110))
        self.assertLess(rows[1][2], 0.002)
        self.assertLess(abs(rows[1][1] - wanted), 2 * rows[1][2])
        return rows

    def test_dark_and_bright(self):
        rows = self.check("--scale", "0.05")
        self.assertLess(abs(rows[0][3] - math.pi * 120 * 110 * 0.05**2), rows[0][4])
        self.check(bright=True)

    def test_lens(self):
        """A lens that is not told of gives another strain, which the edge does not explain; told of, the same as without."""
        self.check("--distortion", "0.2", distortion=0.2)
        off = self.measure("0kV.png", "2.5kV.png")[1][1]
        self.assertGreater(abs(off[1] - math.sqrt(131 * 118 / (120 * 110))), 2 * off[2])

    def test_refused(self):
        draw(self.folder / "1kV.png", 120, 300)
        draw(self.folder / "one.png", 120, 110)
        for name, said in (("1kV.png", "seen as a whole"), ("one.png", "no voltage"), ("9kV.png", "9kV.png")):
            done = subprocess.run([sys.executable, SCRIPT, "m.csv", name], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main()
