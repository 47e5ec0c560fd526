#!/bin/sh
# Uses an installed package as its user would: in a folder that is thrown away, with nothing of the source.
# scripts/package --try and Containerfile run it.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() {
  echo "package: $*" >&2
  exit 1
}

dea --version
dea doctor >doctor.txt || { cat doctor.txt; fail "dea doctor"; }
cat doctor.txt
for what in 'materials .* in /usr/share/dea' 'examples .* in /usr/share/dea' '3D engine */usr/lib' \
  'drawings of dea fab */usr/lib' 'booleans of regions */usr/lib' '.mat files */usr/lib'; do
  grep -q "^ok *$what" doctor.txt || fail "dea doctor does not say ok to: $what"
done
dea examples frdea-4 >my.yaml
dea check my.yaml >/dev/null
dea run my.yaml --model lumped --model 3d --set 'compute.voltage={to: 4 kV, step: 2 kV}' -o my.run >run.txt
dea plot my.run --format png >/dev/null
for file in displacement.svg displacement.png; do
  [ -s "my.run/figures/$file" ] || fail "no figure $file"
done
dea report my.run --quiet
grep -q 'class="sources"' my.run/report.html || fail "no explorer in the report"
dea fab my.yaml -o fab >/dev/null
[ "$(find fab -name '*.dxf' | wc -l)" -gt 0 ] || fail "no files for the workshop"
dea examples --copy designs >examples.txt 2>&1
[ -s designs/devices/cone-mass.yaml ] || fail "no examples"
dea drive /usr/share/dea/lab/examples/first.yaml --sim -o bench.h5 >/dev/null || fail "the simulated bench"
[ -s /usr/share/man/man1/dea.1.gz ] || fail "no manual page"
bash -c '. /usr/share/bash-completion/completions/dea' || fail "the completion does not load"
python3 -c 'import dea; r = dea.run(dea.Design("my.yaml"), models="lumped")
print("%.0f V in Python" % r["lumped/sweep/voltage_V"][-1])' || fail "the Python package"
echo "package: installed and used"
