#!/usr/bin/env bash
# Tests how runs end, on 1 and 3 ranks: exit codes, messages and files. Each run has a time limit,
# since none may hang.
#
# Usage: endings.sh BRICKWALL MPIEXEC INPUTS_FOLDER
set -euo pipefail
brickwall=$1 mpiexec=$2 inputs=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OMP_NUM_THREADS=1 OMPI_MCA_orte_execute_quiet=1
failures=0

# The program with files limited to 64 KiB, for which the disk is full beyond that size.
limited=$work/limited.sh
printf '#!/bin/bash\nulimit -f 64\ntrap "" XFSZ\nexec "%s" "$@"\n' "$brickwall" >"$limited"
chmod +x "$limited"

program=$brickwall
output=$work/out

# expect NAME CODE PATTERN RANKS arguments...: runs $program and checks the exit code and that its
# output matches the pattern. Standard error is kept apart: mpiexec may mix both within a line.
expect() {
  local name=$1 code=$2 pattern=$3 ranks=$4 found=0
  shift 4
  timeout 120 "$mpiexec" -n "$ranks" --oversubscribe "$program" "$@" -o "$output" >"$work/log" 2>"$work/errors" || found=$?
  cat "$work/errors" >>"$work/log"
  if [[ $found -ne $code ]]; then
    echo "FAILED $name on $ranks ranks: exit code $found, expected $code"; tail -n 5 "$work/log"; failures=$((failures + 1))
  elif ! grep -Eq "$pattern" "$work/log"; then
    echo "FAILED $name on $ranks ranks: no line matches '$pattern'"; tail -n 5 "$work/log"; failures=$((failures + 1))
  else
    echo "ok $name on $ranks ranks"
  fi
}

# The second brick is rotated by a quarter turn and crosses the first one at the same height: all
# nodes of each are outside the other or on its sides.
crossing=(--set 'wall.brick=[4,1,1]' --set 'wall.elements=[4,1,1]' --set 'initial.deformation[0].brick=[1,0,0]'
  --set 'initial.deformation[0].gradient=[-1,-1,0,1,-1,0,0,0,0]' --set 'initial.deformation[0].center=[4,-1.5,0]')
