#!/bin/sh
# clang-format has nothing to change.
set -eu
cd "$1"
command -v clang-format-14 >/dev/null 2>&1 || exit 77
find src tests bench verify web matlab -name '*.[ch]' -exec clang-format-14 --dry-run -Werror {} +
