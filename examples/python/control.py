#!/usr/bin/python3
"""Control of a film by its reduced model: feed-forward against creep, an observer without a displacement sensor, a loop.

    dea reduce-order examples/devices/pure-shear.yaml --fmu strip.fmu
    control.py strip.fmu        prints the errors, draws control.svg (gnuplot)

The film is the unit, without inertia, behind an amplifier of which nobody knows that its gain is 1 % off and its
resistance; there is noise on what is measured, and from the middle of the run on a force pulls at the film.

  static         the voltage at which the model would rest at the reference in the end
  feed-forward   the voltage at which the model, which creeps, is at the reference at each time
  loop           the same, and the integral of the reference less what the observer says

Observer: the charge Q is the integral of the current. At a voltage the model knows displacement and charge at any force,
and what its branches pull back with is one: so V and Q say the displacement, whatever the film did before. Q is scaled
by the capacitance at the start, from where displacements count. The integral of noise is a random walk: a film that
stands for hours needs an alternating voltage on top instead.
"""
import ctypes as c
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
import zipfile

import numpy as np
from scipy.optimize import brentq

STEP, LENGTH, RESISTANCE, AMPLIFIER = 4e-3, 40.0, 1e6, 1.01  # s, s, ohm
VOLT_NOISE, CURRENT_NOISE, GAIN, SMOOTH = 0.5, 0.2e-9, 2.0, 0.1  # V, A, 1/s, s


class Unit:
    """An instance of a co-simulation unit of FMI 3.0, at rest at its first inputs."""

    def __init__(self, path, **start):
        self.folder = tempfile.TemporaryDirectory()
        zipfile.ZipFile(path).extractall(self.folder.name)
        root = xml.parse(self.folder.name + "/modelDescription.xml").getroot()
        self.reference = {v.get("name"): int(v.get("valueReference")) for v in root.find("ModelVariables")}
        name = root.find("CoSimulation").get("modelIdentifier") + ".so"
        self.of = c.CDLL(str(next(pathlib.Path(self.folder.name).glob("binaries/*-linux/" + name))))
        self.of.fmi3InstantiateCoSimulation.restype = c.c_void_p
        self.one = c.c_void_p(self.make(root.get("instantiationToken")))
        self.now = 0.0
        self.rest(**start)

    def make(self, token):
        no = [False] * 4
        return self.of.fmi3InstantiateCoSimulation(b"film", token.encode(), None, *no, None, c.c_size_t(0), None, None, None)

    def rest(self, **start):
        """At rest for long, with these inputs and parameters."""
        self.of.fmi3Reset(self.one)
        self.of.fmi3EnterInitializationMode(self.one, False, c.c_double(0), c.c_double(0), False, c.c_double(0))
        self.put(**start)
        if self.of.fmi3ExitInitializationMode(self.one) != 0:
            raise ValueError("beyond the model's range")
        self.now = 0.0

    def call(self, function, names, values):
        count = c.c_size_t(len(names))
        at = (c.c_uint32 * len(names))(*(self.reference[n] for n in names))
        if function(self.one, at, count, values, count) != 0:
            raise ValueError("refused: " + ", ".join(names))
        return values

    def put(self, **values):
        self.call(self.of.fmi3SetFloat64, list(values), (c.c_double * len(values))(*values.values()))

    def get(self, *names):
        return tuple(self.call(self.of.fmi3GetFloat64, names, (c.c_double * len(names))()))

    def step(self, length):
        flags, last = [c.c_bool() for _ in range(3)], c.c_double()
        if self.of.fmi3DoStep(self.one, c.c_double(self.now), c.c_double(length), True, *map(c.byref, flags), c.byref(last)) != 0:
            raise ValueError("beyond the model's range")
        self.now += length

    def keep(self):
        state = c.c_void_p()
        self.of.fmi3GetFMUState(self.one, c.byref(state))
        return state

    def restore(self, state):
        self.of.fmi3SetFMUState(self.one, state)
        self.of.fmi3FreeFMUState(self.one, c.byref(state))


