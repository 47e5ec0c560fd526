#!/usr/bin/env python3
"""Random designs, each swept by one model, and what came of them, as a table of verdicts.

    random_designs.py DEA [--count 200] [--first 0] [--model 3d] [--coarse] [--seconds 60]
                      [--jobs 1] [--keep DIR] [--out rows.jsonl] [--compare rows.jsonl]
                      [--beside axisymmetric] [--share 0.01] [--plies] [--steps 1,0.5,0.25]

A design follows from its number alone, so that two versions of the program are asked the same.
What may vary: catalogue and own laws, 0 to 24 fibres, pre-stretch 1 to 4, 10 um to 1 mm, glue,
stiff electrodes, weight, membrane and solid film, thin and coupled field, up to twice breakdown.

--keep    folder for the design files of what ended as "ours", one line for the reason
--out     one line of JSON a design
--beside  designs without fibres are swept by that model too, and where its verdict, pull-in, loss of
          tension or last stretch is another one, it is listed
--plies   devices of plies instead: cones, plates, benders, stacks, strips and diaphragms, with springs,
          masses, forces, pressures, stiff electrodes and one to three channels
--steps   sweeps each design once a step, in kV, and prints the voltages of its verdicts in a table; fails
          where those of a design are apart by more than --apart. Only designs that go to 2 to 20 kV
--compare the lines of another version: designs whose verdict is another one are listed
--share   fails (exit 1) where more than this share of the designs that ran ends as "ours"

Sizes: 20 as a test, 200 and 2000 by hand (docs/theory/stops.md).
"""
import argparse
import concurrent.futures
import json
import math
import os
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile


# Laws of silicones, acrylics and stiff rubbers: (name, parameters in kPa or 1, shear modulus in Pa)
def own_law(r):
    mu = 10 ** r.uniform(3.9, 6.3)  # 8 kPa to 2 MPa
    kPa = lambda x: "%.6g kPa" % (1e-3 * x)
    kind = r.choice(["neo-hookean", "gent", "mooney-rivlin", "yeoh", "ogden", "arruda-boyce"])
    if kind == "neo-hookean":
        return kind, {"mu": kPa(mu)}, mu
    if kind == "gent":
        return kind, {"mu": kPa(mu), "jm": "%.4g" % 10 ** r.uniform(0.7, 2.3)}, mu
    if kind == "mooney-rivlin":
        share = r.uniform(0, 0.2)
        return kind, {"c10": kPa(mu * (1 - share) / 2), "c01": kPa(mu * share / 2)}, mu
    if kind == "yeoh":
        return kind, {"c1": kPa(mu / 2), "c2": kPa(-mu / 2 * r.uniform(0, 0.05)),
                      "c3": kPa(mu / 2 * 10 ** r.uniform(-4, -1.5))}, mu
    if kind == "ogden":
        alpha = r.uniform(1.5, 4)
        return kind, {"mu1": kPa(2 * mu / alpha), "alpha1": "%.4g" % alpha}, mu
    return kind, {"mu": kPa(mu), "lambda_m": "%.4g" % r.uniform(1.8, 8)}, mu


def film_of(r):
    """(lines of film and materials, breakdown field of the unstretched film, its exponent)"""
    name = r.choice(["elastosil-2030", "elastosil-2030", "vhb-4910", "own", "own"])
    if name == "elastosil-2030":
        law = r.choice(["yeoh-178", "yeoh-181"])
        slope = "stretch-dependent" if r.random() < 0.15 else "constant"
        return ["  material: elastosil-2030", "  law: " + law, "  permittivity: " + slope], [], 80e6, 0
    if name == "vhb-4910":
        return ["  material: vhb-4910"], [], 30.6e6, 1.13
    law, parameters, _ = own_law(r)
    field, exponent = r.uniform(20e6, 150e6), r.choice([0, 0, 0.5, 1.13])
    own = ["  - name: own", "    kind: elastomer",
           "    density: {value: 1000 kg/m^3, source: random}", "    laws:",
           "      - {id: random, law: %s, parameters: {%s}, source: random}" %
           (law, ", ".join("%s: %s" % p for p in parameters.items())),
           "    permittivity:", "      - {id: random, at_rest: %.3g, source: random}" % r.uniform(2.5, 8),
           "    breakdown:", "      - {id: random, at_rest: %.4g V/um, exponent: %g, source: random}" %
           (1e-6 * field, exponent)]
    return ["  material: own"], own, field, exponent


