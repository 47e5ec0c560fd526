#!/bin/sh
# The MEX file compiled as a user would, against the library of the build; the assertions of
# octave_package.m; the code of docs/octave.md as it stands; and Ctrl-C.
# ctest: octave
set -u
source=$1
build=$(dirname "$DEA_COMMAND")
command -v mkoctfile >/dev/null || {
  echo "mkoctfile is needed: apt-get install octave-dev (packages.txt)"
  exit 1
}
if [ ! -e "$build/libdea.so" ] || nm -D "$build/libdea.so" | grep -qE '__(asan|tsan|ubsan)_'; then
  echo "skipped: Octave cannot load a libdea that is static or has sanitizers"
  exit 77
fi
[ -e "$build/dea_solid_module.so" ] || {
  echo "skipped: this build has no model 3d"
  exit 77
}
folder=$(mktemp -d)
octave=
trap 'kill ${octave:-} 2>/dev/null; rm -rf "$folder"' EXIT
cd "$folder" || exit 1

# octave_start FILE: runs it in the background, its output in FILE.out.
octave_start() {
  { echo "addpath('$source/matlab'); addpath('$folder'); set(0, 'defaultfigurevisible', 'off');"
    cat "$1"
    echo "disp('came to its end');"
  } >script.m
  octave-cli --no-init-file script.m >"$1.out" 2>&1 &
  octave=$!
}
# octave_end FILE: waits for it; it came to its end, and left without a crash.
octave_end() {
  { wait $octave && tail -n 3 "$1.out" | grep -q 'came to its end'; } || {
    echo "$1:"
    cat "$1.out"
    exit 1
  }
}
octave_run() {
  octave_start "$1"
  octave_end "$1"
}

echo "dea_build('include', '$source/src/api', 'library', '$build', 'to', '$folder')" >build.m
octave_run build.m

"$DEA_COMMAND" --quiet run "$source/examples/frdea-4.yaml" -o by_command --model lumped \
  --set 'compute.voltage={from: 0 kV, to: 4 kV, step: 0.5 kV}' || exit 1
{ echo "source_folder = '$source';"
  cat "$source/tests/octave_package.m"
} >package.m
octave_run package.m

"$DEA_COMMAND" examples frdea-4 >frdea-4.yaml 2>examples.err || exit 1
awk '/^```octave$/ { take = 1; next } /^```$/ { take = 0 } take' "$source/docs/octave.md" >tutorial.m
[ -s tutorial.m ] || { echo "no code found in docs/octave.md"; exit 1; }
octave_run tutorial.m
grep -q '<svg' sweep.svg || { echo "the tutorial left no picture"; exit 1; }

# Ctrl-C while a run says how far it is: its points are there and the script goes on.
cat >long.m <<'END'
d = dea.Design('frdea-4.yaml');
d.set('compute.voltage', '{from: 0 kV, to: 4 kV, step: 1 V}');
[r, stopped] = dea.run(d, 'models', '3d', 'studies', 'sweep');
assert(~isempty(strfind(stopped, 'interrupted')), stopped);
p = r.table('3d/sweep');
assert(numel(p.voltage_V) >= 1 && p.voltage_V(end) == numel(p.voltage_V) - 1);
END
octave_start long.m
until grep -q '^dea: 3d sweep, ' long.m.out; do
  kill -0 $octave || break
  sleep 0.1
done
kill -INT $octave
octave_end long.m
