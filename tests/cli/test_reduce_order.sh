#!/bin/sh
# What dea reduce-order writes, in the programs that it is for: the state space in Octave and numpy
# beside study frequency and the slope of a sweep.
# ctest: octave, solid
set -u
source=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
design=$source/examples/devices/cone-mass.yaml
"$DEA_COMMAND" reduce-order "$design" -o cone.json --state-space cone-ss.json --bias '3 kV' \
  --damping 0.03 >out 2>&1 || { cat out; exit 1; }
"$DEA_COMMAND" run "$design" --model reduced --study frequency --no-figures -o run \
  -s compute.reduced.file=cone.json \
  -s 'compute.frequency={bias: [3 kV], excitation: 1 V, from: 2 Hz, to: 40 Hz, points: 25, damping: 0.03}' \
  >out 2>&1 || { cat out; exit 1; }
cat >look.m <<'END'
s = jsondecode(fileread('cone-ss.json'));
G = @(f) s.C * ((2i * pi * f * eye(rows(s.A)) - s.A) \ s.B) + s.D;
assert(all(real(eig(s.A)) < 0));
% reciprocity: displacement by voltage is charge by force
g = G(7); assert(abs(g(1, 2)) > 0 && abs(g(1, 1) - g(2, 2)) < 1e-9 * abs(g(1, 1)));
fid = fopen('octave.csv', 'w');
for f = [2 5 11 12 20], fprintf(fid, '%.17g,%.17g\n', f, abs(G(f)(1, 1))); end
fclose(fid);
END
{ octave-cli --no-init-file look.m && grep -q . octave.csv; } >out 2>&1 || { cat out; exit 1; }
/usr/bin/python3 - <<'END' || exit 1
import csv, glob, json
import numpy as np
s = json.load(open('cone-ss.json'))
A, B, C, D = (np.array(s[k]) for k in 'ABCD')
def G(f):
    return C @ np.linalg.solve(2j * np.pi * f * np.eye(len(A)) - A, B) + D
for f, size in (map(float, row) for row in csv.reader(open('octave.csv'))):
    assert abs(abs(G(f)[0, 0]) / size - 1) < 1e-9
row = list(csv.DictReader(open(glob.glob('run/*frequency.csv')[0])))
key = next(k for k in row[0] if 'amplitude' in k and 'hub z' in k)
unit = {'nm': 1e-9, 'um': 1e-6, 'mm': 1e-3}[key[key.index('(') + 1:-1]]
for r in row:
    wanted = float(r[key]) * unit
    got = abs(G(float(r['frequency (Hz)']))[0, 0])
    assert abs(got / wanted - 1) < 1e-6, (r['frequency (Hz)'], got, wanted)
END
