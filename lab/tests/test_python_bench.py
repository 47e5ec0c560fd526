"""The scripts of examples/python with stand-ins for nidaqmx and pyvisa, and dea.write_recording."""

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import dea

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEA = os.environ["DEA_COMMAND"]
PROTOCOL = """dea-protocol: 1
waveform: {kind: triangle, low: 0 kV, high: 2 kV, cycles: 1, frequency: 2 Hz}
amplifier: {gain: 1000, max_voltage: %s, current_limit: 10 mA}
rate: 100 Hz
channels: [{name: v, quantity: voltage, input: ai0, range: 10 V, per_volt: 1 kV}]
"""


class Bench(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.protocol = self.folder / "protocol.yaml"
        self.protocol.write_text(PROTOCOL % "5 kV")
        self.log = self.folder / "log"
        self.log.write_text("")

    def play(self, script, *arguments, **settings):
        path = os.pathsep.join([os.environ["PYTHONPATH"], str(ROOT / "tests/stub")])
        return subprocess.run(
            [sys.executable, ROOT / "examples/python" / script, self.protocol, *arguments],
            capture_output=True, text=True, cwd=self.folder,
            env={**os.environ, "PYTHONPATH": path, "STUB_LOG": str(self.log), **settings})

    def channels(self, name):
        done = subprocess.run([DEA, "recording", self.folder / name, "--json"], check=True,
                              capture_output=True, text=True)
        return {channel["name"]: channel for channel in json.loads(done.stdout)["channels"]}

    def test_nidaqmx(self):
        done = self.play("play_nidaqmx.py", "ni.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        channels = self.channels("ni.h5")
        self.assertEqual(channels["voltage"]["count"], 51)  # 0.5 s at 100 Hz
        self.assertAlmostEqual(channels["voltage"]["highest"], 2000, delta=1e-9)
        self.assertAlmostEqual(channels["current"]["highest"], 1e-5, delta=1e-14)

    def test_nidaqmx_ends_at_zero(self):
        done = self.play("play_nidaqmx.py", "ni.h5", STUB_FAIL="20")
        self.assertIn("the device was taken away", done.stderr)
        self.assertIn("write 0\n", self.log.read_text())

    def test_pyvisa(self):
        done = self.play("play_visa.py", "GPIB::3", "visa.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("at the end: 0.000 V", done.stdout)
        self.assertTrue(self.log.read_text().endswith("SOUR:VOLT 0\nOUTP OFF\n"))
        self.assertEqual(self.channels("visa.h5")["commanded voltage"]["quantity"], "command")

    def test_protocol_is_checked_before(self):
        self.protocol.write_text(PROTOCOL % "1 kV")
        done = self.play("play_visa.py", "GPIB::3", "visa.h5")
        self.assertIn("the amplifier gives 1 kV at most", done.stderr)
        self.assertEqual(self.log.read_text(), "")

    def test_recording(self):
        file = self.folder / "own.h5"
        time_s = [0, 0.1, 0.2, 0.3]
        dea.write_recording(file, time_s, {"voltage (kV)": [0, 1, 2, 1],
                                           "displacement (um)": [0, 5, math.nan, 5]})
        channels = self.channels("own.h5")
        self.assertEqual(channels["voltage"]["highest"], 2000)
        self.assertAlmostEqual(channels["displacement"]["highest"], 5e-6, delta=1e-18)
        self.assertRaises(dea.FileError, dea.write_recording, file, time_s, {"voltage (V)": time_s})
        dea.write_recording(file, time_s, {"voltage (V)": time_s}, replace=True)
        self.assertRaises(ValueError, dea.write_recording, file, time_s, {"voltage (V)": [1]})


if __name__ == "__main__":
    unittest.main()
