#!/usr/bin/env bash
# Sets up, builds with warnings as errors, checks the format and runs all tests. Further arguments go to ctest, for
# example ./test.sh -R contact. Ends with ctest's own summary.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

cmake/setup.sh --preset ci --with-format

if command -v clang-format >/dev/null; then
  {
    git ls-files -z '*.cpp' '*.hpp' 2>/dev/null ||
      find contact mechanics io miniapp tests verification -name '*.[ch]pp' -print0
  } | xargs -0 clang-format --dry-run -Werror
else
  echo "test.sh: clang-format is not here; the format is not checked"
fi
exec ctest --preset ci --parallel 2 "$@"
