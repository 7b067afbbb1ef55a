#!/usr/bin/env bash
# Sets up and builds Brickwall, runs it on a deck, joins the rank files and draws the picture.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

usage() {
  cat <<'TEXT'
./run.sh [run|check|mesh|search] [DECK] [-n RANKS] [-t THREADS] [-o DIR] [further options]
./run.sh --study NAME [-n RANKS,...] [-t THREADS,...] [-o DIR] [options of the study]

  run       (default) runs the deck: Exodus results joined to one file, picture, history.csv, report.json
  check     reads the deck and says what the scene will model; runs nothing
  mesh      writes the Exodus mesh only
  search    runs the contact search alone on the wall's surface: search.json

  DECK                default inputs/brick_wall.toml
  -n, --ranks N       MPI ranks (default 1)
  -t, --threads N     threads of each rank (default: the physical cores, divided by the ranks)
  -o, --output DIR    output folder (default out/<deck name>/)
  -h, --help          this text (behind --study NAME: that of the study)
  --preset NAME       preset of CMakePresets.json to build and run (default "default")
  --program FILE      run this program as it is; no set-up, no build
  --no-picture        draw nothing
  --                  everything behind it goes to the program as it is

Studies are many runs; they leave tables and plots in their folder (default out/study_NAME/):
  --study paper       the search over sizes, methods, ranks and threads: the paper's Figs. 8 to 11
                      (--sizes 2,8 --repetitions 5 --methods paper,cluster and more; verification/performance/README.md)
  --study verification  cases with exact or published answers: a line a case, PASS or FAIL (--only V7,V8 --quick;
                      verification/README.md)
  --study stability   the hard cases, likewise
  --study accuracy    speed against error: a wall and exact cases over meshes and settings (--quick;
                      verification/accuracy/README.md)
  --study same-bits   the default wall on many ranks and threads, with kept lists and without: the same bits (--quick)
  --study savings     what scenes do not need, put back part by part: the same bits, and what leaving it out saves (--quick)

Further options go to the program, among them:
  --set BLOCK.KEY=VALUE   overrides a value of the deck (may be repeated)
  --steps N               stops after N steps
  --no-output             writes no file
  --timing paper          parts waits from work in the phases of the search
  --kokkos-...            go to Kokkos
The program's own help: build/miniapp/brickwall -h

Exit codes: 0 pass; 1 error; 2 bad deck or command line; 3 physical failure; 4 output failed.

Environment: BRICKWALL_CACHE (folder of the built dependencies, default ~/.cache/brickwall), Kokkos_ROOT, Kokkos_DIR,
CMAKE_PREFIX_PATH (dependencies of your own; nothing is then downloaded), BRICKWALL_MPIEXEC (launcher with its
options, "-n RANKS" is appended; default: the mpiexec of the build).
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
writes=yes
program_options=()
study=
wants_help=no

# The driver of a study and what it is told first. More studies: more lines here.
choose_study() {
  study=$1
  case $1 in
    paper) driver=("$root/verification/performance/paper/paper_study.py") ;;
    verification | stability) driver=("$root/verification/verify.py" "$1") ;;
    accuracy) driver=("$root/verification/accuracy/accuracy_study.py") ;;
    same-bits) driver=("$root/verification/same_bits.py") ;;
    savings) driver=("$root/verification/savings.py") ;;
    *) die "no study \"$1\"; there are: paper, verification, stability, accuracy, same-bits, savings" ;;
  esac
}
positive() { [[ $2 =~ ^[1-9][0-9]*$ ]] || die "$1 needs a positive number, not \"$2\""; }
value_of() {
  [[ $# -ge 2 && -n $2 ]] || die "$1 needs a value"
  [[ ! $2 =~ ^-[^0-9] ]] || die "$1 needs a value; behind it stands the option $2"
}

case ${1:-} in run | check | mesh | search) command=$1; shift ;; esac
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) wants_help=yes; shift ;;
    --study) value_of "$@"; choose_study "$2"; shift 2 ;;
    --study=*) choose_study "${1#*=}"; shift ;;
    -n | --ranks) value_of "$@"; ranks=$2; shift 2 ;;
    -t | --threads) value_of "$@"; threads=$2; shift 2 ;;
    -o | --output) value_of "$@"; output=$2; shift 2 ;;
    --ranks=* | --threads=* | --output=*) # as in two words
      value_of "${1%%=*}" "${1#*=}"
      set -- "${1%%=*}" "${1#*=}" "${@:2}"
      ;;
    --preset) value_of "$@"; preset=$2; shift 2 ;;
    --program) value_of "$@"; program=$2; shift 2 ;;
    --no-picture) picture=no; shift ;;
    --no-output) writes=no; program_options+=("$1"); shift ;;
    --) shift; program_options+=("$@"); break ;;
    --set | --steps | --timing) value_of "$@"; program_options+=("$1" "$2"); shift 2 ;;
    -*) program_options+=("$1"); shift ;;
    *.toml)
      [[ -z $deck ]] || die "two decks: $deck and $1"
      deck=$1
      shift
      ;;
    run | check | mesh | search) die "the subcommand stands first" ;;
    *) # the value of a program's option that is not listed here, or a deck of another suffix
      if [[ -z $deck && -f $1 && ${#program_options[@]} -eq 0 ]]; then deck=$1; else program_options+=("$1"); fi
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
  [[ -z $deck ]] || die "a study has decks of its own, found $deck"
else
  positive -n "${ranks:=1}"
fi

if [[ -z $program ]]; then
  "$root/cmake/setup.sh" --preset "$preset" --target brickwall
  build=$root/build
  [[ $preset == default ]] || build=$root/build-$preset
  program=$build/miniapp/brickwall
else
  build=$(cd "$(dirname "$program")/.." && pwd)
fi
if [[ -n $study ]]; then
  study_options=(--run-sh "$root/run.sh" --program "$(realpath "$program")")
  [[ -z $ranks ]] || study_options+=(-n "$ranks")
  [[ -z $threads ]] || study_options+=(-t "$threads")
  [[ -z $output ]] || study_options+=(-o "$output")
  exec /usr/bin/python3 "${driver[@]}" "${study_options[@]}" ${program_options[@]+"${program_options[@]}"}
fi
deck=${deck:-$root/inputs/brick_wall.toml}
name=$(basename "$deck")
name=${name%.*}
output=${output:-out/$name}
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt" 2>/dev/null || true; }

# Threads: this process' share of the physical cores.
cores=$(lscpu -p=CORE,SOCKET 2>/dev/null | grep -v '^#' | sort -u | wc -l || true)
usable=$(nproc)
[[ $cores -ge 1 && $cores -le $usable ]] || cores=$usable
if [[ -z $threads ]]; then
  threads=$((cores / ranks))
  [[ $threads -ge 1 ]] || threads=1
fi
positive -t "$threads"
export OMP_NUM_THREADS=$threads

# Open MPI: allowed as root and with more ranks than cores, and quiet when the program ends with an exit code.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 PRTE_ALLOW_RUN_AS_ROOT=1 PRTE_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
export OMPI_MCA_orte_execute_quiet=1
export OMPI_MCA_hwloc_base_binding_policy=none PRTE_MCA_hwloc_default_binding_policy=none
if [[ $ranks -eq 1 && $threads -le $cores ]]; then
  export OMP_PROC_BIND=${OMP_PROC_BIND:-close} OMP_PLACES=${OMP_PLACES:-cores}
else
  # Ranks that bind by themselves would all take the same first cores.
  export OMP_PROC_BIND=${OMP_PROC_BIND:-false} OMP_PLACES=${OMP_PLACES:-cores}
fi
if [[ $((ranks * threads)) -gt $cores ]]; then
  export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive} OMPI_MCA_mpi_yield_when_idle=1 KOKKOS_DISABLE_WARNINGS=1
fi
if [[ -n ${BRICKWALL_MPIEXEC:-} ]]; then
  read -r -a launcher <<<"$BRICKWALL_MPIEXEC"
else
  launcher=("$(cached MPIEXEC_EXECUTABLE)")
  [[ -n ${launcher[0]} ]] || launcher=(mpiexec)
fi

# The program's output passes through; its FOM and PASS or FAIL lines are held back, so that they stand last.
summary=()
hold_summary() {
  local line
  while IFS= read -r line || [[ -n $line ]]; do
    case $line in
      "FOM "* | PASS* | FAIL*) summary+=("$line") ;;
      *) printf '%s\n' "$line" ;;
    esac
  done
}
# One file from the rank files, named as rank 0 of this run names its own.
joined=$output/$name.exo
first=$(printf '%s.%d.%0*d' "$joined" "$ranks" "${#ranks}" 0)
# A run that is cut short may leave rank files of different lengths: they are not joined, but told of.
interrupted() {
  trap - INT TERM
  kill -TERM "$!" 2>/dev/null || true
  wait "$!" 2>/dev/null || true
  if [[ $ranks -gt 1 && $first -nt $started ]]; then
    local epu
    epu=$(find_epu)
    echo "run.sh: interrupted; the rank files are not joined. To join what they hold:" >&2
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
started=$(mktemp) # what is older is not of this run
trap 'rm -f "$started"' EXIT
# A kill of this script ends the launcher too, and the launcher its ranks.
trap 'interrupted 143' TERM
trap 'interrupted 130' INT
code=0
hold_summary < <(
  exec "${launcher[@]}" -n "$ranks" "$program" "$command" "$deck" -o "$output" ${program_options[@]+"${program_options[@]}"}
)
wait "$!" || code=$?
trap - INT TERM
# mpiexec was told to be quiet, so this is the only word about a crash.
[[ $code -lt 128 ]] || echo "run.sh: $program ended by signal $((code - 128))" >&2

# Rank files of an earlier run with another number of ranks go away.
join_rank_files() {
  local epu other
  for other in "$joined".[0-9]*.0*; do
    [[ -e $other && ${other%.*} != "$joined.$ranks" ]] && rm -f "${other%.*}".[0-9]*
  done
  [[ $ranks -gt 1 ]] || return 0
  epu=$(find_epu)
  if [[ -z $epu ]]; then
    echo "run.sh: no epu found; the rank files $joined.$ranks.* are not joined"
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
  local python=/usr/bin/python3 text
  if ! "$python" -c 'import netCDF4, matplotlib' 2>/dev/null; then
    echo "run.sh: no picture: $python lacks the modules netCDF4 and matplotlib"
  elif text=$("$python" "$root/miniapp/render_wall.py" "$joined" --output "$output/$name.png" 2>&1); then
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
[[ ${#summary[@]} -eq 0 ]] || printf '%s\n' "${summary[@]}"
exit "$code"
