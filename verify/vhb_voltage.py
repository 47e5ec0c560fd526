"""A gripped strip of VHB 4905 under tension at 0 and 6 kV: the law is fitted at 0 kV, 6 kV is predicted.

    vhb_voltage.py COMMAND ROOT      the page on stdout; docs/validation/vhb-under-voltage.csv beside it

Width and length of the specimen are not known, so a strip is computed for several ratios of length to width. For each
the law is fitted such that the strip, not a homogeneous film, has the measured stress at 0 kV; nothing is fitted to
6 kV but the ratio that would do, which is said to be that.
"""
import csv
import json
import math
import os
import subprocess
import sys
import tempfile

COMMAND, ROOT = sys.argv[1:3]
DATA = os.path.join(ROOT, "examples/fit/vhb-4905")
THICKNESS_MM, WIDTH_MM, VOLTAGE_KV = 0.5, 20, 6
RATIOS = (1, 0.5, 0.25)
LAWS = ("neo-hookean", "ogden-1")
SHOWN = (1.25, 1.5, 2, 2.5, 2.95)
EPSILON_0 = 8.8541878128e-12


def table(name):
    """Rows of a file of the example as lists of numbers."""
    with open(os.path.join(DATA, name), encoding="utf-8") as file:
        return [[float(x) for x in row] for row in csv.reader(file) if row[0][0].isdigit()]


def loading(rows):
    """{stretch: stress (kPa)} up to the largest stretch."""
    top = max(range(len(rows)), key=lambda i: rows[i][1])
    return {round(row[1], 3): row[2] for row in rows[: top + 1]}


def interpolate(pairs, x):
    pairs = sorted(pairs)
    for (x0, y0), (x1, y1) in zip(pairs, pairs[1:]):
        if x0 <= x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    raise ValueError(f"{x} is outside of the data")


def permittivity(celsius):
    """At 0.3 to 3 Hz, the slowest that all temperatures have; in between straight."""
    by = {}
    for t, hz, value in table("permittivity.csv"):
        if 0.25 <= hz <= 3:
            by.setdefault(t, []).append(value)
    return interpolate([(t, sum(v) / len(v)) for t, v in by.items()], celsius)


def softer(celsius):
    """Stress there over that at 23 degC at the same stretch and rate: mean over the shown stretches."""
    curves = {t: loading(table(f"cycle-{t}C.csv")) for t in (20, 40, 60)}
    at = lambda t, s: interpolate([(k, interpolate(c.items(), s)) for k, c in curves.items()], t)
    return sum(at(celsius, s) / at(23, s) for s in SHOWN) / len(SHOWN)


def run(*words, cwd):
    done = subprocess.run([COMMAND, *words], cwd=cwd, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3, 4):
        sys.exit(f"dea {' '.join(words)}: {done.stderr}")


def fit(rows, law, folder):
    """fit.json of a law and its branches to (time, stretch, stress)."""
    with open(os.path.join(folder, "rows.csv"), "w", encoding="utf-8") as out:
        out.write("time (s),stretch,stress (kPa)\n" + "".join("%g,%g,%.6g\n" % tuple(r) for r in rows))
    with open(os.path.join(folder, "fit.yaml"), "w", encoding="utf-8") as out:
        out.write("dea_fit: 1\nname: tape\nmaterial: vhb-4905\nlaws: [%s]\nbranches: auto\n" % law +
                  "tests:\n  - {name: tension, kind: cyclic, file: rows.csv, uncertainty: 1 %, uncertainty_absolute: 0.5 kPa}\n")
    run("fit", "fit.yaml", "--force", cwd=folder)
    with open(os.path.join(folder, "fit.fit/fit.json"), encoding="utf-8") as file:
        return json.load(file)


def material(fitted, scale, eps):
    """Material of a design from fit.json, its moduli times a scale."""
    values = {p["name"]: p["value"] for p in fitted["parameters"]}
    stress = {p["name"] for p in fitted["parameters"] if p["unit"] == "Pa"}
    parameters = ", ".join(f"{k}: {v * scale:.9g} Pa" if k in stress else f"{k}: {v:.9g}" for k, v in values.items()
                           if v != 0 and not k.startswith(("modulus", "time")))
    branches, i = [], 1
    while f"modulus {i}" in values:
        branches.append(f"{{modulus: {scale * values[f'modulus {i}']:.9g} Pa, time: {values[f'time {i}']:.9g} s}}")
        i += 1
    return (f"  - name: tape\n    kind: elastomer\n"
            f"    laws: [{{id: fit, law: {fitted['law']}, parameters: {{{parameters}}}, source: this page}}]\n"
            f"    permittivity: [{{id: measured, at_rest: {eps:.4f}, slope: 0, source: this page}}]\n"
            f"    viscosity: [{{id: fit, branches: [{', '.join(branches)}], source: this page}}]\n")


