"""Model reduced beside model 3d: a row a device of the table in docs/theory/reduced-model.md. Arguments: the command, the
source tree; --only "NAME;NAME"; --keep FOLDER: runs that are there are not made again."""

import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

DEA, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
ONLY = sys.argv[sys.argv.index("--only") + 1].split(";") if "--only" in sys.argv else None
FOLDER = tempfile.TemporaryDirectory(prefix="dea-reduced-")
WORK = pathlib.Path(sys.argv[sys.argv.index("--keep") + 1] if "--keep" in sys.argv else FOLDER.name).resolve()
UNITS = {"s": 1, "ms": 1e-3, "us": 1e-6, "Hz": 1, "kHz": 1e3, "m": 1, "mm": 1e-3, "um": 1e-6, "nm": 1e-9,
         "deg": np.pi / 180, "degree": np.pi / 180, "rad": 1, "mrad": 1e-3, "V": 1, "kV": 1e3}
MESH = ["-s", "compute.solid.refinement=1"]
VHB = """dea: 1
title: disc of VHB
film: {material: vhb-4910, thickness: 1 mm}
pre_stretch: 3
frame: {inner_radius: 15 mm}
electrodes: {radius: 3.75 mm stretched}
compute: {voltage: {to: 4 kV, step: 1 kV}}
"""
# name, design, highest voltage [kV]; the plate: with the quadrant in the east alone, what it does on both sides is the same
DEVICES = [("frdea-4", "frdea-4.yaml", 6), ("frdea-8", "frdea-8.yaml", 7), ("cone with mass", "devices/cone-mass.yaml", 4),
           ("bender", "devices/bender.yaml", 1), ("tilting plate", "devices/quadrants-round.yaml", 4), ("VHB disc", None, 4)]
OWN = ("VHB disc", "tilting plate")
MOTION = {"tilting plate": "turn_y"}
DRIVEN = {"VHB disc": 0.5} # of the highest voltage, in time; 0.8: its film is stiffer at once than its range of forces


RISE = {"tilting plate": 24} # cycles of a step, others 2: the model says from what time on it is within 3 %
HIGH = {"VHB disc": 2} # end of the frequencies, over the lowest mode at rest, others 1.1: it is stiffer at once


def one_quadrant(text):
    text = re.sub(r"^.*(north|west|south).*\n", "", text, flags=re.M)
    return re.sub(r", waveform: .*$", "}", text, flags=re.M)


def run(arguments, log):
    done = subprocess.run([str(DEA), *arguments], capture_output=True, text=True, cwd=WORK)
    (WORK / log).write_text(done.stdout + done.stderr)
    return done


def column(folder, pattern, name):
    """Columns x (the first of the names) and y (that begins so) of a run's table, in SI."""
    rows = list(csv.reader(next(folder.glob(pattern)).open()))
    found = []
    for begin in name:
        k = next(i for i, title in enumerate(rows[0]) if title.startswith(begin))
        unit = re.search(r"\((\w+)\)$", rows[0][k])
        found.append(np.array([float(r[k] or "nan") for r in rows[1:]]) * UNITS[unit[1]])
    return found


def both(device, case, settings, pattern, names):
    """The same study by both models: x, y of 3d, y of reduced at the same x."""
    out = []
    for model in ("3d", "reduced"):
        folder = WORK / f"{device['id']}-{case}-{model}"
        if not folder.exists():
            own = ["-s", f"compute.reduced.file={device['file']}"] if model == "reduced" else []
            if model == "reduced" and "transient" in settings: # its points so near that lines between them are it
                own += ["-s", "compute.transient.tolerance=1e-5", "-s", "compute.transient.interval=0 s"]
            run(["run", device["design"], "--model", model, "--no-figures", "-o", folder, *MESH, *settings, *own],
                folder.name + ".log")
        out.append(column(folder, pattern, names))
    (x, y), (x_r, y_r) = out
    x_r, once = np.unique(x_r, return_index=True)
    if x_r[-1] < x[-1] * (1 - 1e-6): # beyond its range
        raise IndexError(f"{device['id']}, {case}: it ends at {x_r[-1]:g}")
    return x, y, np.interp(x, x_r, y_r[once])


