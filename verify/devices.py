"""Devices of the literature: what was measured beside what is computed, with a band; nothing is fitted.

    devices.py COMMAND ROOT      the page on stdout; docs/validation/devices.csv and docs/figures/devices.svg beside it

A device is a design of verify/devices, its measured values, and its inputs, each with a low, a nominal and a high value.
The design is run at the nominal values and at every corner of low and high; the band of a computed value goes from the
least to the largest of these.
"""
import csv
import itertools
import math
import os
import subprocess
import sys
import tempfile
import textwrap

COMMAND, ROOT = sys.argv[1:3]
EPSILON_0 = 8.8541878128e-12
AIR = 1.204  # kg/m^3

# Name, low, nominal, high, unit, and where it comes from: given in the source, catalogue of this project, or assumed.
SILICONE = [
    ("scale of the law", 0.93, 1, 1.07, "", "catalogue: its two sets differ by 7 % in stress"),
    ("permittivity", 2.48, 2.8, 2.8, "", "catalogue"),
]
TAPE = [
    ("mu of the slow law", 13.4, 15.36, 16.8, "kPa", "catalogue: three fits"),
    ("permittivity", 4.0, 4.8, 4.8, "", "catalogue; 4.0: assumed, it falls with stretch by an unknown amount"),
]


KEPT = {}


def run(folder, design, study, settings):
    """Rows of the study's table of a design under settings."""
    asked = (design, study, tuple(settings.items()))
    if asked not in KEPT:
        KEPT[asked] = compute(folder, design, study, settings)
    return KEPT[asked]


def compute(folder, design, study, settings):
    words = [COMMAND, "run", os.path.join(ROOT, "verify/devices", design + ".yaml"), "--force", "--quiet",
             "--no-figures", "--study", study, "--output", os.path.join(folder, "run")]
    for key, value in settings.items():
        words += ["--set", f"{key}={value}"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4):
        sys.exit(f"verify/devices/{design}.yaml {settings}: {done.stderr}")
    model = "axisymmetric" if study == "sweep" else "3d"
    with open(os.path.join(folder, "run", f"{model}_{study}.csv"), encoding="utf-8") as file:
        return list(csv.DictReader(file))


def expanding_circle(folder, field, x):
    """Radial strain (%) of the electrode at fields over the thickness at 0 V (V/um), and whether the film is slack."""
    kilovolts = [e * 20 / x["pre-stretch"] ** 2 / 1000 for e in field]
    rows = run(folder, "expanding-circle", "sweep", {
        "pre_stretch": x["pre-stretch"],
        "frame.inner_diameter": f"{x['frame, inner diameter']} mm",
        "materials.silicone.laws[0].parameters.c1": f"{178.4 * x['scale of the law']} kPa",
        "materials.silicone.laws[0].parameters.c2": f"{-6 * x['scale of the law']} kPa",
        "materials.silicone.laws[0].parameters.c3": f"{4.2 * x['scale of the law']} kPa",
        "materials.silicone.permittivity[0].at_rest": x["permittivity"],
        "compute.voltage.values": "[%s]" % ", ".join(f"{v:.6f} kV" for v in kilovolts)})
    return [(100 * (float(r["electrode stretch"]) - 1), float(r["smallest tension (N/m)"]) < 0) for r in rows]


def air_per_area(sides):
    """Mass of air (kg/m^2) that moves with the first mode of the square film, by the article's estimate of a piston
    (0.946 of half the side) and of the air in the recess of the frame, as areal mass of the mode (over 1.3785)."""
    return sides * AIR * (0.946 * 0.0254 / 2 + 0.00686) / 1.3785


