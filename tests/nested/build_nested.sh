#!/bin/sh
# Builds the project in a folder of its own and runs its tests of some labels and without others.
#   build_nested.sh SOURCE BUILD LABELS WITHOUT CMAKE_OPTION...
set -eu
source=$1 build=$2 labels=$3 without=$4
shift 4
# Little optimisation, with which gcc guesses lengths of texts wrong, and only the tests that run: sanitizers make
# compilers slow.
cmake -G Ninja -S "$source" -B "$build" -DDEA_LONG_TESTS=OFF -DDEA_BUILD_BENCH=OFF \
  -DDEA_BUILD_VERIFY=OFF -DDEA_TEST_LABELS="$labels" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DCMAKE_C_FLAGS_RELWITHDEBINFO="-Og -g1 -Wno-unknown-warning-option -Wno-format-truncation" "$@"
cmake --build "$build"
# Every allocation is failed in turn by some tests, so a failed one must come back as NULL. clang-14
# does not know where glibc 2.36 keeps the thread-local storage of modules, and its search for leaks
# may crash there if it follows that. One job more than there are processors, for tests that wait.
ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1:intercept_tls_get_addr=0 UBSAN_OPTIONS=print_stacktrace=1 \
  ctest --test-dir "$build" -L "$labels" -LE "$without" --output-on-failure -j "$(($(nproc) + 1))"
