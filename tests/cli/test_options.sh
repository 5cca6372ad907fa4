#!/usr/bin/env bash
# What every verb has in common: dispatch, --help, --version, strict values, exit codes of mistakes.
. "$(dirname "$0")/harness.sh" "$@"

run 0 --version
out_has '^diffbench [0-9]+\.[0-9]+\.[0-9]+$'
run 0 --help
for verb in fixture info convert table eval map lut orders maxima fit report; do
    out_has "^  $verb "
done
refuses 2 '^diffbench: no verb given'
refuses 2 '^diffbench: bake: unknown verb, expected one of fixture, info, convert, table' bake
refuses 2 '^diffbench: --json: unknown flag' --json

for verb in fixture info convert table eval map lut orders maxima fit report; do
    run 0 $verb --help
    out_has "^usage: diffbench $verb"
    out_has '^Example$'
    out_has '^  diffbench '
    for flag in json quiet threads help version; do
        out_has "^  --$flag( |\$)"
    done
    ok "$verb: nothing on stderr" [ ! -s err ]
    ok "$verb: lines of at most 120 columns" awk 'length > 120 { exit 1 }' out
    run 0 $verb --version
    out_has '^diffbench [0-9]'
    refuses 2 "^diffbench $verb: --bogus: unknown flag" $verb --bogus
    refuses 2 "^diffbench $verb: -x: unknown flag" $verb -x
    refuses 2 "^diffbench $verb: --threads '0': out of range" $verb --threads 0
    refuses 2 "^diffbench $verb: --threads: needs a value" $verb --threads
done

# the unit is part of the flag's name: no abbreviations
refuses 2 'table: --lambda: unknown flag, did you mean --lambda-nm\?' table s.gsf --lambda 500
refuses 2 'table: --theta-i=75: unknown flag, did you mean --theta-i-deg\?' table s.gsf --theta-i=75

run 0 fixture sine --period-nm 1600 --pixels 32 --size-um 10 --out s.gsf
plan=(--theta-i-deg 10 --angle-deg -20:20:10 --lambda-nm 500)

# strict numbers
for bad in 75deg '7 5' 0x10 nan inf -inf 1e999 '' 1,5 --quiet; do
    refuses 2 "^diffbench table: --theta-i-deg '?.*(not a number|out of range|empty)" table s.gsf --theta-i-deg "$bad"
done
for bad in 1.5 two 1e3 '' 99999999999999999999 ' 2' 0x2; do
    refuses 2 "^diffbench table: --threads" table s.gsf "${plan[@]}" --threads "$bad"
done
for bad in 1:2 1:2:3:4 : 1:2:x '1 :2:1' 780:380:1 380:780:0 380:780:-1 0:780:1 -5 0 nan inf; do
    refuses 2 '^diffbench table: --lambda-nm' table s.gsf --theta-i-deg 10 --lambda-nm "$bad"
done
for bad in 90 -90 -90:0:1 0:90:1 -100 10:-10:1; do
    refuses 2 '^diffbench table: --angle-deg' table s.gsf --theta-i-deg 10 --angle-deg "$bad"
done
for flag in theta-i-deg theta-r-deg; do
    for bad in 90 -90 180 1e9; do
        refuses 2 "table: --$flag '$bad': out of range, expected strictly between -90 and 90" table s.gsf --$flag "$bad"
    done
done
for bad in 0 1 2 -1e-6 1e-15; do
    refuses 2 "table: --tol '$bad': out of range, expected at least 1e-14 and less than 1" table s.gsf "${plan[@]}" \
        --tol "$bad"
done
for flag in pixel-nm size-um height-um sigma-um n; do
    refuses 2 "table: --$flag '0': out of range, expected more than 0" table s.gsf "${plan[@]}" --$flag 0
done
refuses 2 "table: --method 'fast': unknown, expected one of sheet\|taylor\|direct" table s.gsf "${plan[@]}" --method fast
refuses 2 'table: expected exactly one of --theta-i-deg and --theta-r-deg' table s.gsf --angle-deg 0
refuses 2 'table: expected exactly one of' table s.gsf --theta-i-deg 1 --theta-r-deg 1

# negative numbers as values, both ways; operands before, between, behind and after --
run 0 table --theta-i-deg -10 s.gsf --angle-deg -20:20:10 --lambda-nm 500 --quiet
cp out a.csv
run 0 table --theta-i-deg=-10 --angle-deg=-20:20:10 --lambda-nm=500 --quiet s.gsf
ok "the same rows" cmp -s <(rows a.csv) <(rows out)
run 0 table --theta-i-deg=-10 --angle-deg=-20:20:10 --lambda-nm=500 --quiet -- s.gsf
ok "the same rows" cmp -s <(rows a.csv) <(rows out)
ok "--quiet says nothing" [ ! -s err ]
refuses 2 'table: expected SURFACE' table "${plan[@]}"
refuses 2 'table: t.gsf: one operand too many' table s.gsf t.gsf "${plan[@]}"

# threads change nothing
run 0 table s.gsf "${plan[@]}" --threads 1
cp out one.csv
run 0 table s.gsf "${plan[@]}" --threads 2
ok "the same with two threads" cmp -s <(rows one.csv) <(rows out)
finish
