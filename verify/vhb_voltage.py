"""A gripped strip of VHB 4905 under tension at 0 and 6 kV: the law is fitted at 0 kV, 6 kV is predicted.

    vhb_voltage.py COMMAND ROOT      the page on stdout; docs/validation/vhb-under-voltage.csv and
                                     docs/figures/vhb-under-voltage.svg beside it

Width and length of the specimen are not known, so a strip is computed for several ratios of length to width. For each
the law is fitted such that the strip, not a homogeneous film, has the measured stress at 0 kV; nothing is fitted to
6 kV but the ratio that would do, which is said to be that. The ends of the band, a film of free and of held width, are
integrated here, apart from the command.
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
LAW, LAWS = "neo-hookean", ("neo-hookean", "ogden-1")  # of the strips; of the film of free width
SHOWN = (1.25, 1.5, 2, 2.5, 2.95)
FIRST, FIRST_WARM, RATE = 1.15, {1: 1.25, 0.5: 1.15, 0.25: 1.25}, 0.2  # stretches from which a strip has an equilibrium under voltage; 1/s
MESH, FINER = "order: 1, order_z: 1", "order: 2, order_z: 1"
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


def strip(ratio, tape, kilovolts, folder, back="no", mesh=MESH, start=FIRST, end=2.95):
    """{kV: {(stretch, back): nominal stress (kPa)}} of the strip pulled to the stretch 3 at 0.2 1/s; with a voltage from
    start, since the voltage slackens a strip that is not stretched, to end."""
    length, grip = ratio * WIDTH_MM, 1
    first, last = (0, 2) if kilovolts == (0,) else (start - 1, end - 1)
    steps = round((last - first) / 0.1)
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
  solid: {{{mesh}}}
  loading: {{body: grip, direction: x, from: {first * length} mm, to: {last * length} mm,
    steps: {steps}, duration: {(last - first) / RATE} s, back: {back},
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
    """The fit whose strip has the measured stress, {stretch: the strip's stress (kPa)} on loading and its misfit (kPa): that of a
    film of free width to the measured stress over what a strip has more, asked of the strip once."""
    film = fit(measured, law, folder)
    free = fitted_stress(folder)
    own = strip(ratio, material(film, 1, 1), (0,), folder, "yes")[0]
    top = max(range(len(measured)), key=lambda i: measured[i][1])
    rows, more = [], []
    for i, (t, s, stress) in enumerate(measured):
        there = own.get((round(s, 3), i > top))
        if there is not None and there > 5:
            more.append(there / free[i])
            rows.append((t, s, stress / more[-1]))
    fitted = fit(rows, law, folder)
    count = sum(1 for t, _, _ in rows if t <= measured[top][0])
    strip_stress = [f * m for f, m in zip(fitted_stress(folder), more)][:count]
    squares = [(f - m * row[2]) ** 2 for f, m, row in zip(strip_stress, more, rows)]
    return fitted, {round(row[1], 3): f for row, f in zip(rows, strip_stress)}, math.sqrt(sum(squares) / count)


def fitted_stress(folder):
    """Stress of the fit at its rows (kPa)."""
    with open(os.path.join(folder, "fit.fit/fit.csv"), encoding="utf-8") as file:
        return [float(row[7]) for row in csv.reader(file) if row[0] == "tension"]


def drops(stress):
    """{stretch: fall of the nominal stress by the voltage (kPa)} on loading."""
    off, on = stress[0], stress[VOLTAGE_KV]
    at = {s: off[s, back] - on[s, back] for s, back in off if not back and (s, back) in on}
    between = [round(s + 0.05, 3) for s in at if round(s + 0.1, 3) in at]
    return dict(sorted((at | {s: interpolate(at.items(), s) for s in between}).items()))


def field_stress(eps):
    """eps (V/H)^2 (kPa)."""
    return 1e-3 * eps * EPSILON_0 * (VOLTAGE_KV / THICKNESS_MM * 1e6) ** 2


def held_drop(eps, stretches):
    """Of a film whose width is held, whatever its law: eps (V/H)^2 times the stretch."""
    return {s: field_stress(eps) * s for s in stretches}


def free_stress(fitted, scale, pull):
    """{stretch: nominal stress (kPa)} of a film of free width under eps (V/H)^2 = pull, pulled like the strip: from the
    energy of the law sum mu/alpha (l^alpha - 1) with branches mu/2 A : C, dA/dt = (1/C - A)/time, and the field's
    -pull/2 (l1 l2)^2."""
    p = {q["name"]: q["value"] * (1e-3 * scale if q["unit"] == "Pa" else 1) for q in fitted["parameters"]}
    mu, alpha = (p["mu"], 2) if fitted["law"] == "neo-hookean" else (p["mu1"], p["alpha1"])
    branches = [(p[f"modulus {i}"], p[f"time {i}"]) for i in range(1, 7) if f"modulus {i}" in p]
    states = [[1.0] * 3 for _ in branches]
    substeps, found, across, inverse = 20, {}, 1.0, [1.0] * 3

    def step(l1, l2, h):
        """Stresses along and across at the end of a step, and the branches there."""
        l = (l1, l2, 1 / (l1 * l2))
        new, at = [], [1 / x**2 for x in l]
        kirchhoff = [mu * x**alpha for x in l]
        for (modulus, time), state in zip(branches, states):
            e, mid = math.exp(-h / time), (1 - math.exp(-h / time)) / 2
            new.append([e * a + mid * (b + c) for a, b, c in zip(state, inverse, at)])
            kirchhoff = [k + modulus * a * x**2 for k, a, x in zip(kirchhoff, new[-1], l)]
        along, side = (kirchhoff[i] - kirchhoff[2] - pull * (l1 * l2) ** 2 for i in (0, 1))
        return along / l1, side / l2, new, at

    for n in range(1, 39 * substeps + 1):
        s = 1 + 0.05 * n / substeps
        low, high = 0.3, 3.0
        for _ in range(50):
            across = (low + high) / 2
            low, high = (low, across) if step(s, across, 0.05 / substeps / RATE)[1] > 0 else (across, high)
        stress, _, states, inverse = step(s, across, 0.05 / substeps / RATE)
        if n % substeps == 0:
            found[round(s, 3)] = stress
    return found


def free_drop(fitted, scale, eps):
    off, on = (free_stress(fitted, scale, pull) for pull in (0, field_stress(eps)))
    return {s: off[s] - on[s] for s in off}


def line(words):
    print("| " + " | ".join(str(w) for w in words) + " |")


def main():
    off, on = (loading(table(f"tension-{kv}kV.csv")) for kv in (0, 6))
    measured = {s: off[s] - v for s, v in on.items() if s in off and FIRST <= s <= SHOWN[-1]}
    eps, eps_50, soft = permittivity(23), permittivity(50), softer(50)
    found, misfit, warm, curves = {}, {}, {}, {}
    with tempfile.TemporaryDirectory() as folder:
        for law in LAWS:
            film = fit(table("tension-0kV.csv"), law, folder)
            found[law, "free"], warm[law, "free"] = free_drop(film, 1, eps), free_drop(film, soft, eps_50)
        for ratio in RATIOS:
            key = LAW, ratio
            fitted, curves[key], misfit[key] = fit_of_strip(ratio, LAW, table("tension-0kV.csv"), folder)
            tape = material(fitted, 1, eps)
            found[key] = drops(strip(ratio, tape, (0, VOLTAGE_KV), folder))
            end = 2.65 if ratio == RATIOS[-1] else 2.95  # from there on it thins in one place
            warm[key] = drops(strip(ratio, material(fitted, soft, eps_50), (0, VOLTAGE_KV), folder, start=FIRST_WARM[ratio], end=end))
        finer = drops(strip(ratio, tape, (0, VOLTAGE_KV), folder, mesh=FINER))
        coarse = [max(abs(finer[s] - found[key][s]) for s in finer if s <= end) for end in (2.5, 2.95)]
    for of, e in ((found, eps), (warm, eps_50)):
        of["any", "held"] = held_drop(e, measured)
    write(off, on, measured, (eps, eps_50, soft), found, misfit, warm, curves, (LAW, ratio, coarse))


def band(of, s):
    """Lowest and highest of all strips and the two films."""
    values = [d[s] for d in of.values() if s in d]
    return min(values), max(values)


NAMES = {"free": "long strip, width free", "held": "short strip, width held"}


def rows_of(of, misfit):
    line(["length to width", "law", *SHOWN, "misfit at 0 kV (rms)"])
    line(["---"] * (len(SHOWN) + 3))
    for (law, ratio), d in sorted(of.items(), key=lambda item: (list(NAMES) + list(RATIOS)).index(item[0][1]) if item[0][1] != "held" else 99):
        cells = [f"{d[s]:.1f}" if s in d else "none" for s in SHOWN]
        line([NAMES.get(ratio, ratio), law, *cells, f"{misfit[law, ratio]:.1f} kPa" if (law, ratio) in misfit else ""])
    line(["**band**", "", *("{:.1f} to {:.1f}".format(*band(of, s)) for s in SHOWN), ""])


def figure(off, on, measured, found, warm, curves, nearest):
    """Stresses, then falls by the voltage at 23 and 50 degC, each with its band, as SVG."""
    path = os.path.join(ROOT, "docs/figures/vhb-under-voltage.svg")
    rows = lambda pairs: "\n".join(" ".join(f"{x:.5g}" for x in row) for row in pairs) + "\ne\n"
    limits = lambda of: rows((s, *band(of, s)) for s in measured)
    curve, fall = curves[nearest], found[nearest]
    title = f"strip of ratio {nearest[1]:g}, {nearest[0]}"
    script = f"""set terminal svg size 1180,470 font 'Helvetica,13' background rgb 'white'
set output '{path}'
set multiplot layout 1,3 margins 0.055,0.985,0.13,0.72 spacing 0.06,0
set border 3; set tics nomirror; set xlabel 'stretch'; set xrange [1:3]; set style fill solid noborder
set key at graph 0.0, graph 1.33 left top reverse Left samplen 2
set title 'Tension at 23 degC' offset 0,4.5; set ylabel 'nominal stress (kPa)' offset 1; set yrange [0:]
plot '-' using 1:2 with points pt 7 ps 0.45 lc rgb 'black' title 'measured, 0 kV', \\
     '-' using 1:2 with points pt 6 ps 0.55 lc rgb '#cc0000' title 'measured, 6 kV', \\
     '-' using 1:2 with lines lw 2 lc rgb 'black' title 'fitted at 0 kV: {title}', \\
     '-' using 1:2 with lines lw 2 lc rgb '#cc0000' title 'the same strip at 6 kV; ratio: nearest of three'
{rows(off.items())}{rows(on.items())}{rows(sorted(curve.items()))}{rows((s, curve[s] - fall[s]) for s in fall if s in curve)}
set ylabel 'fall of the nominal stress by 6 kV (kPa)'; set yrange [0:20]
set title 'What 6 kV take, 23 degC' offset 0,4.5
plot '-' using 1:2:3 with filledcurves lc rgb '#cfe6f5' title 'predicted: width free (low) to held (high)', \\
     '-' using 1:2 with lines lw 1 dt 2 lc rgb '#0072b2' title 'strip of ratio 1 (neo-hookean)', \\
     '-' using 1:2 with lines lw 1 lc rgb '#0072b2' title 'strip of ratio 0.25 (neo-hookean)', \\
     '-' using 1:2 with points pt 7 ps 0.5 lc rgb '#cc0000' title 'measured'
{limits(found)}{rows(found["neo-hookean", 1].items())}{rows(found["neo-hookean", 0.25].items())}{rows(measured.items())}
set title 'What 6 kV take, 50 degC: prediction' offset 0,4.5
plot '-' using 1:2:3 with filledcurves lc rgb '#cfe6f5' title 'predicted: width free (low) to held (high)', \\
     '-' using 1:2 with lines lw 2 lc rgb '#0072b2' title '{title}', \\
     '-' using 1:2 with points pt 2 ps 0.8 lw 2 lc rgb '#0072b2' title 'stretches in the table'
{limits(warm)}{rows(warm[nearest].items())}{rows((s, warm[nearest][s]) for s in SHOWN)}"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def write_csv(measured, found, warm, nearest):
    with open(os.path.join(ROOT, "docs/validation/vhb-under-voltage.csv"), "w", encoding="utf-8") as out:
        out.write("temperature (degC),stretch,measured drop (kPa),low (kPa),high (kPa),in the band,drop of the strip nearest at 23 degC (kPa)\n")
        for celsius, of in ((23, found), (50, warm)):
            for s in measured:
                (low, high), m = band(of, s), measured[s] if celsius == 23 else math.nan
                inside = "" if math.isnan(m) else "yes" if low <= m <= high else "no"
                own = of[nearest].get(s)
                out.write(f"{celsius},{s:g},{'' if math.isnan(m) else f'{m:.2f}'},{low:.2f},{high:.2f},{inside},{'' if own is None else f'{own:.2f}'}\n")


def write(off, on, measured, numbers, found, misfit, warm, curves, check):
    eps, eps_50, soft = numbers
    _, check_ratio, coarse = check
    inside = [low <= measured[s] <= high for s in measured for low, high in [band(found, s)]]
    strips = {key: d for key, d in found.items() if key[1] in RATIOS}
    best = {key: math.sqrt(sum((d[s] - measured[s]) ** 2 for s in measured if s in d) / sum(s in d for s in measured)) for key, d in strips.items()}
    nearest = min(best, key=best.get)
    _, ratio = nearest
    figure(off, on, measured, found, warm, curves, nearest)
    write_csv(measured, found, warm, nearest)
    widest = max(high / low for low, high in (band(found, s) for s in measured))
    print(f"""# VHB 4905 under voltage: tension at 0 kV fitted, at 6 kV predicted

Made by `scripts/verify vhb-voltage`; not to be edited. A strip of tape of 0.5 mm is pulled at 0.2 1/s to the stretch 3 at
23 degC, at 0 and at 6 kV (`examples/fit/vhb-4905`, each file with its source). Width and length of the specimen and the
size of its electrodes were not published: the strip is computed for ratios of length to width, gripped at both ends,
with electrodes from grip to grip, by model 3d in time (`compute.loading.duration`); under voltage from the stretch {FIRST} on ({FIRST_WARM[1]:g} at
50 degC, ratios 1 and 0.25), since 6 kV slacken a strip that is stretched by less. For each ratio, the neo-Hookean law and branches are
those with which the strip, not a homogeneous film, has the stress that was measured at 0 kV. Nothing is fitted to 6 kV. The permittivity is the measured one
at 0.3 to 3 Hz: {eps:.2f} at 23 degC, {eps_50:.2f} at 50 degC. The ends of the band are a film whose width is free (a long strip), integrated
apart from `dea`, and one whose width is held, for which any law gives eps (V/H)^2 times the stretch.

**{sum(inside)} of {len(inside)} measured falls of the stress by 6 kV, at the stretches {min(measured):g} to {max(measured):g}, lie inside the band.** The band is wide, up to a factor of
{widest:.1f} from free to held width; [vhb-under-voltage.csv](vhb-under-voltage.csv) has all numbers.

![Tension at 0 and 6 kV, and what 6 kV take at 23 and 50 degC](../figures/vhb-under-voltage.svg)

## What 6 kV take from the nominal stress (kPa), on loading
""")
    print("Measured: " + ", ".join(f"**{measured[s]:.1f}** at {s:g}" for s in SHOWN) + ".\n")
    rows_of(found, misfit)
    print(f"""
The strip nearest to the measured values is that of ratio {ratio:g} (rms {best[nearest]:.1f} kPa): which one is nearest is read from these data, not
predicted; it becomes a test once the specimen's size is known. **No strip follows the measured values**: from the stretch {SHOWN[0]:g} to {SHOWN[-1]:g} they grow by a
factor of {measured[SHOWN[-1]] / measured[SHOWN[0]]:.1f}, those of the nearest strip by {found[nearest][SHOWN[-1]] / found[nearest][SHOWN[0]]:.1f}, as if the specimen were held wider at the start than at the end. What could do that, and was not tested:
a permittivity that falls with stretch, electrodes that do not reach the grips, another law across the pull.

Model 3d flags the strips under 6 kV as `slack` below the stretch 1.2 and from about 2.3 on (2.0 at 50 degC): beside the grips, which hold
back the widening, the film loses its tension. These numbers are of a flat one.

Mesh: the fall of the strip of ratio {check_ratio:g} changes by at most {coarse[0]:.2f} kPa up to the stretch 2.5, and {coarse[1]:.2f} beyond, with elements of second
order in the plane.

## 50 degC, not looked at: the prediction

Nothing is fitted at 50 degC under voltage, and no such measurement was read. Moduli times {soft:.3f}, the stress of tape pulled at 0.1 1/s at
50 degC over that at 23 degC, between the measured 20, 40 and 60 degC; relaxation times as at 23 degC. Fall of the nominal stress by 6 kV
(kPa); the shortest strip thins in one place from about the stretch 2.7 on:
""")
    rows_of(warm, {})
    print(f"\nThe central prediction is the strip that is nearest at 23 degC (ratio {ratio:g}), as the specimen's size is the same: "
          + ", ".join(f"**{warm[nearest][s]:.1f}** at {s:g}" for s in SHOWN) + ".")


main()