def square_film(folder, _, x):
    """First frequency at 0 V (Hz), and that at 5 kV over it."""
    areal = 1000 * x["thickness"] * 1e-6 / x["pre-stretch"] ** 2
    density = 1000 * (1 + air_per_area(x["faces with air that moves"]) / areal)
    rows = run(folder, "square-film", "modal", {
        "plies.film.pre_stretch": x["pre-stretch"],
        "plies.film.thickness": f"{x['thickness']} um",
        "materials.silicone.density.value": f"{density} kg/m^3",
        "materials.silicone.laws[0].parameters.c1": f"{180.7 * x['scale of the law']} kPa",
        "materials.silicone.laws[0].parameters.c2": f"{-16.7 * x['scale of the law']} kPa",
        "materials.silicone.laws[0].parameters.c3": f"{6.6 * x['scale of the law']} kPa"})
    off, on = (float(r["frequency (Hz)"]) for r in rows)
    return {"frequency": (off, False), "ratio": (on / off, float(rows[1]["smallest tension (N/m)"]) <= 0)}


def frequency(folder, points, x):
    return [square_film(folder, points, x)["frequency"]]


def frequency_ratio(folder, points, x):
    return [square_film(folder, points, x)["ratio"]]


def article_ratio(stretch):
    """Frequency at 5 kV over that at 0 V by the article's formula, to which it gives the measurement within 2.3 %."""
    i = 2 * stretch**2 + stretch**-4 - 3
    stress = 2 * (stretch**2 - stretch**-4) * (180.7 - 2 * 16.7 * i + 3 * 6.6 * i * i) * 1e3
    return math.sqrt(1 - EPSILON_0 * (2.76 - 0.28 * stretch) * (stretch**2 * 5e3 / 100e-6) ** 2 / stress)


def acrylic_disc(folder, points, x):
    """Area over that at 0 V at voltages (kV), then where the film goes slack (kV) and its area ratio there."""
    rows = run(folder, "acrylic-disc", "sweep", {
        "pre_stretch": x["pre-stretch"],
        "frame.inner_diameter": f"{x['frame, inner diameter']} mm",
        "materials.tape.laws[0].parameters.mu": f"{x['mu of the slow law']} kPa",
        "materials.tape.permittivity[0].at_rest": x["permittivity"]})
    curve = [(float(r["V (kV)"]), float(r["electrode stretch"]) ** 2, float(r["smallest tension (N/m)"])) for r in rows]
    at = {round(v, 3): (area, tension < 0) for v, area, tension in curve}
    slack = area_slack = math.nan
    for (v0, a0, t0), (v1, a1, t1) in zip(curve, curve[1:]):
        if t0 > 0 >= t1:
            s = t0 / (t0 - t1)
            slack, area_slack = v0 + s * (v1 - v0), a0 + s * (a1 - a0)
            break
    special = {"slack": (slack, False), "area at slack": (area_slack, False)}
    return [special[p] if p in special else at.get(p, (math.nan, True)) for p in points]


def pulled_strip(folder, length, stretch, steps):
    """Capacitances (pF) of the strip at even steps from rest to a stretch."""
    rows = run(folder, "stretch-sensor", "loading", {
        "shapes.film.width": f"{length + 2} mm",
        "shapes.free.width": f"{length} mm",
        "shapes.left.x": f"{-(length + 1) / 2} mm",
        "shapes.right.x": f"{(length + 1) / 2} mm",
        "compute.loading.to": f"{(stretch - 1) * length} mm",
        "compute.loading.steps": steps})
    return [float(r["capacitance (pF)"]) for r in rows]


def stretch_sensor(folder, stretches, x):
    """Capacitance at rest (pF), then that at stretches over it; without a length the strip's width is free, and its
    capacitance goes with the stretch. The rows are a tenth of the stretch apart."""
    length = x["length"]
    rest = 4.8 * EPSILON_0 * 0.2 / 0.5e-3 * 1e9 * x["permittivity"] / 4.8 * 0.5 / x["thickness"]
    if math.isinf(length):
        return [(rest, False)] + [(s, False) for s in stretches[1:]]
    c = pulled_strip(folder, length, 6.1, 51)
    ratios = []
    for s in stretches[1:]:
        i = int((s - 1) * 10)
        ratios.append(((c[i] + (c[i + 1] - c[i]) * ((s - 1) * 10 - i)) / c[0], False))
    return [(rest, False)] + ratios


def cycled_sensor(folder, stretches, x):
    """What stretches add to the capacitance (%)."""
    def more(stretch):
        if math.isinf(x["length"]):
            return stretch - 1
        c = pulled_strip(folder, x["length"], stretch, 1)
        return c[-1] / c[0] - 1
    return [(100 * more(s), False) for s in stretches]


