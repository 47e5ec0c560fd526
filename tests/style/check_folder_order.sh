#!/bin/sh
# A file of src/X includes headers of X and of the folders before X only, and so do the rooms of
# model/solid and of lab/src; one model knows nothing of another, figures to report nothing of models, and of
# studies their figures only. No file of src includes one of lab. The bench knows no design, device
# or model, but for `film`, which fills its interface of a film. No two files of C have one name. See
# ARCHITECTURE.md.
set -eu
cd "$1"
twice=$(find src lab tests benchmarks verify web matlab -name '*.[ch]' ! -path 'tests/fuzz/*/*' | sed 's|.*/||' | sort | uniq -d)
if [ -n "$twice" ]; then
  echo "name of several files: $twice"
  exit 1
fi
cd src
# shellcheck disable=SC2016 # awk's own
find . -name '*.[ch]' | sed 's|^\./||' | xargs awk '
  BEGIN {
    n = split("base table plot material waveform geometry design device result identify model study figures io compare report job explore fabricate studio api cli", order, " ")
    for (i = 1; i <= n; i++) { rank[order[i]] = i }
    n = split("point element mesh load recovery actuator assembly equilibrium motion model3d", order, " ")
    for (i = 1; i <= n; i++) { room[order[i]] = i } # of model/solid
  }
  function part(path, i, parts) { split(path, parts, "/"); return parts[i] }
  FNR == 1 {
    mine = part(FILENAME, 1)
    if (!(mine in rank)) { print FILENAME ": folder " mine " has no place in the order"; bad = 1 }
  }
  /^[ \t]*#[ \t]*include[ \t]*"/ {
    split($0, quoted, "\""); header = quoted[2]; its = part(header, 1)
    if (!(its in rank)) {
      print FILENAME ":" FNR ": \"" header "\" should name its folder"; bad = 1
    } else if (rank[its] > rank[mine]) {
      print FILENAME ":" FNR ": " mine " must not depend on " its; bad = 1
    } else if (mine ~ /^(figures|io|compare|report)$/ && its ~ /^(model|study)$/ && header != "study/figures.h") {
      print FILENAME ":" FNR ": " mine " solves nothing; it must not depend on " header; bad = 1
    } else if (mine == "model" && its == "model" && header ~ /^model\/.*\// &&
               part(FILENAME, 2) != part(header, 2)) {
      print FILENAME ":" FNR ": must not depend on the model " part(header, 2); bad = 1
    }
    if (FILENAME ~ /^model\/solid\/.*\// && header ~ /^model\/solid\/.*\//) {
      from = part(FILENAME, 3); to = part(header, 3)
      if (!(from in room) || !(to in room)) {
        print FILENAME ":" FNR ": a room of model/solid that has no place in the order"; bad = 1
      } else if (room[to] > room[from] && FILENAME !~ /point\/viscous\.h/) { # that one is to move
        print FILENAME ":" FNR ": room " from " must not depend on " to; bad = 1
      }
      rooms++
    }
    checked++
  }
  END {
    if (checked == 0 || rooms == 0) { print "no include was found: the check is broken"; bad = 1 }
    exit bad
  }'
cd ../lab/src
# shellcheck disable=SC2016 # awk's own
find . -name '*.[ch]' | sed 's|^\./||' | xargs awk '
  BEGIN {
    n = split("recording import matio protocol instrument drive reduce film cli", order, " ")
    for (i = 1; i <= n; i++) { room[order[i]] = i }
  }
  function part(path, i, parts) { split(path, parts, "/"); return parts[i] }
  /^[ \t]*#[ \t]*include[ \t]*"/ {
    split($0, quoted, "\""); mine = part(FILENAME, 1); its = part(quoted[2], 1)
    if (!(mine in room)) {
      print "lab/src/" FILENAME ": room " mine " has no place in the order"; bad = 1
    } else if (its in room ? room[its] > room[mine] : mine !~ /^(film|cli)$/ && its !~ /^(base|table|plot|waveform|result)$/) {
      print "lab/src/" FILENAME ":" FNR ": " mine " must not depend on " its; bad = 1
    }
    checked++
  }
  END {
    if (checked == 0) { print "no include was found: the check is broken"; bad = 1 }
    exit bad
  }'
