#!/bin/sh
# What the estimated errors of model 3d are worth, and where the film is called slack: a page on
# stdout. Numbers come from the command alone. Called by scripts/verify with the folder of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
command=$1/src/dea
finest=2.25
file=frdea-4.yaml

# sweep DIR KV REFINEMENT [KEY=VALUE...]: half the voltage and the voltage, on one mesh.
sweep() {
  folder=$1 kV=$2 refinement=$3
  shift 3
  for pair; do
    shift
    set -- "$@" --set "$pair"
  done
  "$command" run "$root/examples/$file" --model 3d --no-figures --force --quiet \
    --set "compute.voltage={from: 0 kV, to: $kV kV, step: $(awk "BEGIN { print $kV / 2 }") kV}" \
    --set "compute.solid.refinement=$refinement" "$@" -o "$work/$folder" >&2
}

# row NAME COARSE FINE: lines of the table for the voltages that both have.
row() {
  awk -F, -v name="$1" -v tally="$work/tally" '
    function number(key) {
      return !((FILENAME, key) in at) || $at[FILENAME, key] == "" ? "nan" : $at[FILENAME, key] + 0
    }
    FNR == 1 { for (i = 1; i <= NF; i++) at[FILENAME, $i] = i; next }
    FNR == 2 { next }
    FILENAME == ARGV[1] {
      n++
      kV[n] = number("V (kV)"); flags[n] = $at[FILENAME, "flags"]; ratio[n] = number("compression ratio")
      for (q = 1; q <= 3; q++) { value[n, q] = number(key[q]); error[n, q] = number("error of " key[q]) }
      next
    }
    {
      m++
      if (number("V (kV)") != kV[m]) { exit 1 }
      printf "| %s | %g |", name, kV[m]
      for (q = 1; q <= 3; q++) {
        fine = number(key[q])
        if (value[m, q] == "nan" || fine == "nan" || (fine < 0.01 && fine > -0.01)) { printf " | | | |"; continue }
        true = fine - value[m, q]; if (true < 0) true = -true
        if (error[m, q] == "nan") { printf " %.2f | %.2f | none | |", value[m, q], fine; continue }
        effect = true > 0 ? error[m, q] / true : 0
        printf " %.2f | %.2f | %.2f | %.1f |", value[m, q], fine, error[m, q], effect
        print q, effect >> tally
      }
      printf " %.2g | %s |\n", ratio[m], flags[m]
    }
    BEGIN { key[1] = "z centre (um)"; key[2] = "z fibre tip (um)"; key[3] = "u electrode edge (um)" }
  ' "$2/3d_sweep.csv" "$3/3d_sweep.csv"
}

# design NAME KV [KEY=VALUE...]
design() {
  name=$1 kV=$2
  shift 2
  sweep coarse "$kV" 1 "$@"
  sweep fine "$kV" "$finest" "$@"
  row "$name" "$work/coarse" "$work/fine"
}

work=$(mktemp -d "${TMPDIR:-/tmp}/dea-verify-XXXXXX")
trap 'rm -rf "$work"' EXIT
: >"$work/tally"
cat <<END
# What the estimated errors are worth

Made by \`scripts/verify trust\`; not to be edited. Displacements in um of
[frdea-4.yaml](../../examples/frdea-4.yaml) and what is changed of it, on the default mesh and at refinement $finest; the error
that the default mesh's run itself estimates ([theory](../theory/trust.md)); effectivity: estimated over found error, the
found one against refinement $finest (slack films: 1.5), which is itself not without error: where a quantity converges slowly (the edge), it
has a third to a half of it left, and an effectivity of 1 shows as 1.5 to 2. z of less than 0.01 um is left out.

| design | V (kV) | centre | fine | estimated | eff. | fibre tip | fine | estimated | eff. | edge | fine | estimated | eff. | compression ratio | flags |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
END
{
  design 'as built' 5
  design 'as built, high' 6
  design 'eight fibres' 5 fibres.count=8
  file=plain-disc.yaml
  design 'no fibres' 5
  file=frdea-4.yaml
  design 'pre-stretch 1.3' 4 pre_stretch=1.3
  design 'film of 200 um' 8 'film.thickness=200 um'
  design 'fibre 50 um thick' 5 'fibres.thickness=50 um'
  design 'fibre 1 mm wide' 5 'fibres.width=1 mm'
  design 'overlap 1 mm' 5 'fibres.overlap=1 mm stretched'
  design 'hinged at the frame' 5 fibres.outer_end=hinged
  finest=1.5 # a slack film takes many steps, and no mesh is the finer one
  design 'slack: as built' 8
  design 'nearly slack: pre-stretch 1.2' 7 pre_stretch=1.2
  design 'slack: no pre-stretch' 3 pre_stretch=1
} >"$work/table"
cat "$work/table"
echo
for q in 1 2 3; do
  word=$(echo centre:fibre tip:edge | cut -d: -f$q)
  sort -n -k2,2 "$work/tally" | awk -v q=$q -v word="$word" '
    $1 == q { e[++n] = $2; within += $2 >= 0.5 && $2 <= 2; over += $2 > 2; under += $2 < 0.5 }
    END { printf "* %s: %d states, effectivity from %.2f to %.1f, median %.2f; %d between 0.5 and 2, %d above, %d below.\n",
                 word, n, e[1], e[n], e[int((n + 1) / 2)], within, over, under }'
done
cat <<'END'

The largest effectivities are those of found errors that pass through zero. The edge of the actuator with eight fibres, where
the default mesh has one element between neighbouring fibres, is estimated four times too small. Slack films have no
estimate: the centre and the tip of the one as built differ by a fifth from mesh to mesh.
END
