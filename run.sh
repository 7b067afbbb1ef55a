#!/usr/bin/env bash
# Sets up and builds Brickwall, runs it on a deck, joins the rank files and draws a picture.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

usage() {
  cat <<'TEXT'
Usage:
  ./run.sh [run|check|mesh|search] [DECK] [-n RANKS] [-t THREADS] [-o DIR] [options]
  ./run.sh --study NAME|FILE.toml [-n RANKS,...] [-t THREADS,...] [-o DIR] [options of the study]
  ./run.sh report RUN... [--markdown] [--html FILE]

Commands:
  run       runs the deck (default); joins the Exodus results to one file, draws a picture,
            writes history.csv and report.json
  check     reads the deck and prints the model of the scene; runs nothing
  mesh      writes the Exodus mesh only
  search    runs only the contact search on the surface of the wall; writes search.json
  report    compares finished runs by their folders; builds nothing (the same as brickwall report)

Options:
  DECK                default inputs/brick_wall.toml
  -n, --ranks N       MPI ranks (default 1)
  -t, --threads N     threads of each rank (default: OMP_NUM_THREADS, else physical cores divided by ranks)
  -o, --output DIR    output folder (default out/<deck name>/)
  -h, --help          print this text; with --study NAME, the help of that study
  --preset NAME       build and run this preset of CMakePresets.json (default "default")
  --program FILE      run this program; skip set-up and build
  --no-picture        draw no picture
  --oversubscribe     allow more than 8 ranks for each physical core
  --                  pass everything after it to the program

Further options go to the program, among them:
  --set BLOCK.KEY=VALUE   override a value of the deck (may be repeated)
  --steps N               stop after N steps
  -q, --quiet             print warnings and the last lines only
  --time-limit HH:MM:SS   end after this wall clock time, with output and a checkpoint
  --restart latest|PATH   continue from a checkpoint in the output folder, or at PATH
  --extend-to TIME        with --restart: run on to this time of the simulation
  --no-output             write no file
  --timing paper          separate waits from work in the phases of the search
  --kokkos-...            pass an option to Kokkos
The help of the program itself: build/miniapp/brickwall -h

Studies consist of many runs and write tables and plots to their folder (default out/study_NAME/):
  paper         the search over sizes, methods, ranks and threads: the paper's Figs. 8 to 11
  verification  cases with exact or published answers, PASS or FAIL for each
  stability     hard cases, in the same way
  accuracy      speed against error: walls and exact cases over meshes and settings
  same-bits     the default wall on many ranks and threads, with and without kept lists
  savings       skipped work restored part by part: the same bits, and the time that skipping saves
  step          the time of a coupled step, part by part, over scenes, walls, ranks and threads
  scale         strong and weak scaling, and a model of it up to 100,000 ranks
  balance       the load of the ranks over time in three scenes
  FILE.toml     the runs of a study file, such as verification/performance/studies/*.toml
verification/README.md describes them, miniapp/study/README.md study files.

Exit codes: 0 pass; 1 internal error; 2 faulty deck, mesh or command line; 3 the computation failed or
a limit of the deck was exceeded; 4 an output could not be written; 5 a signal or --time-limit ended the run
early, and --restart latest continues it.

Signals: SIGUSR1 writes a checkpoint; SIGINT (Ctrl-C), SIGTERM, SIGHUP and SIGUSR2 end the run after the step, with
output and a checkpoint, and the rank files are joined; a second one ends it at once.

Environment:
  BRICKWALL_CACHE     folder of the built dependencies (default ~/.cache/brickwall)
  Kokkos_ROOT, Kokkos_DIR, CMAKE_PREFIX_PATH
                      existing dependencies; packages are not installed if they provide Kokkos, and
                      nothing is downloaded if they provide Zoltan and SEACAS too
  NO_COLOR            if set, the live line on a terminal has no colour
  BRICKWALL_MPIEXEC   launcher with its options, to which "-n RANKS" is appended
                      (default: the mpiexec of the build)
TEXT
}
die() {
  echo "run.sh: $1 (try ./run.sh -h)" >&2
  exit 2
}

command=run
deck=
ranks=
threads=
output=
preset=default
program=
picture=yes
oversubscribe=${BRICKWALL_OVERSUBSCRIBE:-no} # a study passes it on to its runs
writes=yes
program_options=()
study=
wants_help=no

# The driver of a study with its first arguments. A new study needs one line here.
choose_study() {
  study=$1
  case $1 in
    paper) driver=("$root/verification/performance/paper/paper_study.py") ;;
    verification | stability) driver=("$root/verification/verify.py" "$1") ;;
    accuracy) driver=("$root/verification/accuracy/accuracy_study.py") ;;
    same-bits) driver=("$root/verification/same_bits.py") ;;
    savings) driver=("$root/verification/savings.py") ;;
    step) driver=("$root/verification/performance/step/step_study.py") ;;
    scale) driver=("$root/verification/performance/scale/scale_study.py") ;;
    balance) driver=("$root/verification/performance/balance/balance_study.py") ;;
    *.toml) driver=("$root/miniapp/study/brickwall-study" "$1") ;;
    *) die "unknown study \"$1\"; known studies: paper, verification, stability, accuracy, same-bits, savings, step, scale, balance, or a file FILE.toml" ;;
  esac
}
counted() { [[ $1 -eq 1 ]] && echo "1 $2" || echo "$1 $2s"; }
positive() { [[ $2 =~ ^[1-9][0-9]*$ ]] || die "$1 needs a positive number, not \"$2\""; }
value_of() {
  [[ $# -ge 2 && -n $2 ]] || die "$1 needs a value"
  [[ ! $2 =~ ^-[^0-9] ]] || die "$1 needs a value, but the option $2 follows"
}

case ${1:-} in
  run | check | mesh | search) command=$1; shift ;;
  report) exec /usr/bin/python3 "$root/miniapp/study/brickwall-report" "${@:2}" ;;
  study) die "a study is started with --study NAME or --study FILE.toml" ;;
esac
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) wants_help=yes; shift ;;
    --study) value_of "$@"; choose_study "$2"; shift 2 ;;
    --study=*) choose_study "${1#*=}"; shift ;;
    -n | --ranks) value_of "$@"; ranks=$2; shift 2 ;;
    -t | --threads) value_of "$@"; threads=$2; shift 2 ;;
    -o | --output) value_of "$@"; output=$2; shift 2 ;;
    --ranks=* | --threads=* | --output=*) # the same as two words
      value_of "${1%%=*}" "${1#*=}"
      set -- "${1%%=*}" "${1#*=}" "${@:2}"
      ;;
    -[nt][0-9]*) set -- "${1:0:2}" "${1:2}" "${@:2}" ;; # -n2 is -n 2
    --preset) value_of "$@"; preset=$2; shift 2 ;;
    --program) value_of "$@"; program=$2; shift 2 ;;
    --no-picture) picture=no; shift ;;
    --oversubscribe) oversubscribe=yes; shift ;;
    --no-output) writes=no; program_options+=("$1"); shift ;;
    -q | --quiet | --checksums | --version) program_options+=("$1"); shift ;;
    --) shift; program_options+=("$@"); break ;;
    --set | --steps | --timing | --time-limit | --restart | --extend-to) value_of "$@"; program_options+=("$1" "$2"); shift 2 ;;
    -*) program_options+=("$1"); shift ;;
    *.toml)
      [[ -z $deck ]] || die "expected one deck, found $deck and $1"
      deck=$1
      shift
      ;;
    run | check | mesh | search | report) die "the command $1 must be the first argument" ;;
    *) # the value of an option of the program, or a deck without the suffix .toml
      if [[ ${#program_options[@]} -gt 0 ]]; then
        program_options+=("$1")
      elif [[ -z $deck && -f $1 ]]; then
        deck=$1
      else
        die "found \"$1\", expected run, check, mesh, search, report, an option or the path of a deck"
      fi
      shift
      ;;
  esac
done
if [[ $wants_help == yes ]]; then
  [[ -z $study ]] || exec /usr/bin/python3 "${driver[@]}" --help
  usage
  exit 0
fi
if [[ -n $study ]]; then
  [[ -z $deck ]] || die "a study takes no deck, found $deck"
else
  positive -n "${ranks:=1}"
  if [[ -n $threads ]]; then positive -t "$threads"; else positive OMP_NUM_THREADS "${OMP_NUM_THREADS:-1}"; fi
  [[ -z $deck || -e $deck ]] || die "$deck: found no such deck"
fi

if [[ -z $program ]]; then
  "$root/cmake/setup.sh" --preset "$preset" --target brickwall
  build=$root/build
  [[ $preset == default ]] || build=$root/build-$preset
  program=$build/miniapp/brickwall
else
  [[ -f $program && -x $program ]] || die "--program: found no program \"$program\"; ./run.sh without --program builds it"
  build=$(cd "$(dirname "$program")/.." && pwd)
fi
if [[ -n $study ]]; then
  study_options=(--program "$(realpath "$program")")
  [[ $study == *.toml ]] || study_options+=(--run-sh "$root/run.sh")
  [[ -z $ranks ]] || study_options+=(-n "$ranks")
  [[ -z $threads ]] || study_options+=(-t "$threads")
  [[ -z $output ]] || study_options+=(-o "$output")
  export BRICKWALL_OVERSUBSCRIBE=$oversubscribe
  exec /usr/bin/python3 "${driver[@]}" "${study_options[@]}" ${program_options[@]+"${program_options[@]}"}
fi
deck=${deck:-$root/inputs/brick_wall.toml}
name=$(basename "$deck")
name=${name%.*}
output=${output:-out/$name}
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt" 2>/dev/null || true; }

# Each rank gets its share of the physical cores.
cores=$(lscpu -p=CORE,SOCKET 2>/dev/null | grep -v '^#' | sort -u | wc -l || true)
usable=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)
[[ $cores -ge 1 && $cores -le $usable ]] || cores=$usable
threads=${threads:-${OMP_NUM_THREADS:-$((cores > ranks ? cores / ranks : 1))}}
if [[ -z ${BRICKWALL_MPIEXEC:-} && $ranks -gt $((8 * cores)) && $oversubscribe == no ]]; then
  die "$ranks ranks are more than 8 for each of the $(counted "$cores" core); --oversubscribe runs them all the same"
elif [[ -z ${BRICKWALL_MPIEXEC:-} && $ranks -gt $cores ]]; then
  echo "run.sh: warning: $ranks ranks share $(counted "$cores" core); times are not representative" >&2
fi
export OMP_NUM_THREADS=$threads

# usual NAME=VALUE...: exports variables; those that the user has set stay.
usual() {
  local assignment
  for assignment in "$@"; do
    [[ -v ${assignment%%=*} ]] || export "${assignment?}"
  done
}
# Open MPI may run as root and with more ranks than cores; if the program ends with an exit code, it
# prints nothing and does not wait two seconds.
usual OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 PRTE_ALLOW_RUN_AS_ROOT=1 PRTE_ALLOW_RUN_AS_ROOT_CONFIRM=1
usual OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
usual OMPI_MCA_orte_execute_quiet=1 OMPI_MCA_odls_base_sigkill_timeout=0
usual OMPI_MCA_hwloc_base_binding_policy=none PRTE_MCA_hwloc_default_binding_policy=none
# Ranks that bind their threads themselves would all take the same first cores.
if [[ $ranks -eq 1 && $threads -le $cores ]]; then bind=close; else bind=false; fi
usual OMP_PROC_BIND=$bind OMP_PLACES=cores
if [[ $((ranks * threads)) -gt $cores ]]; then
  usual OMP_WAIT_POLICY=passive OMPI_MCA_mpi_yield_when_idle=1 KOKKOS_DISABLE_WARNINGS=1
fi
if [[ ${BRICKWALL_MPIEXEC:-} == *[![:space:]]* ]]; then
  words=$(xargs -n 1 printf '%s\n' <<<"$BRICKWALL_MPIEXEC") || die "BRICKWALL_MPIEXEC: found no words in $BRICKWALL_MPIEXEC"
  mapfile -t launcher <<<"$words"
else
  launcher=("$(cached MPIEXEC_EXECUTABLE)")
  [[ -n ${launcher[0]} ]] || launcher=(mpiexec)
fi

# Prints the program's output, and keeps its FOM and PASS, FAIL or STOPPED lines to print them last.
summary=()
hold_summary() {
  local line
  while IFS= read -r line || [[ -n $line ]]; do
    case $line in
      "FOM "* | PASS* | FAIL* | STOPPED*) summary+=("$line") ;;
      *) printf '%s\n' "$line" ;;
    esac
  done
}
# The joined file, and the rank file that rank 0 of this run writes.
joined=$output/$name.exo
first=$(printf '%s.%d.%0*d' "$joined" "$ranks" "${#ranks}" 0)
# The first signal reaches all ranks as SIGUSR2, since a launcher that gets SIGTERM leaves them no time:
# the run ends after its step. A second one, and the first one to another command, ends it at once.
signal=
end_run() {
  [[ -z $signal && $command == run ]] || interrupted "$1"
  signal=SIG$(kill -l "$1")
  echo "run.sh: the run ends after this step; a second signal ends it at once" >&2
  kill -USR2 "${!:-}" 2>/dev/null || true
}
# A run that ends at once may leave rank files of different lengths, which are not joined.
interrupted() {
  trap - INT TERM HUP USR2
  kill -TERM "$!" 2>/dev/null || true
  wait "$!" 2>/dev/null || true
  if [[ $ranks -gt 1 && $first -nt $started ]]; then
    local epu
    epu=$(find_epu)
    echo "run.sh: interrupted; the rank files are not joined. To join what they contain:" >&2
    echo "  cd '$output' && '${epu:-epu}' -auto '$(basename "$first")'" >&2
  fi
  exit "$1"
}
find_epu() {
  local epu
  epu=$(cached BRICKWALL_EPU)
  [[ -x $epu ]] || epu=$(command -v epu || true)
  echo "$epu"
}
# A launcher stands between the program and the terminal.
if [[ -t 2 && ${TERM:-dumb} != dumb ]]; then export BRICKWALL_LIVE=1; else unset BRICKWALL_LIVE; fi
started=$(mktemp) # older files belong to earlier runs
trap 'rm -f "$started"' EXIT
trap 'end_run 143' TERM
trap 'end_run 130' INT
trap 'end_run 129' HUP
trap 'end_run 140' USR2
[[ $command != run ]] || trap 'kill -USR1 "${!:-}" 2>/dev/null || true' USR1
# In a session of its own, the launcher does not get the terminal's Ctrl-C too.
hold_summary < <(
  exec setsid "${launcher[@]}" -n "$ranks" "$program" "$command" "$deck" -o "$output" ${program_options[@]+"${program_options[@]}"}
)
# A signal interrupts the wait.
while code=0; wait "$!" || code=$?; kill -0 "$!" 2>/dev/null; do :; done
trap - INT TERM HUP USR1 USR2
# The launcher is quiet, so this is the only message about a crash.
if [[ $code -ge 128 ]]; then
  echo "run.sh: signal $((code - 128)) ended $program" >&2
  if [[ -n $(find "$output/checkpoints" -newer "$started" 2>/dev/null) ]]; then
    echo "run.sh: --restart latest continues the run from its last checkpoint" >&2
  fi
fi

# Removes rank files of earlier runs with another number of ranks (NAME.4.0 to NAME.4.3, NAME.12.00
# to NAME.12.11), and joins those of this run.
join_rank_files() {
  local epu other numbers
  for other in "$joined".*; do
    numbers=${other#"$joined".}
    [[ $numbers =~ ^([1-9][0-9]*)\.([0-9]+)$ && ${BASH_REMATCH[1]} -ne $ranks && ${BASH_REMATCH[1]} -gt 1 ]] || continue
    [[ ${#BASH_REMATCH[2]} -eq ${#BASH_REMATCH[1]} && 10#${BASH_REMATCH[2]} -lt ${BASH_REMATCH[1]} ]] && rm -f "$other"
  done
  [[ $ranks -gt 1 ]] || return 0
  epu=$(find_epu)
  if [[ -z $epu ]]; then
    echo "run.sh: epu was not found; the rank files $joined.$ranks.* are not joined"
    return 1
  fi
  rm -f "$joined"
  if ! (cd "$output" && "$epu" -auto "$(basename "$first")") >"$output/epu.log" 2>&1; then
    echo "run.sh: epu could not join $joined.$ranks.*; see $output/epu.log" >&2
    return 1
  fi
  echo "joined   $joined"
}
draw() {
  local text
  if text=$("$root/miniapp/plot/brickwall-plot" "$joined" --output "$output/$name.png" 2>&1); then
    echo "picture  $output/$name.png"
  else
    echo "run.sh: no picture: $(tail -n 1 <<<"$text")"
  fi
}
if [[ $writes == yes && $code != 2 ]] && [[ $command == run || $command == mesh ]]; then
  if [[ $ranks -eq 1 && $joined -nt $started ]] || [[ $ranks -gt 1 && $first -nt $started ]]; then
    if join_rank_files; then
      [[ $picture == yes && $command == run ]] && draw
    else
      [[ $code -ne 0 ]] || code=1
    fi
  fi
fi
# The program was sent SIGUSR2; the user sent another one.
[[ ${#summary[@]} -eq 0 ]] || printf '%s\n' "${summary[@]/#STOPPED: ended by SIGUSR2/STOPPED: ended by ${signal:-SIGUSR2}}"
exit "$code"
