#!/bin/sh
# Functions stay under about 60 lines: those above are listed, and one above 80 lines is an error. A
# file may be of any length: one algorithm a file.
set -eu
cd "$1"
# shellcheck disable=SC2016 # awk's own
find src lab benchmarks tests verify matlab -name '*.[ch]' -exec awk '
  FNR == 1 { open = 0 }
  /^{/ { open = FNR; name = before }
  /^}/ && open { length_ = FNR - open - 1; functions++
    if (length_ > 80) { print FILENAME ":" open ": function of " length_ " lines: " name; bad = 1 }
    else if (length_ > 60) { print "note: " FILENAME ":" open ": function of " length_ " lines: " name }
    open = 0 }
  { before = $0 }
  END { if (functions == 0) { print "no function found: the check is broken"; bad = 1 }
    exit bad }' {} +
