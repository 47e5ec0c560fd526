#!/bin/sh
# What is left of a recording whose program is killed, or whose computer's power fails: a page on
# stdout. The programs are tests: it needs a build with tests in build/.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
tests=$root/build/tests
[ -x "$tests/test_lab_killed" ] && [ -x "$tests/test_lab_power" ] || exit 77
work=$(mktemp -d "${TMPDIR:-/tmp}/dea-recordings-XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
status=0
"$tests/test_lab_killed" 1000 1 >killed 2>&1 || status=1
"$tests/test_lab_power" 5000 1 cuts.csv >power 2>&1 || status=1
cat <<EOF
# What a recording loses

## The program is killed

A program that records 700 samples of two channels, a reading and a frame of a sensor for each cycle,
as fast as it can, is killed (\`kill -9\`) at a random moment within its first 600 calls; the file is
read and every value compared.

    $(grep 'kills, ' killed)

## The power fails

A layer below HDF5 keeps every write of a recording of 60 cycles, and which of them the program
waited for (\`fsync\`). A cut is a moment among them; the disk then has all that was waited for, and
of the rest

| what came after the last wait | cuts | writes in doubt, mean | cycles announced | cuts that lost some | cycles lost |
|---|---|---|---|---|---|
EOF
awk -F, '
  NR > 1 { n[$2]++; doubt[$2] += $4; said[$2] += $5; if ($6 < $5) { lost[$2]++; cycles[$2] += $5 - $6 } }
  END {
    count = split("nothing,all,some writes,some pages,some sectors of pages", order, ",")
    for (k = 1; k <= count; k++) {
      m = order[k]
      printf "| %s | %d | %.1f | %d | %d | %d |\n", m, n[m], doubt[m] / n[m], said[m], lost[m], cycles[m]
    }
  }' cuts.csv
cat <<'EOF'

Pages are of 4096 bytes, sectors of 512; "some" is each one by the toss of a coin, in any order. No
completed cycle is lost as long as a page of 4096 bytes reaches the disk as a whole or not, as file
systems and disks with sectors of that size write it. The last row is what a disk does that tears
pages: HDF5 does not read such a file. The fourth row stands for disks that write in another order than they were asked to.

Made by `scripts/verify recordings`; in the tests, `test_lab_killed.c` and `test_lab_power.c` make 40
of each by fixed seeds.
EOF
exit $status
