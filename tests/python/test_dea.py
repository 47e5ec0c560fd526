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
        with self.assertRaisesRegex(KeyError, "is a curve, .* 'lumped/sweep/voltage_V'"):
            result["lumped/sweep"]
        with self.assertRaisesRegex(KeyError, "there are those of: lumped/path, "):
            result["something else entirely"]
        self.assertIn("lumped/sweep/voltage_V", result._ipython_key_completions_())
        with tempfile.TemporaryDirectory() as folder:
            result.save(folder + "/a.h5")
            again = dea.load(folder + "/a.h5")
            for name, array in result.items():
                np.testing.assert_array_equal(array, again[name])
            with self.assertRaises(dea.FileError):
                dea.load(folder + "/none.h5")
        self.assertEqual(result.design().yaml, DISC)
        self.assertIn("<svg", result._repr_html_())
        self.assertIn("electrode_edge_u_m = 0.0002699 at 4000 V", result._repr_html_())

    def test_abilities(self):
        self.assertEqual(set(dea.models()), {"lumped", "axisymmetric", "3d", "reduced"})
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

    def test_monitors(self):
        design = dea.Design(ROOT / "examples" / "devices" / "cone-mass.yaml")
        design["compute.voltage"] = {"to": "2 kV", "step": "2 kV"}
        result = dea.run(design, "3d", "sweep")
        z = result["3d/sweep/hub_z"]
        self.assertEqual((z.unit, len(z)), ("m", 2))
        np.testing.assert_array_equal(z, result["3d/sweep/hub_z_m"])
        np.testing.assert_allclose(z, result["3d/sweep/lowest_z_m"], rtol=1e-9)  # the hub hangs lowest
        with tempfile.TemporaryDirectory() as folder:
            result.save(folder + "/a.h5")
            np.testing.assert_array_equal(dea.load(folder + "/a.h5")["3d/sweep/hub_z"], z)
        actuator = dea.Actuator(design, "3d")
        actuator.solve(2e3)
        self.assertAlmostEqual(actuator["hub_z"] / z[-1], 1, delta=1e-6)


def cone(along, around):
    """A quarter of an annular film with a rigid hub, as in docs/python.md, and its nodes."""
    thickness = 100e-6 / 1.2**2
    ends = (25e-3 - 15e-3 * np.cos(np.linspace(0, np.pi, along + 1))) / 2
    r = np.interp(np.arange(2 * along + 1) / 2, np.arange(along + 1), ends)
    angle = np.linspace(0, np.pi / 2, 2 * around + 1)
    z, angle, r = np.meshgrid(np.linspace(0, thickness, 3), angle, r, indexing="ij")
    points = np.stack([r * np.cos(angle), r * np.sin(angle), z], -1).reshape(-1, 3)
    n = np.arange(len(points)).reshape(r.shape)
    cells = [n[:, j:j + 3, i:i + 3].ravel() for j in range(0, 2 * around, 2)
             for i in range(0, 2 * along, 2)]
    film = dea.Part("yeoh", [178.4e3, -6e3, 4.2e3], pre_stretch=1.2, permittivity=2.8,
                    electrode_gap_m=thickness)
    solid = dea.Solid([film], points_m=points, cells=cells, bodies=[dea.Body(nodes=n[:, :, 0])])
    solid.hold("x", nodes=n[:, -1, 1:])
    solid.hold("y", nodes=n[:, 0, 1:])
    solid.hold("xyz", nodes=points[:, 0]**2 + points[:, 1]**2 > (1 - 1e-6) * 20e-3**2)
    return solid


