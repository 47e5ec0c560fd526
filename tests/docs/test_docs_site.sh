#!/bin/sh
# ctest: docs, nightly
# scripts/docs makes the site; each link in it has its target, and nothing is asked of other hosts.
set -eu
source=$1
for tool in /usr/bin/sphinx-build mandoc; do
  command -v "$tool" >/dev/null 2>&1 || { echo "$tool is missing: scripts/test installs it"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sh "$source/scripts/docs" "$work" || exit 1
/usr/bin/python3 "$source/tests/docs_links.py" "$work/html"
