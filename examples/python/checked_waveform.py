"""The waveform of a protocol, once `dea drive` has checked it against amplifier and film."""

import csv
import os
import pathlib
import subprocess
import tempfile


def checked_waveform(protocol):
    """Times [s], commanded voltages [V] and control voltages [V]; SystemExit after a finding."""
    with tempfile.TemporaryDirectory() as folder:
        command = [os.environ.get("DEA_COMMAND", "dea"), "drive", protocol, "--export",
                   folder + "/files"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(done.stderr)
        with (pathlib.Path(folder) / "files/waveform.csv").open(newline="") as file:
            rows = [[float(value) for value in row] for row in list(csv.reader(file))[1:]]
    time_s, voltage_kV, control_V = map(list, zip(*rows))
    return time_s, [1e3 * value for value in voltage_kV], control_V