def fibres_of(r, electrode_mm, frame_mm):
    if r.random() < 0.3:
        return []
    count = r.choice([1, 2, 3, 4, 4, 4, 6, 8, 8, 12, 16, 24])
    most = 0.8 * 6.28 * electrode_mm / count  # at the tips
    lines = ["fibres:", "  count: %d" % count, "  width: %.4g mm" % min(r.uniform(0.2, 2), most),
             "  thickness: %.4g um" % 10 ** r.uniform(1.3, 2.5), "  material: pet",
             "  outer_end: " + r.choice(["clamped", "clamped", "hinged", "free"]),
             "  overlap: %.4g mm stretched" % (r.choice([0, 0, 0.2]) * electrode_mm)]
    if r.random() < 0.3:
        lines += ["  bond: {thickness: %.3g um, modulus: %.3g MPa}" %
                  (r.uniform(5, 60), 10 ** r.uniform(-1, 1))]
    return lines


def design_of(number, coarse):
    """Text of the design file of a number."""
    r = random.Random("libdea %d" % number)
    film, materials, field, exponent = film_of(r)
    pre = r.choice([1, 1, 1.05, 1.2, 1.5, 2, r.uniform(1, 4), r.uniform(1, 4)])
    thickness = 10 ** r.uniform(-5, -3)
    frame = r.uniform(5, 40)
    electrode = frame * r.uniform(0.1, 0.6)
    solid_film = r.random() < 0.75
    # E_b l^n (the true field) = V l^2/H0
    highest = field * pre ** (exponent - 2) * thickness * r.uniform(0.3, 2)
    steps = 6
    lines = ["dea: 1", "title: Random design %d" % number, "materials:"] + materials
    lines += ["  - name: stiff", "    kind: electrode",
              "    density: {value: 1200 kg/m^3, source: random}", "    laws:",
              "      - {id: random, law: neo-hookean, parameters: {mu: %.4g kPa}, source: random}" %
              10 ** r.uniform(1, 3.5), "film:"] + film
    lines += ["  thickness: %.4g um" % (1e6 * thickness), "pre_stretch: %.4g" % pre,
              "frame: {inner_radius: %.4g mm}" % frame, "electrodes:",
              "  radius: %.4g mm stretched" % electrode]
    if r.random() < 0.35:
        lines += ["  material: stiff", "  thickness: %.3g um" % 10 ** r.uniform(0, 1.8)]
    lines += fibres_of(r, electrode, frame)
    if r.random() < 0.2:
        lines += ["gravity: " + r.choice(["fibres_up", "fibres_down"])]
    coupled = solid_film and r.random() < 0.1
    lines += ["compute:", "  models: [3d]",
              "  voltage: {from: %.5g kV, to: %.12g kV, step: %.12g kV}" %
              (0, 1e-3 * highest, 1e-3 * highest / steps),
              "  solid: {film: %s, field: %s%s}" % ("solid" if solid_film else "membrane",
                                                    "coupled" if coupled else "thin",
                                                    ", order: 1, order_z: 1" if coarse else "")]
    return "\n".join(lines) + "\n"


