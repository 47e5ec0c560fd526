#!/bin/sh
# A film of known pre-stretch and thickness on the simulated bench, reduced and fitted: a page on
# stdout that says how often the error bars hold the truth. Called by scripts/verify with the folder
# of the build.
set -eu
command=$1/src/dea
count=${2:-16}
work=$(mktemp -d "${TMPDIR:-/tmp}/dea-verify-XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >true.yaml <<'END'
dea: 1
film: {material: elastosil-2030, law: yeoh-178, thickness: 100 um, viscosity: none}
pre_stretch: 1.42
frame: {inner_diameter: 30 mm}
electrodes: {radius: 3.75 mm stretched}
fibres: {count: 4, width: 2 mm, thickness: 100 um, overlap: 0 mm stretched, material: pet}
compute: {models: [lumped], voltage: {to: 5 kV, step: 500 V}}
END
sed 's/pre_stretch: 1.42/pre_stretch: 1.5/' true.yaml >design.yaml
cat >protocol.yaml <<'END'
dea-protocol: 1
title: round trip
design: true.yaml
sequence:
  - label: cyclic
    waveform: {kind: staircase, from: 0 kV, to: 4 kV, step: 500 V, cycles: 5, frequency: 2 Hz, duty: 50 %}
amplifier: {name: a, output: ao0, gain: 1000 V/V, control: 10 V, max_voltage: 10 kV, slew_limit: 700 V/us, current_limit: 10 mA}
rate: 1 kHz
channels:
  - {name: amplifier voltage, quantity: voltage, input: ai0, range: 10 V, per_volt: 1 kV}
  - {name: amplifier current, quantity: current, input: ai1, range: 10 V, per_volt: 1 mA}
  - {name: centre laser, quantity: displacement, input: ai2, range: 10 V, per_volt: 1 mm, filter: 100 Hz}
safety: {largest_field: 320 V/um, field_reason: simulated, trip_current: 1 mA, trip_time: 10 ms, voltage_error: 200 V, ramp: 5 kV/s}
END
cat >fit.yaml <<'END'
dea_fit: 1
name: back
design: design.yaml
model: lumped
parameters:
  - {name: pre_stretch, low: 1.2, high: 1.8}
  - {name: film.thickness, low: 60 um, high: 140 um, prior: 100 um, prior_std: 1 um}
curves:
  - {name: sweep, file: reduced}
END
seed=1
while [ "$seed" -le "$count" ]; do
  "$command" drive protocol.yaml --sim --set "sim.seed=$seed" -o bench.h5 --force >/dev/null 2>said || cat said >&2
  "$command" reduce bench.h5 -o reduced --force >/dev/null 2>said || cat said >&2
  "$command" fit fit.yaml -o fitted --force >"fit$seed" 2>said || cat said >&2
  seed=$((seed + 1))
done
cat <<END
# From the simulated bench back to the device

Made by \`scripts/verify fit-round-trip\`; not to be edited. $count recordings of \`dea drive --sim\` (nine
voltages to 4 kV, five cycles each, every recording with noise of its own) of a film with the pre-stretch 1.42
and 100 um, model \`lumped\`; \`dea reduce\`; \`dea fit\` of both numbers from a design that has 1.5, with a prior
of 1 um on the thickness. Off: (found - true) over its standard uncertainty.

| parameter | mean of what was found | mean uncertainty | within 1 std | within 2 std | root mean square off |
|---|---|---|---|---|---|
END
awk '
  $1 == "pre_stretch" { truth = 1.42; unit = "" }
  $1 == "film.thickness" { truth = 100; unit = " um" }
  /->/ && ($1 == "pre_stretch" || $1 == "film.thickness") {
    off = ($4 - truth) / $6
    n[$1]++; units[$1] = unit; found[$1] += $4; std[$1] += $6; squares[$1] += off * off
    one[$1] += off * off < 1; two[$1] += off * off < 4
  }
  END {
    split("pre_stretch film.thickness", names, " ")
    for (k = 1; k <= 2; k++) {
      name = names[k]
      printf "| `%s` | %.5g%s | %.2g%s | %.0f %% | %.0f %% | %.2f |\n", name, found[name] / n[name], units[name],
        std[name] / n[name], units[name], 100 * one[name] / n[name], 100 * two[name] / n[name],
        sqrt(squares[name] / n[name])
      if (one[name] < 0.5 * n[name] || two[name] < 0.8 * n[name]) bad = 1
    }
    exit bad
  }' fit*[0-9]
cat <<'END'

The error bars are somewhat narrow: centre and fibre tips are read off the same profile and err together, which
the fit does not count, and five cycles tell their scatter to a third only.
END
