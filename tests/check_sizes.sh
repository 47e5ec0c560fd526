#!/bin/sh
# Files stay under 500 lines and functions under about 60: those above are listed, and a function
# above 80 lines is an error.
set -eu
cd "$1"
# shellcheck disable=SC2016 # awk's own
find src bench tests verify -name '*.[ch]' -exec awk '
  FNR == 1 { if (last != "") { file_end() } last = FILENAME; open = 0 }
  { lines = FNR }
  /^{/ { open = FNR; name = before }
  /^}/ && open { length_ = FNR - open - 1; functions++
    if (length_ > 80) { print last ":" open ": function of " length_ " lines: " name; bad = 1 }
    else if (length_ > 60) { print "note: " last ":" open ": function of " length_ " lines: " name }
    open = 0 }
  { before = $0 }
  function file_end() { if (lines > 500) { print last ": " lines " lines"; bad = 1 } }
  END { file_end(); if (functions == 0) { print "no function found: the check is broken"; bad = 1 }
    exit bad }' {} +
