#!/usr/bin/env python3
"""Random designs, each swept by one model, and what came of them, as a table of verdicts.

    random_designs.py DEA [--count 200] [--first 0] [--model 3d] [--coarse] [--seconds 60]
                      [--jobs 1] [--keep DIR] [--out rows.jsonl] [--compare rows.jsonl]
                      [--beside axisymmetric] [--share 0.01]

A design follows from its number alone, so that two versions of the program are asked the same.
What may vary: catalogue and own laws, 0 to 24 fibres, pre-stretch 1 to 4, 10 um to 1 mm, glue,
stiff electrodes, weight, membrane and solid film, thin and coupled field, up to twice breakdown.

--keep    folder for the design files of what ended as "ours", one line for the reason
--out     one line of JSON a design
--beside  designs without fibres are swept by that model too, and where its verdict, pull-in, loss of
          tension or last stretch is another one, it is listed
--compare the lines of another version: designs whose verdict is another one are listed
--share   fails (exit 1) where more than this share of the designs that ran ends as "ours"

Sizes: 20 as a test, 200 and 2000 by hand (docs/theory/stops.md).
"""
import argparse
import concurrent.futures
import json
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


OURS = "ours: not converged"


def verdict_of(summary, code, stderr):
    """Kind of verdict and the sentence."""
    if summary is None:
        refused = code in (2, 3) or (code == 5 and "memory" in stderr)
        return ("refused" if refused else "no answer, exit %d" % code), stderr.strip()[-300:]
    if summary.get("complete"):
        leapt = any("states" in point.get("flags", []) for point in summary["points"])
        return ("complete, in another state" if leapt else "complete"), ""
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
    """Stretches at the last voltage at which both films keep their tension, and neither has leapt:
    of waves the flat one knows nothing, and a leap is an event. None: there is none above 0 V."""
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
    Pull-in is an event, whether the film has ended there or has leapt past it."""
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


def run_design(a, folder, number):
    """The row of a design."""
    path = os.path.join(folder, "%05d.yaml" % number)
    text = design_of(number, a.coarse)
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
    a = p.parse_args()
    rows, spent = [], 0
    folder = a.keep or tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
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