# Steps much shorter than the stable ones make contact stiff.
struck=(--set time.safety=0.001 --set 'initial.velocity[0].velocity=[0.1,0,0]')
small=(--set 'wall.bricks=[2,1,2]' --set 'wall.elements=[2,1,1]')
for ranks in 1 3; do
  expect "a small wall passes" 0 '^PASS' $ranks run "$inputs/brick_wall.toml" "${small[@]}" --steps 20
  expect "an inverted element is named with place, time and step" 3 'element [0-9]+ .*at \(.*step|step .*element [0-9]+ .*at \(' \
    $ranks run "$inputs/one_brick.toml" --set 'load.pressure[0].peak=1e11' --set limits.energy_error=1e9
  [[ $(grep -c 'the computation broke down' "$work/log") -eq 1 ]] || { echo "FAILED: the reason is not printed once"; failures=$((failures + 1)); }
  [[ -s $work/out/one_brick.exo || -s $work/out/one_brick.exo.3.0 ]] || { echo "FAILED: no results left"; failures=$((failures + 1)); }
  grep -q '"pass": false' "$work/out/report.json" || { echo "FAILED: report.json does not say pass: false"; failures=$((failures + 1)); }
  expect "a load beyond all range stops the start" 3 'in step 0 .*nodal forces of .*load.pressure' $ranks run "$inputs/one_brick.toml" \
    --set 'load.pressure[0].shape="step"' --set 'load.pressure[0].peak=1e30'
  # The mesh has the place of the results: of those of a rank, or where epu would join those of several.
  output=$work/own_mesh
  expect "a mesh is written" 0 ' 1 body$' 1 mesh "$inputs/one_brick.toml"
  cp "$output/one_brick.exo" "$work/mesh.exo"
  names=(one_brick.exo)
  [[ $ranks -eq 1 ]] || names+=("one_brick.exo.$ranks.1")
  for name in "${names[@]}"; do
    cp "$work/mesh.exo" "$output/$name"
    sed -e '/^\[wall\]/,/^$/d' "$inputs/one_brick.toml" >"$work/one_brick.toml"
    printf '\n[mesh]\nfile = "own_mesh/%s"\n' "$name" >>"$work/one_brick.toml"
    for command in run mesh; do
      expect "$command does not replace the mesh $name that it reads" 2 "$name: found the file that the results would replace" \
        $ranks $command "$work/one_brick.toml"
    done
    cmp "$output/$name" "$work/mesh.exo" || { echo "FAILED: the mesh was changed"; failures=$((failures + 1)); }
  done
  output=$work/out
  expect "a run warns of units that do not fit together" 0 '^warning: material.brick has the wave speed .* suggests mm and s: ' $ranks \
    run "$inputs/one_brick.toml" --set 'gravity.acceleration=[0,0,-9810]' --steps 2
  [[ $(grep -c 'suggests mm and s' "$work/log") -eq 1 ]] || { echo "FAILED: the warning is not printed once"; failures=$((failures + 1)); }
  expect "the energy limit stops the run" 3 'limits.energy_error' $ranks run "$inputs/brick_wall.toml" "${small[@]}" \
    --set limits.energy_error=1e-14 --steps 200
  expect "a warning is printed and the run passes" 0 'warning: energy error .* exceeds limits.warn.energy_error' $ranks run "$inputs/brick_wall.toml" \
    "${small[@]}" --set limits.warn.energy_error=1e-14 --steps 200
  grep -q 'exceeds limits.warn.energy_error' "$work/out/report.json" || { echo "FAILED: report.json lacks the warning"; failures=$((failures + 1)); }
  expect "a deep contact stops the run where that is a limit" 3 'penetration .* exceeds limits.penetration' $ranks run "$inputs/two_bars.toml" \
    --set limits.penetration=1e-4 --set contact.edges=false
  expect "an audit of the search finds nothing" 0 'audit: 0 pairs missed' $ranks run "$inputs/brick_wall.toml" "${small[@]}" --set search.audit=3 \
    --set search.reuse.margin=0.2 --steps 20
  grep -q '^step,.*missed_pairs' "$work/out/history.csv" || { echo "FAILED: history.csv lacks missed_pairs"; failures=$((failures + 1)); }
  expect "a brick that is too fast for contact stops the run" 3 '(node|an edge of face) [0-9]+ .*of body [0-9]+ moves by .* against (face|an edge of face) [0-9]+ .*of body [0-9]+' \
    $ranks run "$inputs/two_bars.toml" --set 'wall.gap=0.05' --set 'initial.velocity[0].velocity=[0.5,0,0]' --set 'contact.guard="stop"'
  expect "an error on contact forces beyond their range names bodies and a cure" 3 \
    'the largest, [0-9.e+]+, is that of (node|an edge of face) [0-9]+ .*of body [0-9]+ \(brick \[.* and (face|an edge of face) [0-9]+ .*of body [0-9]+ \(brick \[.*contact\.penalty = 0\.0' \
    $ranks run "$inputs/two_bars.toml" "${struck[@]}"
  expect "the suggested penalty works" 0 '^PASS' $ranks run "$inputs/two_bars.toml" "${struck[@]}" --set contact.penalty=0.01 --steps 2000
  expect "a step that is cut for contact is reported" 0 'time step: .* for tunnelling' $ranks run "$inputs/two_bars.toml" --set 'wall.gap=0.05' \
    --set 'initial.velocity[0].velocity=[0.2,0,0]' --steps 100
  expect "an unknown set is named with the nearest one" 2 "front" $ranks run "$inputs/brick_wall.toml" "${small[@]}" \
    --set 'load.pressure[0].side_set="frnt"'
  expect "a missing material is named" 2 'material' $ranks run "$inputs/brick_wall.toml" "${small[@]}" --set 'material.brick.density=-1'
  expect "a missing deck is one error" 2 'nowhere.toml' $ranks run "$work/nowhere.toml"
  if grep -q Kokkos "$work/log"; then echo "FAILED: Kokkos starts before the deck is judged"; failures=$((failures + 1)); fi
  expect "bodies that overlap beyond the reach of contact are refused" 2 \
    'node [0-9]+ .*of body 0 \(brick \[0, 0, 0\]: course 0, .*\) is 0\.04 deep in body 1 \(.*\), .*no more than 0\.025, 2 contact\.tolerance' $ranks run "$here/overlapping_cubes.toml"
  expect "flush crossing bars without penetrating nodes are refused" 2 \
    'element 1 .*of body 0 .*\(1\.5, 0\.5, 0\.5\), and element 5 .*of body 1 \(brick \[1, 0, 0\]: .* overlap by 0\.5' \
    $ranks run "$here/overlapping_cubes.toml" "${crossing[@]}"
  expect "check refuses them too" 2 'element 1 .*of body 0 .* and element 5 .*of body 1 .* overlap by 0\.5' \
    $ranks check "$here/overlapping_cubes.toml" "${crossing[@]}"
  expect "a shallow overlap runs" 0 '^PASS' $ranks run "$here/overlapping_cubes.toml" --set contact.tolerance=0.09 --steps 20
  expect "a former name of a block is accepted with a warning" 0 '^warning: --set spare.lattices=false: \[spare\] is the former name of \[skip\]' \
    $ranks run "$inputs/one_brick.toml" --set spare.lattices=false --steps 5
  grep -q 'is the former name of \[skip\]' "$work/out/report.json" || { echo "FAILED: report.json lacks the warning"; failures=$((failures + 1)); }
  expect "one element runs" 0 '^PASS' $ranks run "$inputs/one_brick.toml" --set 'wall.elements=[1,1,1]' --steps 20
  expect "no contact at all runs" 0 '^PASS' $ranks run "$inputs/brick_wall.toml" "${small[@]}" --set contact.enabled=false --steps 20
  expect "a nearly incompressible wall runs, though its forces are coarse" 0 '^PASS' $ranks run "$inputs/brick_wall.toml" "${small[@]}" \
    --set material.brick.poissons_ratio=0.499999 --set 'load.pressure[0].wave_speed=0' --steps 30
  expect "the search alone runs" 0 '^PASS' $ranks search "$inputs/wall_17k.toml" --set search.repetitions=2
  expect "the search command searches each time by default" 0 'FOM face_searches_per_second=[1-9]' $ranks \
    search "$inputs/two_bars.toml"
  expect "the reference search alone runs" 0 '^PASS' $ranks search "$inputs/brick_wall.toml" "${small[@]}" --set 'search.method="reference"'
  output=/dev/null/x
  expect "an output folder that cannot be made fails" 4 '/dev/null/x' $ranks run "$inputs/brick_wall.toml" "${small[@]}" --steps 2
  output=$work/$(printf 'a%.0s' {1..300})
  expect "an output folder whose name is too long fails" 4 'cannot make the output folder: File name too long' $ranks \
    run "$inputs/brick_wall.toml" "${small[@]}" --steps 2
  output=$work/out program=$limited
  expect "a full disk is found in its step" 4 'brick_wall.exo' $ranks run "$inputs/brick_wall.toml" "${small[@]}" \
    --set 'wall.elements=[8,4,4]' --set output.interval=1e-6 --steps 200
  [[ ! -e $work/out/report.json ]] || { echo "FAILED: a report of an earlier run is left"; failures=$((failures + 1)); }
  program=$brickwall
  rm -rf "$work/out"
