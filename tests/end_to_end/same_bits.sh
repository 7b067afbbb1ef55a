#!/usr/bin/env bash
# Runs a deck on several numbers of ranks and threads and compares the files with those of one rank:
# Exodus files are joined by epu and compared by exodiff at tolerance 0, history.csv byte by byte. A
# layout "3x1+MARGIN" sets a margin: the column `searches` must show that lists were kept and
# rebuilt, and all other columns must be equal. An audit (search.audit) must find no missed pair.
#
# Usage: same_bits.sh BRICKWALL MPIEXEC EPU EXODIFF DECK STEPS "RANKSxTHREADS[+MARGIN] ..." [program
# options]
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

column() { # prints a column of a folder's history.csv, nothing without it: folder name
  awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name) column = i } NR > 1 && column { print $column }' \
    "$1/history.csv"
}
other_columns() { # folder
  awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "searches") column = i } { $column = ""; print }' \
    "$1/history.csv"
}
printf '%s\n' 'DEFAULT TOLERANCE relative 0.0 floor 0.0' 'COORDINATES absolute 0.0' 'TIME STEPS relative 0.0' \
  'GLOBAL VARIABLES (all)' $'\t!searches' 'NODAL VARIABLES (all)' 'ELEMENT VARIABLES (all)' >"$work/all_but_searches"

run 1 1 "$work/reference" "$@"
missed=$(column "$work/reference" missed_pairs | tail -n 1)
[[ -z $missed || $missed == 0 ]] || { echo "the audit found $missed missed pairs"; exit 1; }
for layout in $layouts; do
  size=${layout%+*} margin=
  [[ $layout == *+* ]] && margin=${layout#*+}
  ranks=${size%x*} threads=${size#*x}
  folder=$work/$layout
  run "$ranks" "$threads" "$folder" "$@" ${margin:+--set search.reuse.margin=$margin}
  if [[ $ranks -gt 1 ]]; then
    (cd "$folder" && "$epu" -auto "$name.exo.$ranks.$(printf "%0${#ranks}d" 0)" >epu.log 2>&1) ||
      { cat "$folder/epu.log"; echo "$layout: epu failed"; exit 1; }
  fi
  how=(-tolerance 0 -Floor 0)
  [[ -n $margin ]] && how=(-f "$work/all_but_searches")
  "$exodiff" "${how[@]}" "$work/reference/$name.exo" "$folder/$name.exo" >"$folder/exodiff.log" 2>&1 ||
    { tail -n 40 "$folder/exodiff.log"; echo "$layout: the files differ"; exit 1; }
  if [[ -n $margin ]]; then
    cmp <(other_columns "$work/reference") <(other_columns "$folder") || { echo "$layout: history.csv differs"; exit 1; }
    made=$(column "$folder" searches | tail -n 1)
    [[ $made -gt 1 && $made -lt $((steps / 2)) ]] || { echo "$layout: $made searches in $steps steps"; exit 1; }
    echo "$layout: identical, with $made searches"
  else
    cmp "$work/reference/history.csv" "$folder/history.csv" || { echo "$layout: history.csv differs"; exit 1; }
    echo "$layout: identical"
  fi
done
