#!/usr/bin/env bash
# The same deck on several rank and thread counts gives the same files: joined by epu, compared by exodiff at tolerance 0
# with the 1-rank file, and history.csv compared byte for byte.
#
# Usage: same_bits.sh BRICKWALL MPIEXEC EPU EXODIFF DECK STEPS "RANKSxTHREADS ..." [program options]
set -euo pipefail
brickwall=$1 mpiexec=$2 epu=$3 exodiff=$4 deck=$5 steps=$6 layouts=$7
shift 7
name=$(basename "$deck" .toml)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

run() { # ranks threads folder
  OMP_NUM_THREADS=$2 "$mpiexec" -n "$1" --oversubscribe "$brickwall" run "$deck" -o "$3" --steps "$steps" \
    "${@:4}" >"$work/log" 2>&1 || { cat "$work/log"; echo "$1 ranks x $2 threads: the run failed"; exit 1; }
}

run 1 1 "$work/reference" "$@"
for layout in $layouts; do
  ranks=${layout%x*} threads=${layout#*x}
  folder=$work/$layout
  run "$ranks" "$threads" "$folder" "$@"
  if [[ $ranks -gt 1 ]]; then
    (cd "$folder" && "$epu" -auto "$name.exo.$ranks.$(printf "%0${#ranks}d" 0)" >epu.log 2>&1) ||
      { cat "$folder/epu.log"; echo "$layout: epu failed"; exit 1; }
  fi
  "$exodiff" -tolerance 0 -Floor 0 "$work/reference/$name.exo" "$folder/$name.exo" >"$folder/exodiff.log" 2>&1 ||
    { tail -n 40 "$folder/exodiff.log"; echo "$layout: the files differ"; exit 1; }
  cmp "$work/reference/history.csv" "$folder/history.csv" || { echo "$layout: history.csv differs"; exit 1; }
  echo "$layout: identical"
done
