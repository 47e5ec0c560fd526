#!/bin/sh
# ctest: docs
# Runs docs/tutorial.md and first-device.md: each block of commands of a page in one shell, in a folder that
# is thrown away; each line of a block of text after it must begin a line of what they printed.
set -eu
if [ $# -eq 1 ]; then # both pages, each by itself
  for name in tutorial first-device; do
    result=0
    sh "$0" "$1" "$name" || result=$?
    [ "$result" -eq 0 ] || exit "$result"
  done
  exit 0
fi
page=$1/docs/$2.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/user"
ln -s "$DEA_COMMAND" "$work/bin/dea"
PATH=$work/bin:$PATH
if ! dea doctor 2>/dev/null | grep -q '^ok *3D engine'; then
  echo "no model 3d in this build"
  exit 77
fi
if [ "$2" = first-device ] && dea drive --help | grep -q 'Not in this build'; then
  exit 77
fi
awk -v work="$work" '
  /^```sh$/ { block++; kind = "sh"; print "exec >" work "/said-" block " 2>&1" >(work "/commands"); next }
  /^```text$/ { kind = "text"; next }
  /^```$/ { kind = ""; next }
  kind == "sh" { print >(work "/commands") }
  kind == "text" { print block "\t" $0 >(work "/wanted") }' "$page"
[ "$(grep -c . "$work/wanted")" -gt 4 ] || { echo "hardly any line to compare: the test is broken"; exit 1; }
(cd "$work/user" && sh -eu "$work/commands") || { cat "$work"/said-*; echo "a command of docs/$2.md failed"; exit 1; }
bad=0
while IFS='	' read -r block line; do
  awk -v line="$line" 'BEGIN { bad = 1 } index($0, line) == 1 { bad = 0 } END { exit bad }' "$work/said-$block" ||
    { echo "docs/$2.md: its commands do not print: $line"; cat "$work/said-$block"; bad=1; }
done <"$work/wanted"
exit $bad
