#!/usr/bin/env bash
# Sets up, builds, checks the format and runs all tests. Further arguments go to ctest, for example
# ./test.sh -R contact. Ends with ctest's own summary, and with a line on the format if it is
# wrong.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  sed -n '2,4s/^# //p' test.sh
  exit 0
fi

cmake/setup.sh --with-format

format=right
if command -v clang-format >/dev/null; then
  {
    git ls-files -z '*.cpp' '*.hpp' 2>/dev/null ||
      find contact mechanics io miniapp tests verification -name '*.[ch]pp' -print0
  } | xargs -0 clang-format --dry-run -Werror || format=wrong
  [[ $format == right ]] || echo "test.sh: the format is wrong in the places above; clang-format -i corrects it"
else
  echo "test.sh: clang-format is not installed; the format is not checked"
fi

passed=true
ctest --preset default --parallel 2 "$@" || passed=false
if [[ $format == wrong ]]; then
  echo "test.sh: the format is wrong; the places are listed above the tests"
  exit 1
fi
$passed