RATIO_115, RATIO_138 = article_ratio(1.15), article_ratio(1.38)
DEVICES = [
    {
        "name": "Expanding circle, Elastosil 2030",
        "design": "expanding-circle",
        "source": "F. B. Albuquerque, H. Shea, Smart Mater. Struct. 30 (2021) 125022, abstract at infoscience.epfl.ch/record/291257: "
                  "silicone film, pre-stretched, compliant electrodes of 5 mm, strain at two fields",
        "missing": "pre-stretch; frame; stiffness of the electrodes (here none); which strain and over which thickness the field is "
                   "meant (here the radial strain, and the thickness at 0 V)",
        "predict": expanding_circle, "points": [80, 100],
        "inputs": [("pre-stretch", 1.05, 1.2, 1.5, "", "assumed: not in the abstract"),
                   ("frame, inner diameter", 20, 40, 60, "mm", "assumed")] + SILICONE,
        "values": [("radial strain at 80 V/um", "%", 2.1, None), ("radial strain at 100 V/um", "%", 4.6, None)],
    },
    {
        "name": "Square film, marked stretch 1.1",
        "design": "square-film",
        "source": "C. Solano, Y. Zhang, L. N. Cattafesta III, An electroacoustic lumped element model of a dielectric elastomer "
                  "membrane; Elastosil 2030, 100 um, side 25.4 mm, no electrodes, laser vibrometer",
        "missing": "how much air moves with the film; the stretch is known to 0.15 (below 1.0 there is no tension: 1.005 stands for it)",
        "predict": frequency, "points": [0],
        "inputs": [("pre-stretch", 1.005, 1.1, 1.25, "", "given: read from lines drawn on the film, +- 0.15 at most"),
                   ("thickness", 95, 100, 105, "um", "given; +- 5 % assumed"),
                   ("faces with air that moves", 1, 2, 2, "", "assumed; the article's estimate of a face"), SILICONE[0]],
        "values": [("first frequency", "Hz", 390, 0.5)],
    },
    {
        "name": "Square film, marked stretch 1.3",
        "design": "square-film",
        "source": "the same article, the second film",
        "missing": "how much air moves with the film",
        "predict": frequency, "points": [0],
        "inputs": [("pre-stretch", 1.15, 1.3, 1.45, "", "given: read from lines drawn on the film, +- 0.15 at most"),
                   ("thickness", 95, 100, 105, "um", "given; +- 5 % assumed"),
                   ("faces with air that moves", 1, 2, 2, "", "assumed; the article's estimate of a face"), SILICONE[0]],
        "values": [("first frequency", "Hz", 530, 0.5)],
    },
    {
        "name": "Square film under 5 kV, stretch 1.15",
        "design": "square-film",
        "source": "the same article, films with carbon grease; the measured curve is a figure, the text says that it is within 2.3 % of "
                  f"the article's formula at 5 kV, which is {RATIO_115:.3f}",
        "missing": "the measured value itself; the stretch was found by the authors from the deflection under sound and the frequency "
                   "at 0 V, not from a voltage",
        "predict": frequency_ratio, "points": [5],
        "inputs": [("pre-stretch", 1.13, 1.15, 1.17, "", "given: from frequency, both, deflection"),
                   ("thickness", 95, 100, 105, "um", "given; +- 5 % assumed"),
                   ("faces with air that moves", 2, 2, 2, "", "no effect on the ratio"), SILICONE[0]],
        "values": [("frequency at 5 kV over that at 0 V", "", RATIO_115, 0.023 * RATIO_115)],
    },
    {
        "name": "Square film under 5 kV, stretch 1.38",
        "design": "square-film",
        "source": f"the same article, the second film; its formula at 5 kV is {RATIO_138:.3f}",
        "missing": "as before; the two estimates of the stretch are far apart",
        "predict": frequency_ratio, "points": [5],
        "inputs": [("pre-stretch", 1.29, 1.38, 1.46, "", "given: from frequency, both, deflection"),
                   ("thickness", 95, 100, 105, "um", "given; +- 5 % assumed"),
                   ("faces with air that moves", 2, 2, 2, "", "no effect on the ratio"), SILICONE[0]],
        "values": [("frequency at 5 kV over that at 0 V", "", RATIO_138, 0.023 * RATIO_138)],
    },
    {
        "name": "Stretch sensor, acrylic tape and gel",
        "design": "stretch-sensor",
        "source": "uniaxial_capacitance_stretch_data.csv of github.com/ericstewart36/ionotronics (commit 8864d5f; E. M. Stewart, "
                  "S. Narayan, L. Anand, J. Mech. Phys. Solids 2023), the measured capacitance of a strip between hydrogels",
        "missing": "size and thickness of the specimen (here those of that simulation, 20 x 10 x 0.5 mm; at rest without grips); "
                   "which tape (here VHB); how permittivity changes with stretch (here not at all); capacitance of the leads",
        "predict": stretch_sensor, "points": [1, 2.0348, 3.1204, 4.0912, 4.9761, 6.0374],
        "inputs": [("length", 10, 20, math.inf, "mm", "assumed; inf: a long strip of free width. No effect on the capacitance at rest"),
                   ("thickness", 0.45, 0.5, 0.55, "mm", "assumed"), TAPE[1]],
        "values": [("capacitance at rest", "pF", 23.694, None), ("capacitance ratio at stretch 2.035", "", 46.879 / 23.694, None),
                   ("capacitance ratio at 3.120", "", 70.955 / 23.694, None), ("capacitance ratio at 4.091", "", 93.376 / 23.694, None),
                   ("capacitance ratio at 4.976", "", 113.376 / 23.694, None), ("capacitance ratio at 6.037", "", 132.357 / 23.694, None)],
    },
    {
        "name": "Stretch sensor, cycled by 2 %",
        "design": "stretch-sensor",
        "source": "uniaxial_cap_cycle_data.csv of the same repository, ten cycles of 1 s on another specimen (28.8 pF at rest); measured: slope "
                  "of the capacitance over the triangle of the stretch, least squares",
        "missing": "as before",
        "predict": cycled_sensor, "points": [1.02],
        "inputs": [("length", 10, 20, math.inf, "mm", "assumed; inf: a long strip of free width")],
        "values": [("gain of capacitance by 2 % of stretch", "%", 1.70, 0.05)],
    },
    {
        "name": "Acrylic disc, nanotube electrodes",
        "design": "acrylic-disc",
        "source": "laboratory notes in github.com/Anatol-Gogoj/Digital_Multitool (commit 78315cc, PROJECT_HANDOFF.md and SLDEA_HANDOFF.md): "
                  "VHB 4910 between rigid rings, electrodes of 16 mm, steps of 0.25 kV about a minute apart, area by camera; mean of "
                  "five devices at 5.25 kV, collapse of the area by wrinkles between 5.25 and 5.5 kV, peak before it in three of them",
        "missing": "pre-stretch; diameter of the rings (between height and width of the picture, by its scale); electrode's stiffness",
        "predict": acrylic_disc, "points": [5.25, "slack", "area at slack"],
        "inputs": [("pre-stretch", 2.5, 3, 4, "", "assumed: not in the notes"),
                   ("frame, inner diameter", 30, 40, 53, "mm", "assumed from the picture's scale")] + TAPE,
        "values": [("area ratio at 5.25 kV", "", 2.041, 0.15), ("voltage of wrinkles", "kV", 5.375, 0.125),
                   ("area ratio when wrinkles come", "", 2.30, 0.04)],
    },
    {
        "name": "Acrylic disc, carbon black",
        "design": "acrylic-disc",
        "source": "the same notes, table of the first device with carbon black electrodes, 0 to 5 kV",
        "missing": "as before",
        "predict": acrylic_disc, "points": [1, 2, 3, 4, 5],
        "inputs": [("pre-stretch", 2.5, 3, 4, "", "assumed: not in the notes"),
                   ("frame, inner diameter", 30, 40, 53, "mm", "assumed from the picture's scale")] + TAPE,
        "values": [("area ratio at 1 kV", "", 1.010, 0.015), ("area ratio at 2 kV", "", 1.045, 0.016), ("area ratio at 3 kV", "", 1.108, 0.017),
                   ("area ratio at 4 kV", "", 1.142, 0.017), ("area ratio at 5 kV", "", 1.156, 0.017)],
    },
]