@unittest.skipUnless(dea.models()["3d"].available, "the 3D engine is not built")
class Solids(unittest.TestCase):
    def bar(self):
        """Rubber, 1 x 1 x 4 cm, on the planes x = 0, y = 0, z = 0."""
        bar = dea.Solid([dea.Part("neo-hookean", [0.4e6], density_kg_per_m3=1000)],
                        box_m=(0.01, 0.01, 0.04), elements=(1, 1, 2))
        for axis, high in zip("xyz", np.where(np.eye(3), 0, 1)):
            bar.hold(axis, low_m=(0, 0, 0), high_m=high)
        return bar

    def test_closed_form(self):
        """mu (l - 1/l^2) by a dead load, and by a displacement."""
        bar, mu, stretch = self.bar(), 0.4e6, 1.5
        bar.pull((0, 0, mu * (stretch - stretch**-2)), low_m=(0, 0, 0.04))
        bar.solve()
        points, moved = bar["points_m"], bar["displacement_m"]
        end = points[:, 2] > 0.0399
        np.testing.assert_allclose(moved[end, 2], 0.02, rtol=1e-6)
        self.assertEqual((moved.name, moved.unit, bar["unstable_modes"]),
                         ("displacement_m", "m", 0))
        mesh = bar.mesh()
        stress = mesh["principal_stress_Pa"]
        np.testing.assert_allclose(stress[:, 0], mu * (stretch**2 - 1 / stretch), rtol=1e-5)
        self.assertEqual((stress.unit, mesh.linear()[0]["hexahedron"].shape), ("Pa", (16, 8)))
        bar = self.bar()
        bar.hold("z", (0, 0, 0.04), nodes=end)
        bar.solve()
        self.assertAlmostEqual(bar["reaction_N"][end, 2].sum(), 70, delta=1e-4)
        held = bar["displacement_m"]
        bar.release("z", low_m=(0, 0, 0.04))
        bar.solve()
        self.assertAlmostEqual(np.abs(bar["displacement_m"]).max(), 0, delta=1e-9)
        self.assertAlmostEqual(held.max(), 0.04, delta=1e-9)  # a copy

    def test_cone(self):
        """Numbers of membrane theory, integrated apart from this library; a solid film is within
        1.5 % of them."""
        solid = cone(12, 4)
        wanted = {(0, 1): 106.540, (0, 4): 456.943, (3, 1): 91.994, (3, 4): 399.248,
                  (5, 1): 66.131, (5, 4): 296.161}
        for (kV, mm), mN in wanted.items():
            solid.hold_body(0, shift_m=(0, 0, 1e-3 * mm))
            solid.solve(1e3 * kV)
            self.assertAlmostEqual(4e3 * solid["body_force_N"][0, 2] / mN, 1, delta=0.015)
        solid.release_body(0, ["z"])
        solid.push_body(0, (0, 0, 0.02 * 9.80665 / 4))
        solid.solve(3e3)
        hung = solid["body_shift_m"][0, 2]
        self.assertAlmostEqual(hung / 2.0871e-3, 1, delta=0.015)
        # a spring that takes the whole weight there, by a table: nothing is left for the film
        weight = 0.02 * 9.80665 / 4
        solid.push_body(0, (0, 0, 2 * weight))
        number = solid.add_spring(0, "z", table=([0, hung, 2 * hung], [0, weight, weight]))
        solid.solve(3e3)
        self.assertAlmostEqual(solid["body_shift_m"][0, 2] / hung, 1, delta=1e-6)
        self.assertAlmostEqual(solid["spring_force_N"][number] / weight, 1, delta=1e-6)

    def test_channels_and_modes(self):
        """A plate capacitor that is held, and the first mode of a bar that is free to lengthen."""
        film = dea.Part("neo-hookean", [1e5], permittivity=3, electrode_gap_m=5e-5)
        plates = dea.Solid([film], box_m=(1e-3, 1e-3, 5e-5))
        plates.hold("xyz")
        plates.set_channel(1, 500)
        plates.solve(1000)
        plates.find_charges()
        C = 3 * 8.8541878128e-12 * 1e-6 / 5e-5
        np.testing.assert_allclose(plates["charge_C"], [-1500 * C, 1500 * C], rtol=1e-9)
        np.testing.assert_allclose(plates["capacitance_F"], [[C, -C], [-C, C]], rtol=1e-9)
        bar = self.bar()
        bar.solve()
        bar.modes(1)  # E = 3 mu; a slender bar, one end held
        self.assertAlmostEqual(bar["mode_Hz"][0] / (np.sqrt(1.2e6 / 1000) / 0.16), 1, delta=0.03)
        self.assertEqual(bar["mode_shape"].shape, (1, *bar["points_m"].shape))

    def test_path(self):
        """The voltage of a free film is highest where l^6 = 4."""
        mu, h = 0.4e6, 1e-4
        film = dea.Solid([dea.Part("neo-hookean", [mu], permittivity=3, electrode_gap_m=h)],
                         box_m=(1e-3, 1e-3, h))
        for axis, high in zip("xyz", np.where(np.eye(3), 0, 1)):
            film.hold(axis, high_m=high)
        peak = h * np.sqrt(mu / (3 * 8.8541878128e-12) * (4**(-1 / 3) - 4**(-4 / 3)))
        film.solve()
        film.path_begin(2 * peak, step=0.05, unit_m=1e-3)
        voltages = [0.0]
        while len(voltages) < 200 and voltages[-1] == max(voltages):
            film.path_step()
            voltages.append(film["voltage_V"])
        self.assertAlmostEqual(max(voltages) / peak, 1, delta=5e-3)

    def test_mesh_file(self):
        parts = [dea.Part("neo-hookean", [0.4e6])]
        msh = ROOT / "tests" / "fuzz" / "seeds" / "msh" / "two-squares-41.msh"
        bar = dea.Solid(parts, msh_file=msh, ply_thickness_m=[1e-4, 2e-4], ply_elements=[2, 1],
                        fills=[dea.Fill(0, None, 0), (1, "film", 0), (1, "electrode", 0)])
        self.assertEqual(bar["points_m"].shape, (15 * 7, 3))
        bar.hold("x", curve="left")
        with self.assertRaises(dea.ArgumentError):
            bar.hold("x", curve="right")
        with self.assertRaises(dea.DesignError):
            dea.Solid(parts, msh_file=ROOT / "README.md", ply_thickness_m=[1e-4],
                      fills=[(0, None, 0)])

    def test_refused(self):
        bar = self.bar()
        with self.assertRaises(dea.ArgumentError) as caught:
            bar["displacement"]
        self.assertIn("displacement_m", str(caught.exception))
        self.assertRaises(dea.ArgumentError, bar.set, "patience", 1)
        self.assertRaises(dea.ArgumentError, bar.hold, "x", nodes=[-1])
        self.assertRaises(ValueError, bar.hold, "w")
        self.assertRaises(ValueError, dea.Solid, [], points_m=np.zeros((8, 2)), cells=[[0] * 27])
        self.assertRaises(ValueError, dea.Solid, [], points_m=np.zeros((8, 3)), cells=[[0] * 8])
        with self.assertRaises(dea.ArgumentError) as caught:
            dea.Solid([dea.Part("neo-hooke", [1e5])], box_m=(1, 1, 1))
        self.assertIn("neo-hookean", str(caught.exception))
        self.assertIn("c1 [Pa]", dea.laws()["yeoh"].parameters)
        bar.pull((0, 0, 0.4e6), low_m=(0, 0, 0.04))
        bar.set("iterations", 1)
        self.assertEqual(bar.settings["newton_max_iterations"].value, 1)
        self.assertRaises(dea.SolverError, bar.solve)

    def test_points_outlive_the_solid(self):
        points = self.bar()["points_m"]
        gc.collect()
        others = [self.bar() for _ in range(3)]
        self.assertFalse(points.flags.owndata or points.flags.writeable)
        self.assertEqual(points.max(axis=0).tolist(), [0.01, 0.01, 0.04])
        del others

    def test_interrupt(self):
        """A signal ends a solve that is under way; the solid stays where it was, and works."""
        def stop(_signal, _frame):
            raise KeyboardInterrupt

        solid = cone(24, 8)
        solid.hold_body(0)
        solid.solve()
        solid.hold_body(0, shift_m=(0, 0, 10e-3))
        old = signal.signal(signal.SIGALRM, stop)
        try:
            with self.assertRaises(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_REAL, 0.05)  # of some seconds
                solid.solve(3e3)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, old)
        self.assertEqual((solid["body_shift_m"][0, 2], solid["voltage_V"]), (0, 0))
        solid.hold_body(0, shift_m=(0, 0, 1e-4))
        solid.solve()
        self.assertAlmostEqual(solid["body_shift_m"][0, 2], 1e-4, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