def film_ply(r):
    """(material, thickness in um, pre-stretch, voltage in kV up to which it may go)"""
    name, field, exponent = r.choice([("elastosil-2030", 80, 0), ("elastosil-2030", 80, 0),
                                      ("vhb-4910", 30.6, 1.13)])
    pre = r.choice([1, 1.05, 1.1, 1.2, 1.3, 1.5, r.uniform(1, 2.5)])
    thickness = 10 ** r.uniform(1.5, 2.7)
    return name, thickness, pre, 1e-3 * field * pre ** (exponent - 2) * thickness * r.uniform(.3, 1.2)


def ply(name, shape, material, thickness, pre=1):
    return "  - {name: %s, shape: %s, material: %s, thickness: %.4g um, pre_stretch: %.4g}" % (
        name, shape, material, thickness, pre)


def electrodes_of(film, shapes):
    lines = ["electrodes:", "  - {ply: %s, side: bottom, shape: back, channel: ground}" % film]
    return lines + ["  - {ply: %s, side: top, shape: %s, channel: %s}" % (film, s, s) for s in shapes]


def channels_of(r, names):
    return ["channels:"] + ["  - {name: %s, ratio: %.3g}" % (n, 1 if i == 0 else r.choice(
        [0, 0.5, 1, r.uniform(0, 1)])) for i, n in enumerate(names)]


def cone_or_plate(r):
    """A film in a ring with a rigid hub that a mass, a force, a spring or a bistable one moves."""
    name, thickness, pre, highest = film_ply(r)
    R = r.uniform(8, 30)
    hub = R * r.uniform(0.15, 0.45)
    sectors = r.choice([0, 0, 2, 3])
    lines = ["shapes:", "  - {name: film, kind: circle, radius: %.4g mm}" % R,
             "  - {name: hub, kind: circle, radius: %.4g mm}" % hub,
             "  - {name: back, kind: ring, inner_radius: %.4g mm, outer_radius: %.4g mm}" %
             (hub * 1.05, R * 0.95)]
    names = ["s%d" % i for i in range(sectors)] or ["all"]
    for i, n in enumerate(names):
        if sectors:
            start = 360 * i / sectors
            lines += ["  - {name: %s, kind: sector, inner_radius: %.4g mm, outer_radius: %.4g mm, "
                      "start: %.4g degree, end: %.4g degree}" %
                      (n, hub * 1.05, R * 0.95, start + 6, start + 360 / sectors - 6)]
        else:
            lines += ["  - {name: all, kind: copy, of: back}"]
    lines += ["plies:", ply("film", "film", name, thickness, pre)]
    lines += electrodes_of("film", names) + channels_of(r, names) + ["supports:", "  - {edge: film}"]
    kind = r.choice(["mass", "force", "spring", "bistable", "free"])
    free = "[z]" if not sectors or kind in ("spring", "bistable") else "[x, y, z]"
    hold = {"mass": ", mass: %.3g g" % 10 ** r.uniform(0, 1.5),
            "force": ", force_z: %.3g mN" % 10 ** r.uniform(0.5, 2.3)}.get(kind, "")
    lines += ["bodies:", "  - {name: hub, shape: hub%s%s}" % (hold, ", free: " + free)]
    if kind == "mass":
        lines += ["gravity: " + r.choice(["top_up", "top_down"])]
    if kind == "spring":
        lines += ["springs:", "  - {body: hub, direction: z, stiffness: %.3g N/m, free_at: %.3g mm}" %
                  (10 ** r.uniform(0.5, 2.5), R * r.uniform(-0.2, 0.3))]
    if kind == "bistable":
        s, F = R / 20, 10 ** r.uniform(1, 2.5)
        lines += ["springs:", "  - {body: hub, direction: z, table: [" + ", ".join(
            "[%.4g mm, %.4g mN]" % (s * x, F * y) for x, y in
            [(0, 0), (1, 1), (2, 0.5), (4, -1.5), (6, -2)]) + "]}"]
    return lines + ["monitors:", "  - {name: hub, body: hub}"], highest


