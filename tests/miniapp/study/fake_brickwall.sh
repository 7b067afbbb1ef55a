#!/bin/bash
# Stands for the program: brickwall COMMAND DECK -o FOLDER ... writes the kept report. $FAKE/calls gets a line for each run;
# check refuses bad.key.
# $FAKE/stop_at N ends the study that started it by SIGTERM in the Nth call; FAKE=... --set fake.fail=true fails.
here=$(dirname "$(realpath "$0")")
command=$1 folder=$4
case "$*" in
  check*bad.key*) echo "brickwall: error: --set bad.key: found unknown key" >&2; exit 2 ;;
  check*wall.bricks*) # 100 MB and 50 MB for each brick along, 20 MB of these 50 on the device
    bricks=$(sed "s/.*wall.bricks=.//; s/,.*//" <<<"$*")
    echo "  memory            $((100 + 50 * bricks)) MB per rank on 1 rank, of which $((20 * bricks)) MB on the device"
    exit 0 ;;
  check*) exit 0 ;;
esac
echo "$*" >>"$FAKE/calls"
if [[ "$(wc -l <"$FAKE/calls")" == "$(cat "$FAKE/stop_at" 2>/dev/null)" ]]; then
  kill -TERM "$PPID"
  sleep 60
fi
case "$*" in
  *fake.fail=true*) echo "brickwall: error: it broke" >&2; exit 3 ;;
  *fake.hang=true*) sleep 60 ;;
  *fake.torn=true*) head -c 300 "$here/report.json" >"$folder/report.json"; exit 0 ;;
esac
file=report.json
[[ $command == run ]] || file=search.json
cp "$here/$file" "$folder/$file"
touch "$folder/deck.exo"
