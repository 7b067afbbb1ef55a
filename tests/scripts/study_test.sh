#!/usr/bin/env bash
# study_test.sh RUN_SH PROGRAM CHECK: runs tiny studies, of the paper's figures and of balance. Checks the contents
# of its files, that a second call reuses finished runs, and that a failing program is reported
# while the study continues.
set -euo pipefail
run_sh=$1 program=$2 check=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
if ! /usr/bin/python3 -c 'import matplotlib' 2>/dev/null; then
  echo "skipped: no matplotlib"
  exit 77
fi

fail() {
  echo "FAILED: $1"
  cat log
  exit 1
}
study() { "$run_sh" --study paper --sizes 2 --repetitions 2 "$@" >log 2>&1; }

study --program "$program" --methods paper,reference -n 1,2 -t 1 -o tiny || fail "the study ends with an error"
/usr/bin/python3 "$check" tiny || fail "the files of the study are wrong"
grep -q 'reused' log && fail "a first study reuses runs"

# A second call runs only cases that changed; another number of repetitions makes other cases.
study --program "$program" --methods paper -n 1 -t 1 -o tiny || fail "the second call ends with an error"
[[ $(grep -c 'reused' log) -eq 3 ]] || fail "finished runs are not reused"
study --program "$program" --methods paper -n 1 -t 1 -o tiny --repetitions 1 || fail "the third call ends with an error"
grep -q 'reused' log && fail "runs with other options are reused"

# Cases that need too much memory are left out, with the reason.
study --program "$program" --methods paper -n 1 -t 1 -o small --memory 0.03 && fail "a study without a run passes"
grep -q 'left out paper, W(2), 1 rank: needs about' log || fail "a case that needs too much memory is not reported"

# A program that knows one method and fails in some runs: the study continues, reports the failures,
# and fails.
mkdir -p fake/miniapp
cat >fake/miniapp/brickwall <<SCRIPT
#!/bin/bash
case "\$*" in
  *method=cluster*) echo "brickwall: error: expected one of paper" >&2; exit 2 ;;
  check*) exit 0 ;;
  *"--timing paper"*) echo "brickwall: error: it broke" >&2; exit 1 ;;
esac
exec "$program" "\$@"
SCRIPT
chmod +x fake/miniapp/brickwall
code=0
study --program fake/miniapp/brickwall --methods paper,cluster -n 1 -t 1 -o broken || code=$?
[[ $code -eq 1 ]] || fail "a study with a failed run ends with $code instead of 1"
grep -q 'left out method cluster: the program refuses it' log || fail "an unknown method is not reported"
grep -q 'FAILED   W2_paper_n1_t1_paper: failed: exit code 1: brickwall: error: it broke' log || fail "the reason of the failure is not reported"
grep -q ',ok,' broken/study.csv || fail "the finished runs are not in the table"
grep -q ',failed,' broken/study.csv || fail "the run that failed is not in the table"
grep -q '## Failed' broken/study.md || fail "study.md lacks the failed runs"

# The study of balanced contact, with the clock of CPU times.
"$run_sh" --study balance --program "$program" --cpu-time --steps 12 -n 2 --scenes "flying apart" --decompositions primary,surface \
  -o balance >log 2>&1 || fail "the study of balance ends with an error"
awk -F '|' '/flying apart/ { ++rows; good += $7 > 0 } END { exit !(rows == 2 && good == 2) }' balance/table.md ||
  fail "the table of balance lacks critical paths: $(cat balance/table.md)"
echo "the studies work as documented"
