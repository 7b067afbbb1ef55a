#!/usr/bin/env bash
# run_sh_test.sh RUN_SH PROGRAM INPUTS: tests the arguments, files, last lines and exit codes of
# run.sh.
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

# Numbers of ranks and threads may follow their letters without a blank.
expect 0 mesh "$inputs/one_brick.toml" -n2 -t1 -o without_blank
[[ -s without_blank/one_brick.exo.2.1 ]] || fail "-n2 is not two ranks"

# Threads are those of -t, or of OMP_NUM_THREADS.
threads_of() { sed -n 's/.*"threads_per_rank": *\([0-9]*\).*/\1/p' "$1/report.json" | head -n 1; }
OMP_NUM_THREADS=1 expect 0 "$inputs/one_brick.toml" --steps 2 --no-picture -o single
OMP_NUM_THREADS=1 expect 0 "$inputs/one_brick.toml" --steps 2 --no-picture -o double -t 2
[[ $(threads_of single)$(threads_of double) == 12 ]] || fail "the numbers of threads are not those asked for"
OMP_NUM_THREADS=2,1 expect 2 "$inputs/one_brick.toml" --steps 2 --no-picture -o lists
grep -q '^run.sh: OMP_NUM_THREADS needs a positive number, not "2,1"' log || fail "a list of threads is not refused"

# One rank in the same folder removes the rank files of the earlier run, and nothing else; -o names another folder.
touch out/one_brick/one_brick.exo.{2024.01.15,1.0,10.7,3.3,notes.0}
expect 0 "$inputs/one_brick.toml" --steps 20 --no-picture
[[ ! -e out/one_brick/one_brick.exo.2.0 && ! -e out/one_brick/one_brick.exo.2.1 ]] || fail "rank files of an earlier run are still there"
[[ $(ls out/one_brick/one_brick.exo.*) == *.1.0*.10.7*.2024.01.15*.3.3*.notes.0 ]] || fail "files that are not of ranks are removed"
# A mesh does not replace the results of a run that is at work.
(
  flock 8
  expect 4 mesh "$inputs/one_brick.toml"
) 8<out/one_brick
grep -q 'another run is writing to this folder' log || fail "a mesh is written beside a run"
expect 0 mesh "$inputs/one_brick.toml" -n 2 -o elsewhere
[[ -s elsewhere/one_brick.exo ]] || fail "no mesh in the folder of -o"

# check writes nothing; exit codes are those of the program.
expect 0 check "$inputs/one_brick.toml" -o checked
[[ ! -e checked ]] || fail "check writes files"
expect 2 run "$inputs/one_brick.toml" --set wall.brics=1
expect 2 run no_such_deck.toml
expect 2 run -n none
expect 2 serach "$inputs/one_brick.toml"
grep -q '^run.sh: found "serach", expected run, check' log || fail "an unknown command is not named"

# Many more ranks than cores are refused unless the user insists; a few more give a warning.
too_many=$((8 * $(nproc) + 1))
expect 2 check "$inputs/one_brick.toml" -n $too_many
grep -q -- "$too_many ranks are more than 8 for each of the [0-9]* cores\\?; --oversubscribe" log || fail "too many ranks are not refused"
expect 0 mesh "$inputs/one_brick.toml" -n $(($(nproc) + 1)) -o oversubscribed
grep -q 'warning: .* ranks share [0-9]* cores\?;' log || fail "more ranks than cores give no warning"
taskset -c "$(taskset -cp $$ | sed 's/.*: *\([0-9]*\).*/\1/')" "$run_sh" mesh "$inputs/one_brick.toml" -n 2 -o oversubscribed --program "$program" >log 2>&1
grep -q 'warning: 2 ranks share 1 core;' log || fail "one core is not in the singular"

# An option without its value is an error; the next option is not taken for the value.
for options in "-n -o x" "-o -n 2" "-t --steps 5" "--set --no-picture" "--preset -n 2" "--ranks=" "--output= -n 1"; do
  # shellcheck disable=SC2086
  expect 2 run "$inputs/one_brick.toml" $options
  grep -q -- "^run.sh: ${options%%[ =]*} needs a value" log || fail "run.sh $options: the error does not name the option without a value"
done
[[ ! -e x ]] || fail "an option without its value leaves files"

