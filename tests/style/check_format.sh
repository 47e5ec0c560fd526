#!/bin/sh
# clang-format has nothing to change: of what has changed since it had nothing.
set -eu
cd "$1"
command -v clang-format-14 >/dev/null 2>&1 || exit 77
good=$2/check_format.good since=
[ -e "$good" ] && [ -z "$(find .clang-format -newer "$good")" ] && since="-newer $good"
touch "$good.new"
# shellcheck disable=SC2086 # two words
files=$(find src lab tests benchmarks verify web matlab -name '*.[ch]' $since)
# shellcheck disable=SC2086 # names without blanks
[ -z "$files" ] || clang-format-14 --dry-run -Werror $files
mv "$good.new" "$good"