def bender(r):
    name, thickness, _, highest = film_ply(r)
    long, wide = r.uniform(10, 40), r.uniform(3, 12)
    lines = ["shapes:", "  - {name: strip, kind: rectangle, x: %.4g mm, width: %.4g mm, height: %.4g mm}" %
             (long / 2, long, wide),
             "  - {name: back, kind: rectangle, x: %.4g mm, width: %.4g mm, height: %.4g mm}" %
             (long / 2 + 0.5, long - 3, 0.8 * wide), "  - {name: all, kind: copy, of: back}",
             "  - {name: root, kind: rectangle, width: 1 mm, height: %.4g mm}" % (1.2 * wide), "plies:",
             ply("passive", "strip", r.choice([name, name, "pet"]), thickness * r.uniform(0.2, 1)),
             ply("film", "strip", name, thickness)]
    return lines + electrodes_of("film", ["all"]) + ["supports:", "  - {edge: strip, within: root}",
                                                     "monitors:", "  - {name: tip, at: [%.4g mm, 0 mm], "
                                                     "ply: film}" % (0.998 * long)], highest * r.uniform(0.2, 1)


def stack(r):
    name, thickness, pre, highest = film_ply(r)
    count, R = r.choice([2, 2, 3, 4]), r.uniform(5, 20)
    thickness, highest = thickness / count, highest / count
    lines = ["shapes:", "  - {name: film, kind: circle, radius: %.4g mm}" % R,
             "  - {name: active, kind: circle, radius: %.4g mm}" % (R * r.uniform(0.2, 0.8)), "plies:"]
    lines += [ply("film %d" % (i + 1), "film", name, thickness, pre) for i in range(count)]
    lines += ["electrodes:", "  - {ply: film 1, side: bottom, shape: active, channel: ground}"]
    lines += ["  - {ply: film %d, side: top, shape: active, channel: %s}" %
              (i + 1, "drive" if i % 2 == 0 else "ground") for i in range(count)]
    return lines + ["supports:", "  - {edge: film}", "monitors:",
                    "  - {name: edge, at: [%.4g mm, 0 mm], ply: film 1}" % (R / 5)], highest


def diaphragm(r):
    """A film that a pressure bulges, round or rectangular."""
    name, thickness, pre, highest = film_ply(r)
    R = r.uniform(4, 20)
    outline = r.choice(["kind: circle, radius: %.4g mm" % R, "kind: rectangle, width: %.4g mm, "
                        "height: %.4g mm" % (2 * R, 2 * R * r.uniform(0.4, 1))])
    lines = ["shapes:", "  - {name: film, %s}" % outline,
             "  - {name: back, kind: circle, radius: %.4g mm}" % (R * r.uniform(0.15, 0.38)),
             "  - {name: all, kind: copy, of: back}", "plies:", ply("film", "film", name, thickness, pre)]
    mu = 40e3 if name.startswith("vhb") else 357e3  # Pa
    p = mu * thickness * 1e-6 / (R * 1e-3) * r.uniform(0.05, 1.2)
    return lines + electrodes_of("film", ["all"]) + [
        "supports:", "  - {edge: film}", "pressures:",
        "  - {ply: film, side: bottom, shape: film, pressure: %.4g kPa}" % (1e-3 * p), "monitors:",
        "  - {name: middle, at: [0 mm, 0 mm]}"], highest