def reference(t, low, high):
    """Levels with ramps between them."""
    return np.interp(t, [0, 2, 3, 13, 14, 24, 25, 40], np.array([0, 0, 0.6, 0.6, 0.9, 0.9, 0.3, 0.3])) * (high - low) + low


def invert(model, wanted, first, highest, length):
    """The voltage at the end of a step at which the model is at a displacement; a step of it with that (regula falsi)."""
    def off(u):
        state = model.keep()
        model.put(voltage=np.sqrt(u))
        model.step(length)
        q, = model.get("displacement")
        model.restore(state)
        model.now -= length
        return q - wanted

    u = [first, min(1.02 * first + 1e-4 * highest, highest)]
    f = [off(v) for v in u]
    for _ in range(8):
        if f[1] == f[0] or abs(f[1]) < 1e-10:
            break
        u = [u[1], min(max(u[1] - f[1] * (u[1] - u[0]) / (f[1] - f[0]), 0), highest)]
        f = [f[1], off(u[1])]
    model.put(voltage=np.sqrt(u[1]))
    model.step(length)
    return u[1]


def observer(model, highest_V, stroke):
    """Displacement by voltage and charge: rows of voltages, each a parabola through the states at some forces."""
    model.rest(voltage=0, force=1e-6, inertia=0, longest_step=STEP)
    pulled, = model.get("displacement")
    model.rest(voltage=0, inertia=0, longest_step=STEP)
    rest, = model.get("displacement")
    forces = 0.9 * np.linspace(-1, 1, 7) * stroke * 1e-6 / (pulled - rest)
    table = []
    for volts in np.linspace(0.05, 1, 39) * highest_V:
        row = []
        for force in forces:
            model.rest(voltage=volts, force=force, inertia=0, longest_step=STEP)
            row.append(model.get("charge", "displacement"))
        charge, q = np.array(row).T
        table.append((volts, *np.polyfit(1e12 * charge / volts, q, 2)))
    table = np.array(table)

    def at(volts, charge):
        terms = [np.interp(volts, table[:, 0], table[:, k]) for k in (1, 2, 3)]
        return np.polyval(terms, 1e12 * charge / volts)

    return at


def run(path, volts, wanted, force, observe=None, by_q=1.0, highest_V=np.inf):
    """The film under voltages, with the loop where observe is given: displacement, what the observer says."""
    film = Unit(path, voltage=AMPLIFIER * volts[0], series_resistance=RESISTANCE, inertia=0, longest_step=STEP)
    noise = np.random.default_rng(1).standard_normal((len(volts), 2))
    charge, start = film.get("charge", "displacement")
    scale = 1.0
    if observe is not None:
        scale = brentq(lambda r: observe(AMPLIFIER * volts[0], r * charge) - wanted[0], 0.9, 1.1)
    q, said, more, off = [], [], 0.0, 0.0
    for k in range(len(volts)):
        film.put(voltage=AMPLIFIER * min(np.sqrt(max(volts[k] ** 2 + more, 0)), highest_V), force=force[k])
        before, = film.get("charge")
        film.step(STEP)
        here, V, after = film.get("displacement", "film_voltage", "charge")
        charge += after - before + CURRENT_NOISE * noise[k, 0] * STEP  # the mean current of the sample
        q.append(here - start + wanted[0])
        if observe is not None:  # what the noise adds is smoothed beside the reference, so that nothing lags
            off += STEP / SMOOTH * (observe(V + VOLT_NOISE * noise[k, 1], scale * charge) - wanted[k] - off)
            more -= GAIN * STEP * off / by_q
        said.append(wanted[k] + off)
    return np.array(q), np.array(said)


