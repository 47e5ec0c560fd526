"""The Python package, with the library of this build. Compared with the command where it can be."""

import gc
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import dea

ROOT = pathlib.Path(__file__).resolve().parents[2]
DISC = """dea: 1
title: disc
film: {material: elastosil-2030, thickness: 100 um}
pre_stretch: 1.5
frame: {inner_radius: 15 mm}
electrodes: {radius: 3.75 mm stretched}
compute:
  models: [lumped]
  voltage: {from: 0 kV, to: 4 kV, step: 1 kV}
"""


class Designs(unittest.TestCase):
    def test_values(self):
        design = dea.Design.parse(DISC)
        self.assertAlmostEqual(float(design["film.thickness"]), 1e-4, delta=1e-18)
        self.assertEqual(design["film.thickness"].unit, "m")
        self.assertEqual(design["film.thickness"].line, 3)
        design["film.thickness"] = "80 um"
        self.assertEqual(design["film.thickness"].origin, "set")
        self.assertIn("pre_stretch", design)
        with self.assertRaises(dea.ArgumentError):
            design["film.thicknes"]
        with self.assertRaises(ValueError):
            float(design["title"])

    def test_refused(self):
        design = dea.Design.parse(DISC)
        with self.assertRaises(dea.DesignError) as caught:
            design["film.thickness"] = "80"
        self.assertEqual(caught.exception.status, "DEA_E_DESIGN")
        self.assertEqual(caught.exception.findings[0].severity, "error")
        self.assertIn("no unit", str(caught.exception))
        self.assertEqual(str(design["film.thickness"]), "100 um")
        with self.assertRaises(OSError):
            dea.Design("/nowhere.yaml")

    def test_text(self):
        design = dea.Design.parse(DISC)
        design.update({"pre_stretch": 1.25, "compute.models": ["lumped", "axisymmetric"],
                       "compute.voltage": {"to": "2 kV", "step": "1 kV"}})
        again = dea.Design.parse(design.yaml)
        self.assertEqual([(v.key, v.text) for v in design.values()],
                         [(v.key, v.text) for v in again.values()])
        self.assertEqual(len(list(design.copy())), len(list(design)))
        self.assertTrue(design._repr_svg_().startswith("<svg"))


class Runs(unittest.TestCase):
    def test_numbers_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "disc.yaml")
            file.write_text(DISC)
            said = json.loads(subprocess.run([os.environ["DEA_COMMAND"], "run", file, "--json",
                                              "--quiet"], check=True, capture_output=True).stdout)
            result = dea.run(dea.Design(file))
        for key in ("voltage_V", "electrode_stretch", "breakdown_margin", "energy_J"):
            self.assertEqual(result[f"lumped/sweep/{key}"].tolist(),
                             [point[key] for point in said["points"]])

    def test_arrays_outlive_the_result(self):
        result = dea.run(dea.Design.parse(DISC))
        V = result["lumped/sweep/voltage_V"]
        part, wanted = V[1:3], [1e3, 2e3]
        self.assertFalse(V.flags.owndata or V.flags.writeable)
        self.assertEqual((part.unit, (2 * part).__class__), ("V", np.ndarray))
        del result, V
        gc.collect()
        others = [dea.run(dea.Design.parse(DISC)) for _ in range(3)]  # would take the memory
        self.assertEqual(part.tolist(), wanted)
        del others

    def test_table_and_files(self):
        result = dea.run(dea.Design.parse(DISC), "lumped", ["path", "sweep"])
        table = result.table("lumped/sweep")
        self.assertEqual({len(column) for column in table.values()}, {5})
        with self.assertRaises(KeyError):
            result["lumped/sweep/voltage"]
        with tempfile.TemporaryDirectory() as folder:
            result.save(folder + "/a.h5")
            again = dea.load(folder + "/a.h5")
            for name, array in result.items():
                np.testing.assert_array_equal(array, again[name])
            with self.assertRaises(dea.FileError):
                dea.load(folder + "/none.h5")
        self.assertEqual(result.design().yaml, DISC)
        self.assertIn("<svg", result._repr_html_())

    def test_abilities(self):
        self.assertEqual(set(dea.models()), {"lumped", "axisymmetric", "3d"})
        self.assertNotIn("indent", dea.models()["axisymmetric"].abilities)
        actuator = dea.Actuator(dea.Design.parse(DISC), "axisymmetric")
        actuator.solve(1e3)
        self.assertGreater(actuator["electrode_stretch"], 1)
        with self.assertRaises(NotImplementedError):
            actuator.indent(1e-4, 1e-3)
        with self.assertRaises(dea.DeaError):
            dea.run(dea.Design.parse(DISC), studies="sweeep")


class End(unittest.TestCase):
    def test_any_order(self):
        """A program may end with everything in one circle of references: Python then frees a
        context before its result."""
        script = f'''
import dea
def stop(what, done, total):
    if done == 2:
        raise KeyboardInterrupt
try:
    dea.run(dea.Design.parse({DISC!r}), progress=stop)
except KeyboardInterrupt as stopped:
    kept = stopped
'''
        subprocess.run([sys.executable, "-c", script], check=True)


class LongRuns(unittest.TestCase):
    def setUp(self):
        self.design = dea.Design.parse(DISC)
        self.design["compute.voltage"] = {"to": "4 kV", "step": "0.5 V"}  # 8001 voltages

    def test_interrupt(self):
        """Ctrl-C ends the run; what was computed is there."""
        begun = []

        def progress(what, done, total):
            if done == 20 and not begun:
                begun.append(done)
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt) as caught:
            dea.run(self.design, "lumped", "sweep", progress=progress)
        points = len(caught.exception.result["lumped/sweep/voltage_V"])
        self.assertTrue(20 <= points < 8001, points)

    def test_others_run_meanwhile(self):
        """Without the lock given free, the other thread would wait until the run has ended."""
        ended = threading.Event()
        while_running = []

        def count():
            while not ended.is_set():
                while_running.append(time.monotonic())
                time.sleep(1e-3)

        other = threading.Thread(target=count)
        old = sys.getswitchinterval()
        other.start()
        start = len(while_running)
        dea.run(self.design, "axisymmetric", "sweep")
        seen = len(while_running) - start
        ended.set()
        other.join()
        sys.setswitchinterval(old)
        self.assertGreater(seen, 3)


@unittest.skipUnless(dea.models()["3d"].available, "the 3D engine is not built")
class Fields(unittest.TestCase):
    def test_mesh(self):
        design = dea.Design(ROOT / "examples" / "frdea-4.yaml")
        design["compute.voltage"] = {"to": "2 kV", "step": "2 kV"}
        result = dea.run(design, "3d", "sweep")
        name = list(result.meshes())[-1]
        part, whole = result.mesh(name, whole=False), result.mesh(name)
        self.assertEqual(len(whole.points), 2 * part.fold * len(part.points))
        cells, elements = whole.linear()
        quads = np.asarray(whole.points)[cells["quad"]]
        # all the same way round, and together the disc inside of the frame of 15 mm
        a, b = quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1]
        areas = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        self.assertGreater(areas.min(), 0)
        self.assertAlmostEqual(areas.sum() / (np.pi * 0.015**2), 1, delta=0.02)
        self.assertEqual(len(elements["quad"]), len(quads))
        z = np.asarray(whole["displacement_m"])[:, 2]
        centre = result["3d/sweep/centre_z_m"][-1]
        middle = np.argmin(np.linalg.norm(np.asarray(whole.points)[:, :2], axis=1))
        self.assertAlmostEqual(z[middle], centre, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
