#!/bin/sh
# What dea reduce-order writes, in the programs that it is for: the state space in Octave and numpy
# beside study frequency; the subcircuit in ngspice, behind a resistor, beside numpy.
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
"$DEA_COMMAND" reduce-order "$design" -s compute.reduced.file=cone.json --bias '3 kV' \
  --state-space free-ss.json --spice film.cir >out 2>&1 || { cat out; exit 1; }
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
command -v ngspice >/dev/null || { echo "ngspice is needed: apt-get install ngspice (packages.txt)"; exit 1; }
cat >step.cir <<'END'
a driver with the film
.include film.cir
Vs s 0 PWL(0 3000 1m 3050)
Rs s p 20meg
Xf p 0 q dea_film
.options reltol=1e-6
.control
tran 50u 0.1 0 50u
wrdata step.txt v(p) v(q)
quit
.endc
.end
END
ngspice -b step.cir >out 2>&1
[ -s step.txt ] || { cat out; exit 1; }
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
# the step: (V_s - V)/R is the slope of the charge C x + D u
s = json.load(open('free-ss.json'))
A, B, C, D = (np.array(s[k]) for k in 'ABCD')
b, d = B[:, 0], D[:, 0]
R, V0, q0 = 20e6, s['bias_inputs'][0], s['bias_outputs'][0]
n = len(A)
M = np.zeros((n + 1, n + 1)) # of x and u, and what the source adds
M[:n, :n], M[:n, n] = A, b
M[n, :n], M[n, n] = -C[1] @ A / d[1], (-1 / R - C[1] @ b) / d[1]
g = np.zeros(n + 1)
g[n] = 1 / (R * d[1])
h, t, z = 5e-5, 0.0, np.zeros(n + 1)
left, right = np.eye(n + 1) - h / 2 * M, np.eye(n + 1) + h / 2 * M
own = [(0.0, 0.0, 0.0)]
source = lambda t: 50 * min(t / 1e-3, 1)
while t < 0.1:
    z = np.linalg.solve(left, right @ z + h / 2 * g * (source(t) + source(t + h)))
    t += h
    own.append((t, z[n], C[0] @ z[:n] + d[0] * z[n]))
own = np.array(own)
spice = np.loadtxt('step.txt')
for column, k, offset, unit in ((1, 1, V0, 1), (3, 2, q0 * 1e6, 1e-6)):
    got = (spice[:, column] - offset) * unit
    wanted = np.interp(spice[:, 0], own[:, 0], own[:, k])
    off = np.max(np.abs(got - wanted)) / np.ptp(wanted)
    assert off < 1e-3, (column, off)
END