def number_at(text, start):
    """The table row of a page that starts so, as its cells."""
    row = next(r for r in text.splitlines() if r.startswith(start))
    return [c.strip() for c in row.strip("|").split("|")]


def elsewhere():
    """Rows of devices whose designs other pages run: (device, quantity, measured, low, high, page)."""
    with open(os.path.join(ROOT, "docs/validation/paper.md"), encoding="utf-8") as file:
        paper = file.read()
    bounds = sorted(abs(float(x)) / 1000 for x in number_at(paper, "| **band** |")[-1].split(" ... "))
    yield "The paper's actuator, four fibres", "largest displacement at 8 kV (mm)", 0.5, *bounds, "paper"
    for name, cell in (("four", 4), ("eight", 8)):
        change = max(-float(number_at(paper, f"| {d} mm |")[cell]) for d in ("0.5", "1.0", "1.5", "2.0"))
        yield f"The paper's actuator, {name} fibres", "size of the force's change by 6 kV, any depth (mN)", 180, 0, change, "paper"
    with open(os.path.join(ROOT, "docs/validation/vhb-under-voltage.csv"), encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["measured drop (kPa)"] and row["stretch"] in ("1.25", "1.5", "2", "2.5", "2.95"):
                low, high = (float(row[k]) for k in ("low (kPa)", "high (kPa)"))
                yield "Strip of VHB 4905 under 6 kV", f"fall of the stress at {row['stretch']} (kPa)", float(row["measured drop (kPa)"]), low, high, "vhb-under-voltage"


def predict(device, folder):
    """[(nominal, low, high, share of corners that are slack)] of the device's values."""
    names = [i[0] for i in device["inputs"]]
    nominal = device["predict"](folder, device["points"], {i[0]: i[2] for i in device["inputs"]})
    ends = [sorted({i[1], i[3]}) for i in device["inputs"]]
    corners = [device["predict"](folder, device["points"], dict(zip(names, c))) for c in itertools.product(*ends)]
    found = []
    for k, (value, slack) in enumerate(nominal):
        all_values = [value] + [c[k][0] for c in corners]
        known = [v for v in all_values if not math.isnan(v)]
        doubted = [slack] + [c[k][1] for c in corners]
        found.append({"nominal": value, "low": min(known), "high": max(known), "slack": sum(doubted), "runs": len(doubted),
                      "none": len(all_values) - len(known)})
    return found


def rows():
    with tempfile.TemporaryDirectory() as folder:
        for device in DEVICES:
            for (label, unit, measured, error), p in zip(device["values"], predict(device, folder)):
                p |= {"device": device["name"], "label": label, "unit": unit, "measured": measured, "error": error}
                p["inside"] = p["low"] <= measured <= p["high"]
                p["telling"] = p["low"] > 0 and p["high"] < 2 * p["low"]
                yield p


def figure(found):
    """Bars of the bands over the measured values, as SVG; each label says the measured value."""
    path = os.path.join(ROOT, "docs/figures/devices.svg")
    bars, titles, y = [], [], -0.2
    for device in DEVICES:
        y -= 1.4
        titles.append((device["name"], y))
        for p in (p for p in found if p["device"] == device["name"]):
            y -= 1
            low, high, mid = (min(max(p[k] / p["measured"], 0.2), 10) for k in ("low", "high", "nominal"))
            error = (p["error"] or 0) / p["measured"]
            bars.append((p["inside"], f"1 {y} {low} {high} {y - 0.3} {y + 0.3} {mid} {1 - error} {1 + error}", error,
                         f"{p['label']}: {p['measured']:.4g}" + (f" {p['unit']}" if p["unit"] else ""), y))
    block = lambda bars: "\n".join(b[1] for b in bars) + "\ne\n"
    labels = "".join(f"set label '{text}' at graph -0.015, first {at} right\n" for *_, text, at in bars)
    labels += "".join(f"set label '{{/:Bold {text}}}' at graph -0.015, first {at} right\n" for text, at in titles)
    script = f"""set terminal svg size 860,{int(130 + 16 * -y)} font 'Helvetica,12' background rgb 'white'
set output '{path}'
set lmargin 40; set tmargin 4.5; set bmargin 4; set rmargin 3
set logscale x; set xrange [0.2:10]; set yrange [{y - 0.8}:-0.8]
set xtics (0.2, 0.5, 1, 2, 5, 10) nomirror; set xlabel 'computed over measured'
unset ytics; set border 1; set key at screen 0.98, screen 0.985 right top horizontal maxrows 2 samplen 1.5 width 1
set arrow from 1, graph 0 to 1, graph 1 nohead lw 1.5 lc rgb '#444444' back
set grid xtics lc rgb '#dddddd'; set style fill solid noborder
{labels}
plot '-' using 1:2:3:4:5:6 with boxxyerror lc rgb '#56b4e9' title 'band, measured value in it', \\
     '-' using 1:2:3:4:5:6 with boxxyerror lc rgb '#e69f00' title 'band, outside', \\
     '-' using 7:2 with points pt 7 ps 0.5 lc rgb 'black' title 'nominal', \\
     '-' using 1:2:8:9 with xerrorbars pt 0 lw 2 lc rgb '#cc0000' title 'measured, with uncertainty'
{block(b for b in bars if b[0])}{block(b for b in bars if not b[0])}{block(bars)}{block(b for b in bars if b[2])}"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def number(value):
    return "none" if math.isnan(value) else f"{value:.4g}" if abs(value) < 1000 else f"{value:.0f}"


def line(words):
    print("| " + " | ".join(str(w) for w in words) + " |")


def write_csv(found, others):
    with open(os.path.join(ROOT, "docs/validation/devices.csv"), "w", encoding="utf-8", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["device", "quantity", "unit", "measured", "measured uncertainty", "nominal", "low", "high", "in the band",
                      "band within a factor of two", "slack or without a state (runs)", "runs"])
        for p in found:
            out.writerow([p["device"], p["label"], p["unit"], f"{p['measured']:.6g}", "" if p["error"] is None else f"{p['error']:.3g}",
                          f"{p['nominal']:.6g}", f"{p['low']:.6g}", f"{p['high']:.6g}", "yes" if p["inside"] else "no",
                          "yes" if p["telling"] else "no", p["slack"] + p["none"], p["runs"]])
        for device, quantity, measured, low, high, _ in others:
            label, unit = quantity.rstrip(")").rsplit(" (", 1)
            out.writerow([device, label, unit, f"{measured:.6g}", "", "", f"{low:.6g}", f"{high:.6g}", "yes" if low <= measured <= high else "no",
                          "yes" if 0 < high < 2 * low else "no", "", ""])


def main():
    found, others = list(rows()), list(elsewhere())
    write_csv(found, others)
    figure(found)
    telling = [p for p in found if p["telling"]]
    print("# Devices that others measured\n")
    print(f"""Made by `scripts/verify devices`; not to be edited. Each test has a design of `verify/devices`, run at the nominal values of
its inputs and at all corners of their ranges; the band goes from the least to the largest of these values (what lies
higher or lower between corners was not searched). Nothing is fitted to the measured values; one range (the
strip's length) was changed after a first run, and no value moved into its band by that.

**In the band: {sum(p['inside'] for p in found)} of {len(found)} values, of {len(DEVICES)} tests from four sources. Of the bands within a factor of two: {sum(p['inside'] for p in telling)} of {len(telling)}.
With the three devices of other pages: {sum(p['inside'] for p in found) + sum(low <= m <= high for _, _, m, low, high, _ in others)} of {len(found) + len(others)} values, of {len(DEVICES) + len({o[0] for o in others})} devices.**
Two of the measured values, the frequency ratios, are known as intervals only.
[devices.csv](devices.csv) has all numbers.

![Computed over measured, with bands](../figures/devices.svg)
""")
    line(["device", "quantity", "measured", "nominal", "band", "high over low", "in the band"])
    line(["---"] * 7)
    for p in found:
        star = "\\*" if p["slack"] else ""
        star += "\\*\\*" if p["none"] else ""
        error = "" if p["error"] is None else f" +- {p['error']:.2g}"
        ratio = p["high"] / p["low"] if p["low"] > 0 else math.inf
        line([p["device"], p["label"] + (f" ({p['unit']})" if p["unit"] else ""), number(p["measured"]) + error, number(p["nominal"]),
              f"{number(p['low'])} to {number(p['high'])}{star}", f"{ratio:.2f}" if ratio < 100 else "over 100", "yes" if p["inside"] else "**no**"])
    if any(p["slack"] for p in found):
        print("\n\\* In some of the runs the film has lost its tension there; a real one wrinkles, and the number is no longer its own.")
    if any(p["none"] for p in found):
        print("\n\\*\\* Some of the runs have no such state.")
    print()
    before = []
    for device in DEVICES:
        print(f"## {device['name']}\n\n[verify/devices/{device['design']}.yaml](../../verify/devices/{device['design']}.yaml).")
        for text in (f"Source: {device['source']}.", f"Missing or assumed: {device['missing']}."):
            print(textwrap.fill(text, 118, break_long_words=False, break_on_hyphens=False))
        print()
        inputs = [i for i in device["inputs"] if (device["design"], i) not in before]
        if inputs:
            line(["input", "low", "nominal", "high", "from"])
            line(["---"] * 5)
        for name, low, mid, high, unit, origin in inputs:
            line([name + (f" ({unit})" if unit else ""), low, mid, high, origin])
        if len(inputs) < len(device["inputs"]):
            print(("\nOther inputs" if inputs else "Inputs") + " as before.")
        before = [(device["design"], i) for i in device["inputs"]]
        print()
    print("## Devices of other pages\n")
    line(["device", "quantity", "measured", "band", "in the band", "page"])
    line(["---"] * 6)
    for device, quantity, measured, low, high, page in others:
        line([device, quantity, number(measured), f"{number(low)} to {number(high)}", "yes" if low <= measured <= high else "**no**", f"[{page}.md]({page}.md)"])
    print()
    print(READING, end="")


READING = """## What these say

* **The field's stress on a taut film** agrees where a film is compared with itself, the frequency of a square film under 5 kV over that at
  0 V: ours is 1 % above the article's formula (it has the stress of a permittivity that falls with stretch), the
  measurement is within 2.3 % of that formula.
* **The expanding circle is out**, by a factor of two at the largest pre-stretch of the range and of five at the nominal one; the ratio of the two values,
  2.2, is that of the nominal film (2.1). Electrodes as stiff in the plane as the film of 20 um could do that, or a field over another thickness.
* **The strips' capacitance grows less than their stretch**, by 3 to 7 % of the ratio, and in cycles by 1.7 % where the strip is stretched by 2 %. A film of
  constant permittivity cannot do that; a capacitance of the leads could (4 of 28.8 pF in the cycles). The value at rest would need a permittivity of 6.7 at the size assumed.
* **Acrylic discs wrinkle within the band**, at 5.4 kV and 2.3 times the area (nominal 4.6 kV and 2.9), with an assumed pre-stretch. With carbon black the disc
  agrees up to 3 kV and grows ever more slowly above: stiffness, resistance, or another film.

Not counted, since what could be read of them (mostly abstracts) lacks a number that decides, such as pre-stretch, field, pressure or law: films and
discs of Pelrine and others (2000), Wissler and Mazza (2005), Bozlar and others (2012), Akbari and others (2013), Feng and others (2024); cones of
Bernat and others (2022), Cao and Conn (2018); membranes of Tews and others (2003), Dubois and others (2009), Shian and others (2013), Garnell and others
(2019); stacks of Shintake and others (2021); the pressure sensor of ericstewart36/ionotronics (hold of its faces, rate); the contractile actuator of
sherwood01v/mesh-reinforcement-dea-project (its recording is named there and could not be read).
"""
main()