done
expect "a check warns of more elements than a rank can number" 0 'too many for 32-bit numbers; a run needs at least 2 ranks' \
  1 check "$inputs/brick_wall.toml" --set 'wall.bricks=[1500,1,1500]'
expect "a check of a large wall warns that it looks for no overlaps" 0 'overlaps due to initial.deformation are not looked for' \
  1 check "$here/overlapping_cubes.toml" --set 'wall.bricks=[4000,1,1]'
expect "an option that Kokkos does not know is named" 2 'does not know --kokkos-foo=1' 1 check "$inputs/brick_wall.toml" --kokkos-foo=1
expect "a search warns that it audits nothing" 0 'warning: search.audit' 1 search "$inputs/brick_wall.toml" "${small[@]}" --set search.audit=3
expect "repetitions that kept their lists have no figure of merit" 0 '^no FOM' 1 search "$inputs/brick_wall.toml" "${small[@]}" --set search.reuse.margin=0.5
# A rotation of a linear body by a sixth of a turn.
rotation=("$inputs/one_brick.toml" --set 'material.brick.model="linear"' --set 'load.pressure[0].peak=1'
  --set 'initial.velocity[0].angular_velocity=[0,0,1000]' --set time.end=1e-3 --set output.checkpoint.steps=1000)
expect "the rotation of a linear body gives a warning" 0 'warning: element [0-9]+ .*linear material has rotated' 1 run "${rotation[@]}"
mkdir "$work/out/checkpoints/step-keep" # no name of a checkpoint
expect "a restarted run knows its warnings" 0 '^PASS' 1 run "${rotation[@]}" --restart latest --extend-to 1.1e-3
{ [[ $(grep -c 'has rotated' "$work/out/report.json") -eq 1 ]] && ! grep -q 'has rotated' "$work/log"; } ||
  { echo "FAILED: a restarted run does not report its warning once"; failures=$((failures + 1)); }