def strip(ratio, tape, kilovolts, folder, back):
    """{kV: {(stretch, back): nominal stress (kPa)}} of the strip pulled to the stretch 3 at 0.2 1/s; with a voltage from
    1.15 to 2.95, since the voltage slackens a strip that is not stretched."""
    length, grip = ratio * WIDTH_MM, 1
    first, last, steps = (0, 2, 20) if kilovolts == (0,) else (0.15, 1.95, 18)
    levels = ", ".join(f"{kv} kV" for kv in kilovolts)
    with open(os.path.join(folder, "strip.yaml"), "w", encoding="utf-8") as out:
        out.write(f"""dea: 1
title: gripped strip of VHB 4905
materials:
{tape}shapes:
  - {{name: film, kind: rectangle, width: {length + 2 * grip} mm, height: {WIDTH_MM} mm}}
  - {{name: free, kind: rectangle, width: {length} mm, height: {WIDTH_MM} mm}}
  - {{name: left, kind: rectangle, x: {-(length + grip) / 2} mm, width: {grip} mm, height: {WIDTH_MM} mm}}
  - {{name: right, kind: rectangle, x: {(length + grip) / 2} mm, width: {grip} mm, height: {WIDTH_MM} mm}}
plies:
  - {{name: film, shape: film, material: tape, thickness: {THICKNESS_MM} mm}}
electrodes:
  - {{ply: film, side: bottom, shape: free, channel: ground}}
  - {{ply: film, side: top, shape: free, channel: drive}}
supports:
  - {{shape: left}}
bodies:
  - {{name: grip, shape: right, free: [x]}}
compute:
  models: [3d]
  voltage: {{to: 0.1 kV, step: 0.1 kV}}
  loading: {{body: grip, direction: x, from: {first * length} mm, to: {last * length} mm,
    steps: {steps}, duration: {5 * (last - first)} s, back: {back},
    voltage: [{levels}]}}
""")
    run("run", "strip.yaml", "--force", "-q", "--study", "loading", cwd=folder)
    stress = {}
    with open(os.path.join(folder, "strip.run/3d_loading_points.csv"), encoding="utf-8") as file:
        for row in csv.DictReader(file):
            key = round(1 + float(row["shift (mm)"]) / length, 3), row["back"] == "yes"
            stress.setdefault(float(row["V (kV)"]), {})[key] = float(row["force (mN)"]) / (WIDTH_MM * THICKNESS_MM)
    return stress


def fit_of_strip(ratio, law, measured, folder):
    """The fit whose strip has the measured stress: that of a film of free width to the measured stress over what a
    strip has more, asked of the strip once."""
    fitted = fit(measured, law, folder)
    with open(os.path.join(folder, "fit.fit/fit.csv"), encoding="utf-8") as file:
        free = [float(row[7]) for row in csv.reader(file) if row[0] == "tension"]
    own = strip(ratio, material(fitted, 1, 1), (0,), folder, "yes")[0]
    top = max(range(len(measured)), key=lambda i: measured[i][1])
    rows = []
    for i, (t, s, stress) in enumerate(measured):
        there = own.get((round(s, 3), i > top))
        if there is not None and there > 5:
            rows.append((t, s, stress * free[i] / there))
    return fit(rows, law, folder)


def drops(stress):
    """{stretch: fall of the nominal stress by the voltage (kPa)} on loading."""
    off, on = stress[0], stress[VOLTAGE_KV]
    at = {s: off[s, back] - on[s, back] for s, back in off if not back and (s, back) in on}
    between = [round(s + 0.05, 3) for s in at if round(s + 0.1, 3) in at]
    return at | {s: interpolate(at.items(), s) for s in between}


def held_drop(eps, s):
    """Of a film whose width is held, whatever its law: eps (V/H)^2 times the stretch."""
    return 1e-3 * eps * EPSILON_0 * (VOLTAGE_KV / THICKNESS_MM * 1e6) ** 2 * s


def line(words):
    print("| " + " | ".join(str(w) for w in words) + " |")


def main():
    off, on = table("tension-0kV.csv"), table("tension-6kV.csv")
    measured = {s: loading(off)[s] - v for s, v in loading(on).items() if s in loading(off)}
    eps, eps_50, soft = permittivity(23), permittivity(50), softer(50)
    found, misfit, warm = {}, {}, {}
    with tempfile.TemporaryDirectory() as folder:
        for law in LAWS:
            for ratio in RATIOS:
                fitted = fit_of_strip(ratio, law, off, folder)
                stress = strip(ratio, material(fitted, 1, eps), (0, VOLTAGE_KV), folder, "no")
                found[law, ratio] = drops(stress)
                squares = [(stress[0][s, False] - v) ** 2 for s, v in loading(off).items() if (s, False) in stress[0]]
                misfit[law, ratio] = math.sqrt(sum(squares) / len(squares))
                warm[law, ratio] = drops(strip(ratio, material(fitted, soft, eps_50), (0, VOLTAGE_KV), folder, "no"))
    write(measured, eps, eps_50, soft, found, misfit, warm)


