#!/bin/sh
# The shell scripts and the completion are clean to shellcheck, the manual page to mandoc.
set -eu
cd "$1"
build=$2
bad=0
if command -v shellcheck >/dev/null 2>&1; then
  shellcheck -x -P SCRIPTDIR scripts/demo scripts/test scripts/bench scripts/verify scripts/package scripts/docs scripts/analyse scripts/lib.sh .ci/run tests/*/*.sh verify/*.sh || bad=1
else
  echo "shellcheck is missing"
  exit 77
fi
"$DEA_COMMAND" completion bash | shellcheck -s bash -e SC2034 - || bad=1
if command -v mandoc >/dev/null 2>&1; then
  "$DEA_COMMAND" completion man >"$build/dea.1.checked"
  mandoc -Tlint -W warning "$build/dea.1.checked" || bad=1
fi
exit $bad