[[ -d $work/out/checkpoints/step-keep ]] || { echo "FAILED: a folder beside the checkpoints is removed"; failures=$((failures + 1)); }
expect "a checkpoint that is not there names the nearest one" 2 'no manifest.json.*the nearest one can: --restart .*/checkpoints/step-0' \
  1 run "${rotation[@]}" --restart "$work/out/checkpoints/step-5"
expect "a folder without checkpoints names those of the run" 2 'no manifest.json.*the nearest one can: --restart .*/checkpoints/step-0' \
  1 run "${rotation[@]}" --restart "$work"
# A restart into another folder begins files there; the next one from the same checkpoint replaces them.
restarted=(run "${rotation[@]}" --restart "$work/out" --extend-to 1.2e-3)
output=$work/second_folder
expect "a restart into another folder begins new files" 0 'found no results of the earlier run' 1 "${restarted[@]}"
for ranks in 1 2; do
  expect "a second restart from that checkpoint replaces them" 0 'begin after the checkpoint and are replaced' $ranks "${restarted[@]}"
done
sed -i '2,$d' "$output/history.csv"
expect "so it does where the earlier one has written no row" 0 'begin after the checkpoint and are replaced' 2 "${restarted[@]}"
output=$work/out
# The name of the new file of rank 0 is taken when elements move.
rm -rf "$work/out"
mkdir -p "$work/out/brick_wall.exo.2.0.new/taken"
expect "a move of elements that fails says after which step, and how to continue" 4 \
  'elements could not be moved to other ranks after step 50 of 60.*brick_wall.exo.2.0.new.*--restart latest continues at step 40' \
  2 run "$inputs/brick_wall.toml" "${small[@]}" --steps 60 --set output.checkpoint.steps=40 --set 'partition.rebalance="always"' \
  --set partition.interval=50
rm -r "$work/out/brick_wall.exo.2.0.new"
expect "a run continues after such a failure" 0 '^PASS' 2 run "$inputs/brick_wall.toml" "${small[@]}" --steps 60 \
  --set output.checkpoint.steps=40 --set 'partition.rebalance="always"' --set partition.interval=50 --restart latest
rm -rf "$work/out"
expect "check refuses a body that the wall lacks" 2 'initial.velocity.*body: found the integer 99' 1 check "$inputs/brick_wall.toml" --set 'initial.velocity[0].body=99' --set 'initial.velocity[0].velocity=[0,0,1]'
for command in check run; do
  code=0
  "$brickwall" $command "$inputs/brick_wall.toml" "${small[@]}" --steps 2 -o "$work/out" >/dev/full 2>"$work/log" || code=$?
  { [[ $code -eq 4 ]] && grep -q 'standard output' "$work/log"; } || { echo "FAILED $command on a full standard output: exit code $code"; failures=$((failures + 1)); }
done
# The programs of other commands stand beside the program, or are said to be missing.
cp "$brickwall" "$work/brickwall"
code=0
"$work/brickwall" report out >"$work/log" 2>&1 || code=$?
{ [[ $code -eq 1 ]] && grep -q 'brickwall-report cannot be started: No such file' "$work/log"; } ||
  { echo "FAILED: a missing brickwall-report: exit code $code"; failures=$((failures + 1)); }
# A mesh is written and read.
expect "a mesh is written" 0 'elements' 1 mesh "$inputs/brick_wall.toml" "${small[@]}"
cat >"$work/mesh.toml" <<DECK
[mesh]
file = "out/brick_wall.exo"
[material.brick]
density = 2000.0
youngs_modulus = 20.0e9
poissons_ratio = 0.2
[material.half_brick]
density = 2000.0
youngs_modulus = 20.0e9
poissons_ratio = 0.2
[[load.pressure]]
side_set = "front"
shape = "step"
peak = 1e5
[time]
end = 1e-4
DECK
cp "$work/out/brick_wall.exo" "$work/keep.exo"
sed -i 's#out/brick_wall.exo#keep.exo#' "$work/mesh.toml"
for ranks in 1 2; do expect "a mesh from a file runs" 0 '^PASS' $ranks run "$work/mesh.toml" --no-output; done
head -c 3000 "$work/keep.exo" >"$work/cut.exo"; sed -i 's#keep.exo#cut.exo#' "$work/mesh.toml"
for ranks in 1 2; do expect "a truncated mesh is refused" 2 'cut.exo' $ranks run "$work/mesh.toml" --no-output; done
exit "$failures"