def strip(r):
    """A strip that a bar pulls, with or without stiff cross bars."""
    name, thickness, pre, highest = film_ply(r)
    long, wide = r.uniform(15, 50), r.uniform(8, 30)
    stripes = r.random() < 0.5
    lines = ["shapes:", "  - {name: film, kind: rectangle, width: %.4g mm, height: %.4g mm}" % (long, wide),
             "  - {name: back, kind: rectangle, width: %.4g mm, height: %.4g mm}" %
             (long - 4, 0.85 * wide), "  - {name: all, kind: copy, of: back}",
             "  - {name: left, kind: rectangle, x: %.4g mm, width: 1 mm, height: %.4g mm}" %
             (-long / 2, wide * 1.1),
             "  - {name: bar, kind: rectangle, x: %.4g mm, width: 1 mm, height: %.4g mm}" %
             (long / 2 - 0.5, wide)]
    if stripes:
        lines += ["  - {name: stripe, kind: rectangle, x: %.4g mm, width: 1 mm, height: %.4g mm}" %
                  (-long / 4, wide),
                  "  - {name: stripes, kind: array, of: stripe, count_x: 3, pitch_x: %.4g mm}" % (long / 4)]
    lines += ["plies:", ply("film", "film", name, thickness, pre)]
    lines += [ply("stripes", "stripes", "pet", 200)] if stripes else []
    mu = 40e3 if name.startswith("vhb") else 357e3
    force = mu * thickness * 1e-6 / pre ** 2 * wide * 1e-3 * (pre ** 2 - pre ** -4) * r.uniform(0.6, 1.4)
    return lines + electrodes_of("film", ["all"]) + [
        "supports:", "  - {edge: film, within: left}", "bodies:",
        "  - {name: bar, shape: bar, free: [x], force_x: %.4g mN}" % (1e3 * max(force, 1e-3)), "monitors:",
        "  - {name: bar, body: bar}"], highest


def plies_of(number, coarse):
    """Text of the design file of a number, in the form of plies."""
    r = random.Random("libdea plies %d" % number)
    kind = r.choice([cone_or_plate, cone_or_plate, bender, stack, diaphragm, strip])
    lines, highest = kind(r)
    membrane = kind is not bender and r.random() < 0.35
    steps = 6
    return "\n".join(["dea: 1", "title: Random plies %d, %s" % (number, kind.__name__)] + lines + [
        "compute:", "  models: [3d]",
        "  voltage: {from: 0 kV, to: %.12g kV, step: %.12g kV}" % (highest, highest / steps),
        "  solid: {film: %s%s}" % ("membrane" if membrane else "solid",
                                            ", order: 1, order_z: 1" if coarse else "")]) + "\n"


OURS = "the solver did not converge; please report"


def verdict_of(summary, code, stderr):
    """Kind of verdict and the sentence."""
    if summary is None:
        refused = code in (2, 3) or (code == 5 and "memory" in stderr)
        return ("refused" if refused else "no answer, exit %d" % code), stderr.strip()[-300:]
    if summary.get("complete"):
        snapped = any("states" in point.get("flags", []) for point in summary["points"])
        return ("complete, in another state" if snapped else "complete"), ""
    why = summary.get("stopped", "")
    verdict = summary.get("verdict", "")
    if verdict:
        return (OURS if verdict == "not_converged" else verdict), why
    if summary.get("status") in ("DEA_E_DESIGN", "DEA_E_UNSUPPORTED", "DEA_E_ARGUMENT"):
        return "refused", why
    return OURS, why or stderr.strip()[-300:]


