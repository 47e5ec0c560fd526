#!/bin/sh
# ctest: solid, nightly
# Twenty random designs on a coarse mesh: what cannot be computed is said to be what it is. The share
# of "ours" is that of the day on which the test was written, and may only fall. And one on its own
# (29: a coupled field on a film without pre-stretch, which wrinkles; 1289: a membrane that no step
# leads on from just before it loses its tension) that was called "ours" once, and
# one whose rest under stiff electrodes is not found (867), which had no answer at all.
set -eu
command -v python3 >/dev/null || exit 77
run() {
  python3 "$source/verify/random_designs.py" "$DEA_COMMAND" --coarse --seconds 45 "$@"
}
source=$1
run --count 20 --share 0.06
run --first 29 --count 1 --share 0
run --first 1289 --count 1 --share 0
case $(run --first 867 --count 1) in *"no answer"*) exit 1 ;; esac
