#!/usr/bin/env bash
# study_test.sh RUN_SH PROGRAM CHECK: a tiny study of the paper's figures; its files are checked by content, a second call
# takes the runs over, and a program that fails is survived and told.
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
grep -q 'taken over' log && fail "a first study takes runs over"

# Again: nothing is run but what changed; other repetitions are other runs.
study --program "$program" --methods paper -n 1 -t 1 -o tiny || fail "the second call ends with an error"
[[ $(grep -c 'taken over' log) -eq 3 ]] || fail "finished runs are not taken over"
study --program "$program" --methods paper -n 1 -t 1 -o tiny --repetitions 1 || fail "the third call ends with an error"
grep -q 'taken over' log && fail "runs with other options are taken over"

# Memory: what does not fit is left out and told.
study --program "$program" --methods paper -n 1 -t 1 -o small --memory 0.03 && fail "a study without a run passes"
grep -q 'left out paper, W(2), 1 rank: needs about' log || fail "what does not fit is not told"

# A program that knows one method and dies in some runs: the study goes on, tells, and fails.
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
grep -q 'left out method cluster: the program does not take it' log || fail "an unknown method is not told"
grep -q 'FAILED   W2_paper_n1_t1_paper: failed: exit code 1: brickwall: error: it broke' log || fail "why it failed is not told"
grep -q ',ok,' broken/study.csv || fail "the runs that went well are not in the table"
grep -q ',failed,' broken/study.csv || fail "the run that failed is not in the table"
grep -q '## Failed' broken/study.md || fail "study.md does not tell failed runs"
echo "the study keeps its promises"