def run_one(dea, path, model, seconds):
    """Kind of verdict, the sentence, processor seconds, the summary (None: there is none)."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 2))
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        child = subprocess.Popen([dea, "run", path, "-m", model, "--study", "sweep", "--json"],
                                 stdout=out, stderr=err, preexec_fn=limit,
                                 env=dict(os.environ, OMP_NUM_THREADS="1"))
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        used = usage.ru_utime + usage.ru_stime
        out.seek(0)
        err.seek(0)
        stdout, stderr = out.read(), err.read().decode(errors="replace")
    killed = child.returncode == -signal.SIGKILL and used > 0.9 * seconds
    if killed or child.returncode == -signal.SIGXCPU:  # not all of the time may be counted
        return "out of time", "more than %d s of processor time" % seconds, used, None
    try:
        summary = json.loads(stdout)
    except ValueError:
        summary = None
    if summary is not None and "model" not in summary:
        summary = None
    return verdict_of(summary, child.returncode, stderr) + (used, summary)


def same_within(a, b, share):
    return a is not None and b is not None and abs(a - b) <= share * max(abs(a), abs(b))


def lost_between(summary):
    """Voltages between which a film loses its tension; None: it keeps it. A membrane that has lost
    it has none, and no less."""
    at = summary.get("limits", {}).get("slack_voltage_V")
    if at is not None:
        return at, at
    before = 0.0
    for point in summary["points"]:
        loaded = point["voltage_V"] > 0  # at rest it may be free of stress, to rounding
        if point.get("min_tension_N_per_m", 1) < (1e-6 if loaded else -1e-6):
            return before, point["voltage_V"]
        before = point["voltage_V"]
    return None


def last_taut(mine, other):
    """Stretches at the last voltage at which both films keep their tension, and neither has snapped:
    of waves the flat one knows nothing, and a snap-through is an event. None: there is none above 0 V."""
    both = [p for p in zip(mine, other) if p[0]["voltage_V"] > 0 and
            all(x.get("min_tension_N_per_m", 0) >= 0 and "states" not in x.get("flags", [])
                for x in p)]
    return [x["electrode_stretch"] for x in both[-1]] if both else None


def ends_there(summary, lost, within):
    """Whether a law ends where the other film loses its tension, which hides whether this one does."""
    at = re.match(r"the law ends at ([0-9.e+-]+) kV", summary.get("stopped", ""))
    return at is not None and overlap((1e3 * float(at[1]),) * 2, lost, within)


def overlap(a, b, within):
    return a[0] <= (1 + within) * b[1] and b[0] <= (1 + within) * a[1]


def differs(mine, other, within):
    """What two summaries of one disc do not agree on; "" where they do, None where nothing tells:
    the flat model's limits say nothing of a film that has lost its tension, nor do points whose
    smallest tension is that at the rim of a stiff electrode, where a solid film's is singular.
    Pull-in is an event, whether the film has ended there or has snapped past it."""
    both = (mine, other)
    taut = last_taut(mine["points"], other["points"])
    if taut and abs(taut[0] - taut[1]) > within * abs(taut[1] - 1) + 2e-3:
        return "stretch %.4g, %.4g" % tuple(taut)
    kinds = [m.get("verdict", "") or "complete" for m in both]
    lost = [lost_between(m) for m in both]
    ends = [m.get("limits", {}).get("pull_in_voltage_V") for m in both]
    if any(m.get("limits", {}).get("pull_in_of_slack_film") for m in both):
        return None
    if kinds == ["complete", "complete"] and not any(ends):
        return "" if taut else None
    if "slack" in kinds:  # lost tension is a verdict of one of them
        i = kinds.index("slack")
        j = 1 - i
        if lost[i] is None:  # it wrinkles as soon as it has no tension
            return None
        if ends[j]:  # the flat film goes on, a membrane thins at once
            return "" if lost[i][0] <= (1 + within) * ends[j] else "slack at %s, pull-in at %s V" % (
                lost[i], ends[j])
        if not lost[j] and ends_there(both[j], lost[i], within):
            return ""
        return "" if lost[j] and overlap(*lost, within) else "slack at %s, %s V" % tuple(lost)
    if any(ends):
        first = min(e for e in ends if e)
        if any(l and l[0] < (e or first) for l, e in zip(lost, ends)):
            return None
    if all(ends):
        return "" if same_within(*ends, within) else "pull-in at %s, %s V" % tuple(ends)
    reached = max((p["voltage_V"] for m in both for p in m["points"]), default=0)
    if any(ends) and "complete" in kinds and max(e or 0 for e in ends) * (1 + within) > reached:
        return "" if taut else None  # that of the other one may be just beyond the sweep
    return "" if kinds[0] == kinds[1] and not any(ends) else "%s, %s" % tuple(
        "%s, pull-in at %s V" % (k, e) if e and k != "pull_in" else k for k, e in zip(kinds, ends))


def ending_of(verdict, summary):
    """(kind, kV) of what ends or leaves the taut film's path first; None: no verdict."""
    if summary is None or verdict == OURS:
        return None
    limits = summary.get("limits", {})
    for kind in ("pull_in", "slack"):
        at = limits.get(kind + "_voltage_V")
        if at is not None and (kind == "pull_in" or verdict == "slack"):
            return kind, 1e-3 * at
    if verdict == "slack":
        return verdict, 0.0  # it has no tension from the start
    if verdict.startswith("complete"):
        return "complete", 1e-3 * summary["points"][-1]["voltage_V"]
    at = re.search(r" at ([0-9.e+-]+) kV", summary.get("stopped", ""))
    return (verdict, float(at[1])) if at else None


