#!/bin/sh
# What dea reduce-order writes, in the programs that it is for: the state space in Octave and numpy
# beside study frequency; the subcircuit in ngspice, behind a resistor, beside study transient of
# models reduced and 3d, and its small motions beside the state space; the unit of FMI 3.0 in a small
# importer (DEA_FMI_SCHEMA: folder of the standard's schemas, against which its XML is then checked);
# the joint of MuJoCo beside the state space.
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
if "$DEA_COMMAND" run "$design" --model reduced --study sweep --no-figures -o run \
  -s compute.reduced.file=cone.json -s 'compute.reduced.air=1.2 kg/m^3' >out 2>&1 || # made in vacuo
  ! grep -q 'another gas' out; then
  cat out
  exit 1
fi
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
for model in reduced 3d; do
  "$DEA_COMMAND" run "$design" --model $model --study transient --no-figures -o $model \
    -s compute.reduced.file=cone.json -s "compute.transient={inertia: yes, tolerance: 5e-3}" \
    -s 'drive={series_resistance: 20 Mohm, waveform: {kind: step, to: 4 kV, rise_time: 1 ms, duration: 20 ms}}' \
    >out 2>&1 || { cat out; exit 1; }
done
{ "$DEA_COMMAND" reduce-order "$design" -s compute.reduced.file=cone.json --fmu cone.fmu >out 2>&1 &&
  /usr/bin/python3 -m zipfile -e cone.fmu fmu; } || { cat out; exit 1; }
if [ -n "${DEA_FMI_SCHEMA:-}" ]; then
  xmllint --noout --schema "$DEA_FMI_SCHEMA/fmi3ModelDescription.xsd" fmu/modelDescription.xml || exit 1
  xmllint --noout --schema "$DEA_FMI_SCHEMA/fmi3BuildDescription.xsd" fmu/sources/buildDescription.xml || exit 1
fi
PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 - "$source" <<'END' || exit 1
import csv, sys
sys.path.insert(0, sys.argv[1] + '/examples/python')
from control import Unit
one, h = Unit('cone.fmu', series_resistance=20e6), 5e-5
assert one.make('another device') is None
def refused(function, *arguments, **named):
    try:
        function(*arguments, **named)
    except ValueError:
        return True
assert refused(one.put, series_resistance=1e6) # fixed by now
rows = [[float(r[k]) for k in ('time (s)', 'V (kV)', 'hub z (um)', 'charge (nC)')]
        for r in csv.DictReader(open('reduced/reduced_transient.csv'))]
worst, sizes = [0.0] * 3, [max(r[k] for r in rows) - min(r[k] for r in rows) for k in (1, 2, 3)]
for number in range(400):
    one.put(voltage=4000 * min((one.now + h / 2) / 1e-3, 1))
    if number == 100: # a state that is kept gives the same step again
        kept = one.keep()
        one.step(h)
        first = one.get('displacement')
        one.restore(kept)
        one.now -= h
    one.step(h)
    assert number != 100 or one.get('displacement') == first
    V, q, charge = one.get('film_voltage', 'displacement', 'charge')
    own = [1e-3 * V, 1e6 * q, 1e9 * charge]
    for r in rows:
        if abs(r[0] - one.now) < 1e-9:
            worst = [max(w, abs(a - b) / size) for w, a, b, size in zip(worst, own, r[1:], sizes)]
print('FMU beside reduced: voltage %.2g %%, displacement %.2g %%, charge %.2g %%' % tuple(100 * w for w in worst))
assert 0 < max(worst) < 0.01
one.put(voltage=1e5)
assert refused(one.step, 1.0) # beyond the range
END
"$DEA_COMMAND" reduce-order "$design" -s compute.reduced.file=cone.json --bias '3 kV' --damping 0.03 \
  --mujoco cone.xml >out 2>&1 || { cat out; exit 1; }