def draw(path, t, columns):
    """Three panels by gnuplot, in micrometres."""
    data = path.with_suffix(".txt")
    np.savetxt(data, np.column_stack([t, *columns])[::10])
    script = f"""set terminal svg size 720,760 font 'DejaVu Sans,11' background '#ffffff'
set output '{path}'
set multiplot layout 3,1
set xlabel 'time (s)'
set key outside right
set grid
set lmargin 10
set rmargin 26
set ylabel 'displacement (um)'
plot '{data}' u 1:2 w l lw 3 lc '#bbbbbb' t 'reference', '' u 1:3 w l lc '#d55e00' t 'static', '' u 1:4 w l lc '#0072b2' t 'feed-forward', \\
  '' u 1:6 w l lc '#009e73' t 'loop'
set ylabel 'error (um)'
plot '{data}' u 1:($3-$2) w l lc '#d55e00' t 'static', '' u 1:($4-$2) w l lc '#0072b2' t 'feed-forward', \\
  '' u 1:($5-$2) w l lc '#cc79a7' t 'feed-forward, force', '' u 1:($6-$2) w l lc '#009e73' t 'loop, force'
set ylabel 'observer, error (um)'
plot '{data}' u 1:($7-$6) w l lc '#009e73' t 'loop, force'
"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)
    data.unlink()


def main(path, highest_V=3500.0, pull_N=5e-3):
    model = Unit(path, inertia=0, longest_step=STEP)
    ends = []
    for V in 0.0, highest_V:
        model.rest(voltage=V, inertia=0, longest_step=STEP)
        ends += model.get("displacement")
    stroke = ends[1] - ends[0]
    grid = np.linspace(0, highest_V, 91)
    at_rest = []
    for V in grid:
        model.rest(voltage=V, inertia=0, longest_step=STEP)
        at_rest += model.get("displacement")
    t = np.arange(1, round(LENGTH / STEP) + 1) * STEP
    wanted = reference(t, ends[0] + 0.1 * stroke, ends[0] + 0.6 * stroke)
    order = np.argsort(at_rest)
    static = np.interp(wanted, np.array(at_rest)[order], grid[order])
    model.rest(voltage=static[0], inertia=0, longest_step=1)
    coarse, u = 5, [static[0] ** 2]
    for k in range(coarse - 1, len(t), coarse):
        u.append(invert(model, wanted[k], u[-1], highest_V**2, coarse * STEP))
    forward = np.sqrt(np.interp(t, np.arange(len(u)) * coarse * STEP, u))
    observe = observer(model, highest_V, stroke)
    none, pull = np.zeros(len(t)), np.where(t > LENGTH / 2, pull_N, 0)
    by_static, by_forward = (run(path, volts, wanted, none)[0] for volts in (static, forward))
    pulled = run(path, forward, wanted, pull)[0]
    looped, said = run(path, forward, wanted, pull, observe, stroke / highest_V**2, highest_V)
    levels = [(t > a + 0.5) & (t < b) for a, b in ((3, 13), (14, 24), (25, 40))]
    calm = (t < LENGTH / 2) | (t > LENGTH / 2 + 2)  # after the force began
    held = np.any(levels, axis=0) & calm
    size = np.ptp(wanted)
    figures = {
        "creep, static": max(np.ptp(by_static[level]) for level in levels),
        "creep, feed-forward": max(np.ptp(by_forward[level]) for level in levels),
        "error, feed-forward": np.max(np.abs(pulled - wanted)[held]),
        "error, loop": np.max(np.abs(looped - wanted)[held]),
        "observer, on levels": np.max(np.abs(said - looped)[held]),
    }
    for name, error in figures.items():
        print(f"{name:22} {1e6 * error:8.3f} um  {100 * error / size:7.3f} % of {1e6 * size:.0f} um")
    draw(pathlib.Path("control.svg").resolve(), t, [1e6 * y for y in (wanted, by_static, by_forward, pulled, looped, said)])
    return {name: error / size for name, error in figures.items()}


if __name__ == "__main__":
    main(sys.argv[1])