def band(of, eps, s):
    """Lowest and highest of all strips and a film of held width."""
    values = [d[s] for d in of.values() if s in d] + [held_drop(eps, s)]
    return min(values), max(values)


def rows_of(of, eps, misfit):
    line(["law", "length to width", *SHOWN] + (["misfit at 0 kV (rms)"] if misfit else []))
    line(["---"] * (len(SHOWN) + (3 if misfit else 2)))
    for (law, ratio), d in of.items():
        cells = [f"{d[s]:.1f}" if s in d else "none" for s in SHOWN]
        line([law, ratio, *cells] + ([f"{misfit[law, ratio]:.1f} kPa"] if misfit else []))
    line(["any", "width held: eps (V/H)^2 times the stretch", *(f"{held_drop(eps, s):.1f}" for s in SHOWN)] + ([""] if misfit else []))
    bands = [band(of, eps, s) for s in SHOWN]
    line(["**band**", "", *(f"{low:.1f} to {high:.1f}" for low, high in bands)] + ([""] if misfit else []))


def write(measured, eps, eps_50, soft, found, misfit, warm):
    print("# VHB 4905 under voltage: tension at 0 kV fitted, at 6 kV predicted\n")
    print("""Made by `scripts/verify vhb-voltage`; not to be edited. A strip of tape of 0.5 mm is pulled at 0.2 1/s to the stretch 3 at
23 degC, at 0 and at 6 kV (`examples/fit/vhb-4905`, each file with its source). Width and length of the specimen and the
size of its electrodes were not published: the strip is computed for ratios of length to width, gripped at both ends,
with electrodes from grip to grip, by model 3d in time (`compute.loading.duration`); under voltage from the stretch 1.15 on, since 6 kV
slacken a strip that is stretched by less. For each ratio and law, law and
branches are those with which the strip, not a homogeneous film, has the stress that was measured at 0 kV. Nothing is
fitted to 6 kV. The permittivity is the measured one at 0.3 to 3 Hz: """ + f"{eps:.2f} at 23 degC, {eps_50:.2f} at 50 degC.\n")
    print("## What 6 kV take from the nominal stress (kPa), on loading\n")
    print("Measured: " + ", ".join(f"**{measured[s]:.1f}** at {s:g}" for s in SHOWN) + ".\n")
    rows_of(found, eps, misfit)
    common = [s for s in measured if s >= 1.1 and all(s in d for d in found.values())]
    inside = sum(low <= measured[s] <= high for s in common for low, high in [band(found, eps, s)])
    best = {key: math.sqrt(sum((d[s] - measured[s]) ** 2 for s in common if s in d) / len(common)) for key, d in found.items()}
    (law, ratio), rest = min(best.items(), key=lambda item: item[1])
    print(f"""
{inside} of {len(common)} measured values from the stretch 1.1 on lie inside the band. The strip nearest to them is that of ratio
{ratio:g} with {law} (rms {rest:.1f} kPa): which one is nearest is read from these data, not predicted; it becomes a test once the
specimen's size is known. The band is wide because the fall depends on how far the grips hold the width, and on how the
law answers across the pull, which tension alone does not tell.
""")
    print(f"## 50 degC, not looked at: the prediction\n\nModuli times {soft:.3f}, the stress of tape pulled at 0.1 1/s at 50 degC over that at 23 degC, "
          "between the measured 20, 40 and 60 degC;\nrelaxation times as at 23 degC. Fall of the nominal stress by 6 kV (kPa):\n")
    rows_of(warm, eps_50, None)
    print(f"\nThe central prediction is the strip that is nearest at 23 degC (ratio {ratio:g}, {law}): "
          + ", ".join(f"**{warm[law, ratio][s]:.1f}** at {s:g}" for s in SHOWN if s in warm[law, ratio])
          + ".\n[vhb-under-voltage.csv](vhb-under-voltage.csv) has these with their bands.")
    with open(os.path.join(ROOT, "docs/validation/vhb-under-voltage.csv"), "w", encoding="utf-8") as out:
        out.write("temperature (degC),stretch,measured drop (kPa),predicted drop (kPa),low (kPa),high (kPa)\n")
        for s in SHOWN:
            out.write("23,%g,%.2f,,%.2f,%.2f\n" % (s, measured[s], *band(found, eps, s)))
        for s in SHOWN:
            out.write("50,%g,,%s,%.2f,%.2f\n" % (s, "%.2f" % warm[law, ratio][s] if s in warm[law, ratio] else "", *band(warm, eps_50, s)))


main()