# start_run FOLDER: starts a run without end in the background as $running.
start_run() {
  "$run_sh" run "$inputs/one_brick.toml" --program "$program" -n 2 -t 1 -o "$1" --steps 100000000 --set time.end=1e3 \
    --no-picture >log 2>&1 &
  running=$!
  for _ in $(seq 100); do [[ -s $1/one_brick.exo.2.1 && $(wc -l <"$1/history.csv") -gt 2 ]] && break; sleep 0.1; done
}
# Each of these signals ends a run after its step, with its rank files joined and a checkpoint.
for signal in TERM HUP USR2; do
  rm -rf ended
  start_run ended
  code=0
  kill -USR1 "$running"
  sleep 0.3
  kill "-$signal" "$running"
  wait "$running" || code=$?
  [[ $code -eq 5 ]] || fail "a run that gets SIG$signal ends with $code"
  tail -n 1 log | grep -qE "^STOPPED: ended by (SIG$signal|a signal) after step" || fail "the last line does not name SIG$signal"
  [[ $(find ended/checkpoints -name 'step-*' | wc -l) -eq 2 ]] || fail "SIGUSR1 or SIG$signal wrote no checkpoint"
  [[ -s ended/one_brick.exo ]] || fail "the rank files are not joined after SIG$signal"
done
# Such a run continues on another number of ranks.
expect 5 run "$inputs/one_brick.toml" -t 1 -o ended --restart latest --time-limit 00:00:01 --steps 100000000 --set time.end=1e3 --no-picture
grep -q '^restarted at step' log || fail "the run was not restarted"
[[ -s ended/one_brick.exo && ! -e ended/one_brick.exo.2.0 ]] || fail "the restarted run does not replace the rank files"
[[ $(cut -d, -f1 ended/history.csv | sort | uniq -d | wc -l) -eq 0 ]] || fail "rows are twice in history.csv"

# A run that gets a second signal ends at once, and prints the command that joins its rank files. Its
# first signal finds the ranks stopped.
start_run killed
ranks=$(pgrep -P "$(pgrep -P "$running" | head -n 1)" | tr '\n' ' ')
# shellcheck disable=SC2086
kill -STOP $ranks
code=0
kill -TERM "$running"
sleep 0.3
kill -TERM "$running"
sleep 0.3
# shellcheck disable=SC2086
kill -CONT $ranks 2>/dev/null || true
wait "$running" || code=$?
[[ $code -eq 143 ]] || fail "a run that is killed ends with $code"
grep -q 'run.sh: interrupted; the rank files are not joined' log || fail "a killed run prints nothing about its rank files"
join=$(tail -n 1 log)
[[ ! $join =~ ^\ \ cd\ \'killed\'\ .*\ -auto\ \'one_brick.exo.2.0\'$ ]] && fail "the command that joins is not printed"
if [[ $join != *"'epu'"* ]]; then
  (eval "$join") >join.log 2>&1 || { cat join.log; fail "the printed command does not join"; }
  [[ -s killed/one_brick.exo ]] || fail "the printed command makes no joined file"
fi

# Reports are made without the program.
code=0
"$run_sh" report out/one_brick >log 2>&1 || code=$?
[[ $code -eq 0 ]] || fail "run.sh report ends with $code"
grep -q '^one_brick: ' log || fail "run.sh report does not name the deck"
"$run_sh" study tiny.toml >log 2>&1 && fail "run.sh study is no error"
grep -q 'run.sh: a study is started with --study' log || fail "run.sh study is not refused with the right option"

# Studies: an unknown name is refused with the list of names, decks are refused, each study has its
# own help.
expect 2 --study papers
grep -q 'unknown study "papers"; known studies: paper, verification, stability, accuracy, same-bits' log || fail "an unknown study is not refused by name"
expect 2 --study
expect 2 --study no_such_study.toml
grep -q 'brickwall study: error: no_such_study.toml: No such file' log || fail "a missing study file is not refused by name"
printf 'repetitions = 1\nwarmup = 0\n[[case]]\ndeck = "%s/one_brick.toml"\nset = { time.steps = 20 }\n' "$inputs" >tiny.toml
expect 0 --study tiny.toml
[[ -s out/study_tiny/study.csv && -s out/study_tiny/report.html ]] || fail "a study file gives no results"
expect 2 --study paper "$inputs/one_brick.toml"
expect 2 --study paper --sizes none -o study
expect 0 --study paper -h
grep -q -- '--sizes' log || fail "a study has no help"
expect 0 search "$inputs/wall_17k.toml" -o search_only --set search.repetitions=1
[[ -s search_only/search.json && ! -e search_only/report.json ]] || fail "a search does not write its own report"
echo "run.sh works as documented"
