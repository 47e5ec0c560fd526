#!/bin/sh
# ctest: quick
# verify/random_designs.py sets two models beside each other by their events: pull-in is the same
# whether a film has ended there or has snapped past it.
set -eu
command -v python3 >/dev/null || exit 77
cd "$1/verify"
python3 -B - <<'END'
from random_designs import differs


def film(verdict, pull_in_V, stretches, snapped_V=1e9):
    """Summary of a taut film, swept in steps of 100 V."""
    return {"verdict": verdict, "limits": {"pull_in_voltage_V": pull_in_V} if pull_in_V else {},
            "points": [{"voltage_V": 100.0 * i, "electrode_stretch": stretch,
                        "min_tension_N_per_m": 1.0,
                        "flags": ["states"] if 100 * i > snapped_V else []}
                       for i, stretch in enumerate(stretches)]}


taut, far = [1, 1.02, 1.05], [3, 3.2]
ends = film("pull_in", 250.0, taut)
snaps = film("", 252.0, taut + far, 252)
assert differs(ends, snaps, 0.05) == ""  # one pull-in; the first ends, the second goes on
assert differs(snaps, ends, 0.05) == ""
assert differs(snaps, film("", 252.0, taut + [3.5, 3.9], 252), 0.05) == ""  # of far states no word
assert "pull-in" in differs(snaps, film("", 220.0, taut + far, 220), 0.05)
assert "pull-in" in differs(snaps, film("", None, taut + [1.1, 1.2]), 0.05)
assert "pull-in" in differs(ends, film("", None, taut + [1.1, 1.2]), 0.05).replace("_", "-")
assert differs(film("", 399.0, taut + [1.1]), film("", None, taut + [1.1, 1.2]), 0.05) == ""
assert differs(ends, film("law_end", None, taut), 0.05) == "pull_in, law_end"
assert "stretch" in differs(ends, film("pull_in", 250.0, [1, 1.02, 1.08]), 0.05)
assert differs(film("", None, taut), film("", None, taut), 0.05) == ""
assert differs(film("pull_in", None, []), film("pull_in", None, []), 0.05) == ""  # of films without a rest

slack = film("slack", None, taut)
slack["limits"]["slack_voltage_V"] = 250.0
for end_V, word in ((251.0, ""), (200.0, "slack")):  # a law that ends there hides the loss of tension
    law = film("law_end", None, taut)
    law["stopped"] = "the law ends at %g kV, on the way to 0.3 kV" % (1e-3 * end_V)
    assert differs(law, slack, 0.05).startswith(word) and (word or differs(law, slack, 0.05) == "")
no_tension = film("", None, taut)  # a membrane that has lost it has none, and no less
no_tension["points"][1]["min_tension_N_per_m"] = 0.0
assert differs(no_tension, slack, 0.05).startswith("slack")  # too early
no_tension["points"][1]["min_tension_N_per_m"] = 1.0
no_tension["points"].append(dict(no_tension["points"][2], voltage_V=300.0, min_tension_N_per_m=0.0))
assert differs(no_tension, slack, 0.05) == ""
flat = film("pull_in", 250.0, taut)
flat["limits"]["pull_in_of_slack_film"] = True  # which says nothing
assert differs(flat, film("pull_in", 150.0, taut), 0.05) is None
END
