#!/usr/bin/env bash
# run_sh_test.sh RUN_SH PROGRAM INPUTS: what run.sh promises about its arguments, files, last lines and exit codes.
set -euo pipefail
run_sh=$1 program=$2 inputs=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() {
  echo "FAILED: $1"
  [[ ! -e log ]] || cat log
  exit 1
}
# expect CODE ARGUMENTS...: runs run.sh, keeps its output in log, compares the exit code.
expect() {
  local code=0 expected=$1
  shift
  "$run_sh" "$@" --program "$program" >log 2>&1 || code=$?
  [[ $code -eq $expected ]] || fail "run.sh $*: exit code $code instead of $expected"
}

# Two ranks: joined file, picture, and the program's own last two lines at the end.
expect 0 run "$inputs/one_brick.toml" -n 2 -t 1 --steps 20
[[ -s out/one_brick/one_brick.exo && -s out/one_brick/one_brick.exo.2.1 ]] || fail "no joined file and rank files"
[[ -s out/one_brick/report.json && -s out/one_brick/history.csv ]] || fail "no report and history"
tail -n 1 log | grep -q '^PASS' || fail "the last line is not PASS"
tail -n 2 log | head -n 1 | grep -q '^FOM ' || fail "the line before is not the FOM"
if /usr/bin/python3 -c 'import netCDF4, matplotlib' 2>/dev/null; then
  [[ -s out/one_brick/one_brick.png ]] || fail "no picture"
fi

# One rank in the same folder: the rank files of the run before go away, the folder may be named.
expect 0 "$inputs/one_brick.toml" --steps 20 --no-picture
[[ ! -e out/one_brick/one_brick.exo.2.0 ]] || fail "rank files of an earlier run are still there"
expect 0 mesh "$inputs/one_brick.toml" -n 2 -o elsewhere
[[ -s elsewhere/one_brick.exo ]] || fail "no mesh in the folder of -o"

# Nothing is written when nothing is to be; exit codes come through.
expect 0 check "$inputs/one_brick.toml" -o checked
[[ ! -e checked ]] || fail "check writes files"
expect 2 run "$inputs/one_brick.toml" --set wall.brics=1
expect 2 run no_such_deck.toml
expect 2 run -n none

# Studies: an unknown one is refused with those that there are, decks are not for them, each has a help of its own.
expect 2 --study papers
grep -q 'no study "papers"; there are: paper, verification, stability, accuracy, same-bits' log || fail "an unknown study is not refused by name"
expect 2 --study
expect 2 --study paper "$inputs/one_brick.toml"
expect 2 --study paper --sizes none -o study
expect 0 --study paper -h
grep -q -- '--sizes' log || fail "a study has no help"
expect 0 search "$inputs/wall_17k.toml" -o search_only --set search.repetitions=1
[[ -s search_only/search.json && ! -e search_only/report.json ]] || fail "a search does not write its own report"
echo "run.sh keeps its promises"
