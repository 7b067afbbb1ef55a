#!/usr/bin/env bash
# The deck of README.md is complete, has at most 20 lines and runs without a warning.
#
# Usage: readme_deck.sh README BRICKWALL
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OMP_NUM_THREADS=1
sed -n '/^```toml$/,/^```$/{/^```/d; p}' "$1" >"$work/wall.toml"
[[ $(wc -l <"$work/wall.toml") -le 20 ]] || { echo "FAILED: the deck has more than 20 lines"; exit 1; }
"$2" run "$work/wall.toml" -o "$work/out" | tee "$work/log"
! grep '^warning:' "$work/log" || { echo "FAILED: the deck causes a warning"; exit 1; }
[[ $(tail -n 1 "$work/log") == PASS && -s $work/out/wall.exo ]] || { echo "FAILED: no PASS or no results"; exit 1; }
