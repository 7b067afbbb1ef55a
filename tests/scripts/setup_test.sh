#!/usr/bin/env bash
# setup_test.sh SETUP_SH: tests the messages of cmake/setup.sh in a folder that is set up, with a
# program in place of cmake that prints the lines of a build.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/cmake" "$work/build" "$work/bin"
cp "$1" "$work/cmake/setup.sh"
cd "$work"
echo '"name": "default"' >CMakePresets.json
echo dependencies >build/setup.dependencies
touch build/build.ninja build/CMakeCache.txt
printf '#!/bin/sh\n' >cmake/install_packages.sh
printf '#!/bin/sh\necho dependencies\n' >cmake/build_trilinos.sh
printf '#!/bin/sh\ncat lines\nexit $(cat code)\n' >bin/cmake
chmod +x cmake/*.sh bin/cmake
export PATH=$work/bin:$PATH
unset CMAKE_PREFIX_PATH Kokkos_ROOT Kokkos_DIR

fail() {
  echo "FAILED: $1"
  cat log
  exit 1
}
# expect CODE LAST_STEP: runs setup.sh on a build of so many steps; its messages are in log.
expect() {
  printf '[0/2] Re-checking globbed directories...\n[1/%s] Noting the git commit\n' "$2" >lines
  echo "$1" >code
  local code=0
  cmake/setup.sh >log 2>&1 || code=$?
  [[ $code -eq $1 ]] || fail "exit code $code instead of $1"
}

code=0
cmake/setup.sh --preset nope >log 2>&1 || code=$?
[[ $code -eq 2 ]] && grep -q '^setup: found no preset "nope"' log || fail "an unknown preset is not refused"
[[ ! -e build-nope ]] || fail "an unknown preset leaves a folder"
expect 0 4
[[ ! -s log ]] || fail "a build with nothing to compile gives a message"
expect 0 140
grep -qE '^setup: building build/ \([0-9]+ at a time\)$' log || fail "a build gives no message"
expect 1 140
grep -q '^setup: the build failed; the last lines of .*/build/setup.log:$' log || fail "a failed build gives no message"
grep -q 'Noting the git commit' log || fail "the lines of a failed build are not shown"