def make(name, design, kV):
    device = {"id": name.replace(" ", "-"), "kV": kV}
    device["file"] = f"{device['id']}.json"
    device["design"] = WORK / f"{device['id']}.yaml" if name in OWN else ROOT / "examples" / design
    if name in OWN:
        device["design"].write_text(VHB if design is None else one_quadrant((ROOT / "examples" / design).read_text()))
    log, before = WORK / f"{device['id']}.log", os.times().children_user
    if not log.exists():
        done = run(["reduce-order", device["design"], *MESH, "-s", f"compute.reduced.voltage={kV} kV", "-o", device["file"], "--c",
                    device["id"] + ".c", "-s", f"compute.reduced.motion={MOTION.get(name, 'largest')}"], log.name)
        with log.open("a") as out:
            out.write(f"\ncpu {os.times().children_user - before:.1f}\n")
        assert done.returncode == 0, done.stderr
    text = log.read_text()
    device["cpu_s"] = float(re.search(r"^cpu (.*)$", text, re.M)[1])
    device["made_s"] = float(re.search(r"^time +([\d.]+) s$", text, re.M)[1])
    device["viscous"] = re.search(r"^branches +([\d]+)$", text, re.M)[1] != "0"
    device["coordinate"] = re.search(r"^coordinate +(.*)$", text, re.M)[1]
    f = re.search(r"^frequency +([\d.]+) Hz", text, re.M)
    device["Hz"] = min(float(x) for x in re.findall(r"^frequency +([\d.]+) Hz, [1-9]", text, re.M)) if f else None
    return device


def checks(device):
    program, out = WORK / device["id"], []
    for kind in ("-DLONG", "-O3"):
        subprocess.run(["cc", "-std=c99", "-O3", kind, f'-DDEVICE="{device["id"]}.c"', f"-I{WORK}", ROOT / "verify/reduced_check.c",
                        "-lm", "-o", program], check=True)
        out += subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    return out


def row(name, design, kV):
    device = make(name, design, kV)
    at, V, T, n = device["coordinate"], DRIVEN.get(name, 0.8) * kV, 1 / device["Hz"], RISE.get(name, 2)
    cells = []
    studies = [
        ("statics", ["--study", "sweep", "-s", f"compute.voltage={{from: 0 kV, to: {kV} kV, step: {kV / 10} kV}}"], "*sweep.csv",
         ("V (", at + " (")),
        ("step", ["--study", "transient", "-s", f"drive.waveform={{kind: step, to: {V} kV, rise_time: {n * T} s, duration: {(n + 2) * T} s}}",
                  "-s", f"compute.transient={{inertia: yes, tolerance: 0.001, interval: {T / 40} s, rho_inf: 0.9}}"], "*transient.csv",
         ("time (", at + " (")),
        ("sine", ["--study", "transient", "-s",
                  f"drive.waveform={{kind: sine, mean: {V / 2} kV, amplitude: {V / 2} kV, phase: -90 degree, frequency: {0.5 / (n * T)} Hz, cycles: 1}}",
                  "-s", f"compute.transient={{inertia: yes, tolerance: 0.001, interval: {T / 20} s, rho_inf: 0.9}}"], "*transient.csv",
         ("time (", at + " (")),
        ("creep", ["--study", "transient", "-s", f"drive.waveform={{kind: step, to: {V} kV, rise_time: 10 ms, duration: 100 s}}", "-s",
                   "compute.transient={tolerance: 0.001}"], "*transient.csv", ("time (", at + " (")),
    ]
    for case, settings, pattern, names in studies:
        try:
            if case == "creep" and not device["viscous"]:
                cells.append("none")
                continue
            x, y, y_r = both(device, case, settings, pattern, names)
            late = x >= (0.01 if case == "creep" else 0) # its rise is not what creeps
            cells.append(f"{100 * np.max(np.abs(y - y_r)[late]) / np.ptp(y):.2f}")
        except (StopIteration, KeyError, IndexError):
            cells.append("-")
    amplitude = "amplitude " + re.sub("^[zu] ", "", at) + " (" # "z fibre tip"
    try:
        x, y, y_r = both(device, "frequency", [
            "--study", "frequency", "-s", f"compute.frequency={{bias: [{0.55 * kV} kV], from: {0.8 / T} Hz, to: {HIGH.get(name, 1.1) / T} Hz, points: {101 if name in HIGH else 31}}}"],
            "*frequency.csv", ("frequency (", amplitude))
        peak = [peak_of(x, a) for a in (y, y_r)]
        cells.append(f"{100 * abs(peak[1] / peak[0] - 1):.2f}")
    except (StopIteration, KeyError, IndexError):
        cells.append("-")
    reciprocity, energy, speed = checks(device)
    return [name, *cells, reciprocity, energy, f"{device['cpu_s']:.0f} s, {device['made_s']:.0f} s", f"{float(speed):.2g}"]


def peak_of(x, y):
    k = int(np.nanargmax(y[1:-1])) + 1
    c = np.polyfit(x[k - 1:k + 2] - x[k], y[k - 1:k + 2], 2)
    return x[k] - c[1] / (2 * c[0])


print("| device | statics | step | sine | creep | frequency | reciprocity | energy | CPU, time to make it | steps/s |")
print("|---|---|---|---|---|---|---|---|---|---|")
WORK.mkdir(exist_ok=True)
for device in DEVICES:
    if ONLY is None or device[0] in ONLY:
        print("| " + " | ".join(row(*device)) + " |", flush=True)