def in_steps(a, path, highest):
    """One line a step: verdict, (kind, kV) or None, processor seconds."""
    rows = []
    with open(path) as f:
        text = f.read()
    for step in a.steps:
        with open(path, "w") as f:
            f.write(re.sub(r"voltage: {from.*}", "voltage: {from: 0 kV, to: %.6g kV, step: %g kV}" %
                           (highest, step), text))
        verdict, _, seconds, summary = run_one(a.dea, path, a.model, a.seconds)
        rows.append((step, verdict, ending_of(verdict, summary), round(seconds, 2)))
    return rows


def apart(rows):
    """Largest difference of the voltages at which the film's path ends; inf: of another kind."""
    ends = [row[2] for row in rows]
    if None in ends or len({end[0] for end in ends}) > 1:
        return math.inf
    volts = [end[1] for end in ends]
    return max(volts) / min(volts) - 1 if min(volts) > 0 else 0


def steps_table(a, folder):
    """The designs that go to 2 to 20 kV, each in all of the steps; True: too far apart."""
    print("| design | goes to | " + " | ".join("%g kV" % step for step in a.steps) + " | apart |")
    print("|---|---|" + "---|" * len(a.steps) + "---|")
    number, done, off = a.first, 0, []
    while done < a.count:
        text = a.design(number, a.coarse)
        highest = float(re.search(r"to: ([0-9.e+-]+) kV", text)[1])
        path = os.path.join(folder, "%05d.yaml" % number)
        with open(path, "w") as f:
            f.write(text)
        number += 1
        highest = math.floor(highest / max(a.steps)) * max(a.steps)  # which all steps come to
        if not 2 <= highest <= 20:
            continue
        rows = in_steps(a, path, highest)
        if all(row[1] == "refused" for row in rows):
            continue
        done += 1
        far = apart(rows)
        off += [number - 1] if far > a.apart else []
        cells = ["%s, %.5g kV" % row[2] if row[2] else row[1] for row in rows]
        print("| %d | %.4g kV | %s | %s |" % (number - 1, highest, " | ".join(cells),
                                             "%.2f %%" % (100 * far) if far < 10 else "-"), flush=True)
        if a.out:
            with open(a.out, "a") as f:
                f.write(json.dumps({"design": number - 1, "steps": rows}) + "\n")
    print("\n%d designs, of which %d are farther apart than %g %%: %s" % (
        done, len(off), 100 * a.apart, ", ".join(map(str, off)) or "none"))
    return bool(off)


def run_design(a, folder, number):
    """The row of a design."""
    path = os.path.join(folder, "%05d.yaml" % number)
    text = a.design(number, a.coarse)
    with open(path, "w") as f:
        f.write(text)
    verdict, why, seconds, summary = run_one(a.dea, path, a.model, a.seconds)
    row = {"design": number, "verdict": verdict, "seconds": round(seconds, 2),
           "why": re.sub(r"\s+", " ", why)}
    if a.beside and summary is not None and "\nfibres:" not in text:
        other = run_one(a.dea, path, a.beside, a.seconds)[3]
        off = differs(summary, other, a.within) if other is not None else "no answer"
        if off is not None:
            row["beside"] = off
    if not a.keep or verdict in ("complete", "refused"):
        os.remove(path)
    return row