cat >step.c <<'END'
#include <mujoco/mujoco.h>
#include <stdio.h>
int main(void)
{
  char error[500] = "";
  mjModel *m = mj_loadXML("cone.xml", NULL, error, sizeof error);
  if (m == NULL) {
    puts(error);
    return 1;
  }
  mjData *d = mj_makeData(m);
  mj_resetDataKeyframe(m, d, 0);
  for (int i = 0; i <= 400; i++, d->ctrl[0] = 9.06) { // 3.01 kV
    printf("%.12g %.12g\n", d->time, d->qpos[0]);
    mj_step(m, d);
  }
  return 0;
}
END
if echo '#include <mujoco/mujoco.h>' | cc -E - >/dev/null 2>&1; then
  { cc -o step step.c -lmujoco && ./step >mujoco.txt; } || { cat mujoco.txt; exit 1; }
  /usr/bin/python3 - <<'END' || exit 1
import json
import numpy as np
from scipy.signal import lsim
s = json.load(open('cone-ss.json'))
A, B, C, D = (np.array(s[k]) for k in 'ABCD')
t, q = np.loadtxt('mujoco.txt').T
own = lsim((A, B[:, :1], C[:1], D[:1, :1]), np.full(len(t), 1e3 * np.sqrt(9.06) - 3e3), t)[1]
off = np.max(np.abs(q[1:] - q[0] - own[:-1])) / np.ptp(own)
print(f'MuJoCo beside the state space: {100 * off:.2g} %')
assert off < 0.03
END
else
  echo "joint of MuJoCo not run: apt-get install libmujoco-dev (packages.txt)"
fi
command -v ngspice >/dev/null || { echo "subcircuit not run: apt-get install ngspice (packages.txt)"; exit 0; }
{ "$DEA_COMMAND" reduce-order "$design" -s compute.reduced.file=cone.json --spice film.cir >out 2>&1 &&
  "$DEA_COMMAND" reduce-order "$design" -s compute.reduced.file=cone.json --bias '3 kV' \
    --damping 0.03 --spice damped.cir >out 2>&1; } || { cat out; exit 1; }
cat >step.cir <<'END'
a driver with the film
.include film.cir
Vs s 0 PWL(0 0 1m 4000)
Rs s p 20meg
Xf p 0 q dea_film
.options reltol=1e-5
.control
tran 50u 0.02 0 50u
wrdata step.txt v(p) v(q)
quit
.endc
.end
END
cat >ac.cir <<'END'
small motions at 3 kV
.include damped.cir
Vs p 0 DC 3000 AC 1
Xf p 0 q dea_film
.control
ac lin 7 2 20
wrdata ac.txt v(q) i(vs)
quit
.endc
.end
END
timeout 60 ngspice -b step.cir >out 2>&1
timeout 60 ngspice -b ac.cir >>out 2>&1
{ [ -s step.txt ] && [ -s ac.txt ]; } || { cat out; exit 1; }
/usr/bin/python3 - <<'END' || exit 1
import csv, json
import numpy as np
t, V, _, z = np.loadtxt('step.txt').T
for model in 'reduced', '3d':
    rows = list(csv.DictReader(open(f'{model}/{model}_transient.csv')))
    at, own_V, own_z = (np.array([float(r[k]) for r in rows]) for k in ('time (s)', 'V (kV)', 'hub z (um)'))
    off = [np.max(np.abs(np.interp(at, t, got) - own)) / np.ptp(own)
           for got, own in ((V, 1e3 * own_V), (z, own_z))]
    print(f'ngspice beside {model}: voltage {100 * off[0]:.2g} %, displacement {100 * off[1]:.2g} %')
    assert max(off) < 0.01, model
s = json.load(open('cone-ss.json'))
A, B, C, D = (np.array(s[k]) for k in 'ABCD')
for f, re_q, im_q, _, re_i, im_i in np.loadtxt('ac.txt'):
    w = 2j * np.pi * f
    q, charge = (C @ np.linalg.solve(w * np.eye(len(A)) - A, B) + D)[:, 0]
    assert abs(1e-6 * (re_q + 1j * im_q) / q - 1) < 1e-5, f
    assert abs(-(re_i + 1j * im_i) / (w * charge) - 1) < 1e-5, f
END
