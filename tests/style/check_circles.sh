#!/bin/sh
# No circle of files, and no symbol with two homes: a file A depends on B when its object uses a
# symbol that B defines. Every loop of such ties is printed with its symbols. Usage:
# check_circles.sh SOURCE_DIR BUILD_DIR
set -eu
source=$(cd "$1" && pwd)
cd "$2"
list=$(mktemp)
trap 'rm -f "$list"' EXIT
# one object of each source, the newest, also where it is compiled into several targets, but not what stands for the bench
find src lab -name '*.c.o' ! -name no_bench.c.o -path '*.dir/*' -printf '%T@ %p\n' | sort -rn | cut -d ' ' -f 2- | awk '
  { source = $0; sub(/.*\.dir\//, "", source); sub(/\.o$/, "", source)
    if (!sub(/^__\//, "", source)) { source = ($0 ~ /^lab/ ? "lab/src/" : "src/") source } }
  !(source in seen) { seen[source] = 1; print source, $0 }' | while read -r name object; do
  # not those of sources that are gone
  if [ -e "$source/$name" ]; then echo "$object"; fi
done >"$list"
[ -s "$list" ] || { echo "no object files under $2/src: the check is broken"; exit 1; }
xargs nm -A -g <"$list" | awk '
  { # path:value type name, or path: type name where it is undefined
    colon = index($0, ":"); file = substr($0, 1, colon - 1)
    sub(/.*\.dir\//, "", file); sub(/\.o$/, "", file)
    type = $(NF - 1); name = $NF
    if (type == "U") { users[++uses] = file; used[uses] = name }
    else if (type !~ /[wWvV]/) {
      if (name in home && home[name] != file) {
        print name " is defined in " home[name] " and in " file
        bad = 1
      }
      home[name] = file; own[file, name] = 1
    }
  }
  function visit(a, k, n, to, list) { # Tarjan, strongly connected
    number[a] = low[a] = ++count; stack[++top] = a; on[a] = 1
    n = split(next_of[a], list, " ")
    for (k = 1; k <= n; k++) {
      to = list[k]
      if (!(to in number)) { visit(to); if (low[to] < low[a]) { low[a] = low[to] } }
      else if (on[to] && number[to] < low[a]) { low[a] = number[to] }
    }
    if (low[a] == number[a]) {
      size = 0
      do { to = stack[top--]; on[to] = 0; group[to] = a; size++ } while (to != a)
      if (size > 1) { circle[a] = size }
    }
  }
  END {
    for (i = 1; i <= uses; i++) {
      a = users[i]
      if (used[i] in home && !((a, used[i]) in own)) {
        b = home[used[i]]
        edges++
        if (!((a, b) in ties)) { next_of[a] = next_of[a] " " b }
        ties[a, b] = ties[a, b] " " used[i]
      }
    }
    if (edges == 0) { print "no symbol ties two files: the check is broken"; exit 1 }
    for (a in next_of) { if (!(a in number)) { visit(a) } }
    for (c in circle) {
      bad = 1
      print "circle of " circle[c] " files:"
      for (a in group) {
        if (group[a] != c) { continue }
        n = split(next_of[a], list, " ")
        for (k = 1; k <= n; k++) { if (group[list[k]] == c) { print "  " a " -> " list[k] ":" ties[a, list[k]] } }
      }
    }
    exit bad
  }'