def median(values):
    values = sorted(values)
    n = len(values)
    return float("nan") if n == 0 else 0.5 * (values[(n - 1) // 2] + values[n // 2])


def table(rows):
    kinds = sorted({row["verdict"] for row in rows},
                   key=lambda k: -sum(row["verdict"] == k for row in rows))
    print("| verdict | designs | median s | longest s |\n|---|---|---|---|")
    for kind in kinds:
        times = [row["seconds"] for row in rows if row["verdict"] == kind]
        print("| %s | %d | %.2f | %.2f |" % (kind, len(times), median(times), max(times)))
    ran = [row for row in rows if row["verdict"] != "refused"]
    bad = [row for row in ran if row["verdict"] in (OURS, "out of time")
           or row["verdict"].startswith("no answer")]
    stop = median([row["seconds"] for row in ran if row["verdict"] != "complete"])
    success = median([row["seconds"] for row in ran if row["verdict"] == "complete"])
    share = len(bad) / len(ran) if ran else 0
    print("\n%d designs, %d ran; ours, out of time and without an answer: %d (%.1f %%); a stop takes "
          "%.2g of a success" % (len(rows), len(ran), len(bad), 100 * share, stop / success))
    return share


def main():
    p = argparse.ArgumentParser()
    p.add_argument("dea")
    p.add_argument("--count", type=int, default=200)
    p.add_argument("--first", type=int, default=0)
    p.add_argument("--model", default="3d")
    p.add_argument("--seconds", type=int, default=60, help="of processor time, for one design")
    p.add_argument("--total", type=float, default=1e9, help="of processor time, for all")
    p.add_argument("--coarse", action="store_true", help="elements of order 1: a quick look")
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--keep")
    p.add_argument("--beside")
    p.add_argument("--within", type=float, default=0.05, help="of voltages and of what moved")
    p.add_argument("--out")
    p.add_argument("--compare")
    p.add_argument("--share", type=float, default=1)
    p.add_argument("--plies", action="store_true")
    p.add_argument("--steps", type=lambda x: [float(step) for step in x.split(",")])
    p.add_argument("--apart", type=float, default=0.005)
    a = p.parse_args()
    a.design = plies_of if a.plies else design_of
    rows, spent = [], 0
    folder = a.keep or tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    if a.steps:
        return steps_table(a, folder)
    out = open(a.out, "w") if a.out else None
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        numbers, waiting = iter(range(a.first, a.first + a.count)), set()
        while True:
            while spent <= a.total and len(waiting) < a.jobs:
                number = next(numbers, None)
                if number is None:
                    break
                waiting.add(pool.submit(run_design, a, folder, number))
            if not waiting:
                break
            done, waiting = concurrent.futures.wait(
                waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for row in (future.result() for future in done):
                rows.append(row)
                spent += row["seconds"]
                if out:
                    out.write(json.dumps(row) + "\n")
                    out.flush()
    share = table(rows)
    beside = [row for row in rows if "beside" in row]
    if beside:
        off = [row for row in beside if row["beside"]]
        print("%d designs beside %s, of which %d differ" % (len(beside), a.beside, len(off)))
        for row in off:
            print("design %d: %s" % (row["design"], row["beside"]))
    if a.compare:
        old = {row["design"]: row for row in map(json.loads, open(a.compare))}
        for row in rows:
            before = old.get(row["design"])
            if before and before["verdict"] != row["verdict"]:
                print("design %d: %s -> %s" % (row["design"], before["verdict"], row["verdict"]))
    return share > a.share


if __name__ == "__main__":
    sys.exit(main())
