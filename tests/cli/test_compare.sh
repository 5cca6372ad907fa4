#!/usr/bin/env bash
# diffbench compare: the GPU's shaders against the CPU, on whatever OpenGL ES there is (Mesa's llvmpipe at least).
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture blazed --size-um 20 --pixels 128 --out 'a<b>.gsf'
small=('a<b>.gsf' --quiet --sigma-um 5 --grating-nm 2500 --map-pixels 17 --azimuths 256 --radii 64 --lut-lambda-nm 400:700:50
       --colour-lambda-nm 400:700:50 --map-lambda-nm 550 --angle-deg -80:80:1 --lambda-nm 400:700:20 --no-fit)

# the outputs: every method, every question, both paths
some=("${small[@]}" --methods sheet,nmm,nmm-lines,pq,stam)
run 0 compare "${some[@]}" --out good --json
ok "page" [ "$(json page)" = good/index.html ]
ok "pass" [ "$(json pass)" = true ]
near "cases" "$(json cases)" 30 0
near "failed" "$(json failed)" 0 0
ok "page is there" [ -s good/index.html ]
ok "JUnit is there" [ -s good/junit.xml ]
if command -v xmllint >/dev/null; then
    ok "JUnit is well-formed" xmllint --noout good/junit.xml
fi
cp good/compare.json out
ok "schema" [ "$(json schema)" = "diffbench compare 1" ]
ok "renderer" [ -n "$(json device.renderer)" ]
ok "renderer is provenance" [ "$(json provenance.gpu_renderer)" = "$(json device.renderer)" ]
ok "path" [ "$(json surfaces.0.cases.1.path)" = fragment ]
ok "timings" bash -c 'grep -q upload_s out'
near "worst of a table" "$(json surfaces.0.cases.0.stats.abs.worst)" 0 2e-6
near "same place on both sides" "$(json surfaces.0.cases.0.stats.abs.device)" "$(json surfaces.0.cases.0.stats.abs.reference)" 2e-6
for side in device reference difference; do
    ok "$side picture" [ -s "good/a-b.sheet.colour.compute.$side.png" ]
done
cp good/a-b.sheet.table.device.exr .
run 0 maxima a-b.sheet.table.device.exr --json
ok "its numbers are a table" [ "$(json n)" != 0 ]

# the page can be made again, and two runs are the same where timings are left out
cp good/index.html first.html
run 0 compare --rebuild good
ok "the same page" cmp -s good/index.html first.html
tiny=("${small[@]}" --methods sheet --paths compute)

# shadowing darkens the colours on either side alike
for kind in none smith; do
    run 0 compare "${tiny[@]}" --map-theta-i-deg 80 --shadowing $kind --no-pictures --out "shadow-$kind"
done
cp shadow-none/compare.json out
bright=$(json surfaces.0.cases.2.maximum)
cp shadow-smith/compare.json out
ok "colours are the last case" [ "$(json surfaces.0.cases.2.question)" = colour ]
ok "shadowing is provenance" [ "$(json surfaces.0.provenance.shadowing)" = smith ]
ok "colours are darker" awk "BEGIN { exit !($(json surfaces.0.cases.2.maximum) < 0.99 * $bright) }"
refuses 2 "compare: --shadowing 'ward': unknown" compare "${tiny[@]}" --shadowing ward --out x

export SOURCE_DATE_EPOCH=1700000000
run 0 compare "${tiny[@]}" --out day
mv day keep
run 0 compare "${tiny[@]}" --out day
for file in keep/*; do
    ok "$file is byte-identical" cmp -s "$file" "day/${file#keep/}"
done
ok "no timings then" bash -c '! grep -q upload_s day/compare.json'
unset SOURCE_DATE_EPOCH

# negative controls: shaders that are deliberately wrong do not pass, whatever the method
for fault in plane sign tap; do
    run 1 compare "${small[@]}" --no-pictures --fault $fault --out $fault
    err_has "compare: $fault: [0-9]+ of [0-9]+ cases outside a threshold, first a-b: sheet table \(compute\)"
    cp $fault/compare.json out
    near "$fault: no case passes" "$(json verdict.n_failed)" "$(json verdict.n)" 0
    ok "$fault: JUnit says so" grep -q '<failure message="abs.worst = ' $fault/junit.xml
    ok "$fault: the page says so" grep -q "deliberately wrong ($fault)" $fault/index.html
done

# thresholds: printed, read back, tightened, loosened
run 0 compare --print-thresholds
cp out defaults.json
near "2e-6 of a power" "$(json thresholds.1.limit)" 2e-6 0
ok "with a reason" [ -n "$(json thresholds.1.reason)" ]
run 0 compare "${tiny[@]}" --no-pictures --thresholds defaults.json --out read-back
echo '{"schema": "diffbench thresholds 1", "thresholds": [
 {"method": "sheet", "question": "table", "metric": "abs.worst", "limit": 1e-12, "reason": "to see it fail"}]}' >tight.json
run 1 compare "${tiny[@]}" --no-pictures --thresholds tight.json --out tight --json
err_has 'compare: tight: 1 of 3 cases outside a threshold, first a-b: sheet table \(compute\)$'
ok "in the page" grep -q 'to see it fail' tight/index.html
sed 's/1e-12/null/' tight.json >none.json
run 0 compare "${tiny[@]}" --no-pictures --thresholds none.json --fault none --out not-judged
bad_threshold() # REGEX, JSON of one threshold
{
    echo "{\"schema\": \"diffbench thresholds 1\", \"thresholds\": [$2]}" >bad.json
    refuses 3 "compare: bad.json: threshold 1: $1" compare "${tiny[@]}" --thresholds bad.json --out x
}
bad_threshold 'no method "shet"$' '{"method": "shet", "metric": "abs.worst", "limit": 1, "reason": "why"}'
bad_threshold 'no question "maps", expected' '{"question": "maps", "metric": "abs.worst", "limit": 1, "reason": "why"}'
bad_threshold 'no metric "abs.worse"' '{"metric": "abs.worse", "limit": 1, "reason": "why"}'
bad_threshold 'no metric "\?"' '{"limit": 1, "reason": "why"}'
bad_threshold '"limit" is no number >= 0' '{"metric": "abs.worst", "limit": -1, "reason": "why"}'
bad_threshold '"limit" is no number >= 0' '{"metric": "abs.worst", "reason": "why"}'
bad_threshold 'no "reason" given$' '{"metric": "abs.worst", "limit": 1}'
echo '{"schema": 1}' >bad.json
refuses 3 'compare: bad.json: "schema" is not "diffbench thresholds 1"$' compare "${tiny[@]}" --thresholds bad.json --out x
echo '{' >bad.json
refuses 3 'compare: bad.json: line 2: ' compare "${tiny[@]}" --thresholds bad.json --out x
refuses 3 'compare: none-such.json: ' compare "${tiny[@]}" --thresholds none-such.json --out x

# a baseline: the same run moves nothing, a fault is worse, and back again it is better
run 0 compare "${tiny[@]}" --no-pictures --baseline day/compare.json --out again
cp again/compare.json out
near "nothing moved" "$(json 'baseline.rows#')" 0 0
run 1 compare "${tiny[@]}" --no-pictures --baseline day/compare.json --fault tap --out worse
ok "worse in JUnit" grep -q 'type="worse than the baseline"' worse/junit.xml
run 0 compare "${tiny[@]}" --no-pictures --baseline worse/compare.json --out better
cp better/compare.json out
ok "better" bash -c 'grep -q "\"state\": \"better\"" out && ! grep -q "\"state\": \"worse\"" out'
# worse by less than a threshold is worse all the same: coarser sheets
run 1 compare "${tiny[@]}" --no-pictures --baseline day/compare.json --thresholds none.json --tol 3e-5 --out coarse
err_has 'compare: coarse: '
# a case that is gone is said, one that is new is no harm
run 1 compare "${tiny[@]}" --no-pictures --methods stam --baseline day/compare.json --out gone
err_has 'compare: gone: 3 numbers worse than the baseline or missing$'
run 0 compare "${some[@]}" --no-pictures --paths compute --baseline day/compare.json --out more
cp more/compare.json out
ok "new" grep -q '"state": "new"' out
refuses 3 'compare: none-such.json' compare "${tiny[@]}" --baseline none-such.json --out x
refuses 3 'compare: tight.json: not a comparison: "schema" is not "diffbench compare 1"$' compare "${tiny[@]}" --baseline tight.json --out x

# the reference against itself at the device's tolerance needs no GPU
run 0 compare "${small[@]}" --methods sheet --device cpu --tol 1e-6 --no-pictures --out cpu
cp cpu/compare.json out
ok "path" [ "$(json surfaces.0.cases.0.path)" = cpu ]
run 1 compare "${small[@]}" --methods sheet --device cpu --tol 1e-3 --no-pictures --out cpu

# what needs a period is left out where none is known, and said
run 0 fixture random --size-um 10 --pixels 64 --out r.gsf
run 0 compare r.gsf --quiet --sigma-um 2 --methods nmm-lines,pq,stam --paths compute --map-pixels 16 --map-lambda-nm 500 \
    --colour-lambda-nm 400:700:100 --angle-deg -60:60:2 --lambda-nm 400:700:100 --no-pictures --out random
cp random/compare.json out
ok "left out" [ "$(json surfaces.0.skipped.0.method)" = nmm-lines ]
ok "left out, too" [ "$(json surfaces.0.skipped.1.method)" = pq ]
ok "JUnit: skipped" grep -q '<skipped message="no period is known' random/junit.xml

# what is wrong is said in one line
refuses 2 'compare: expected exactly one of --out DIR, --rebuild DIR and --print-thresholds$' compare r.gsf
refuses 2 'compare: expected exactly one of' compare r.gsf --out a --rebuild b
refuses 2 'compare: --rebuild compares nothing, expected no SURFACE$' compare --rebuild good r.gsf
refuses 2 'compare: --print-thresholds compares nothing' compare --print-thresholds r.gsf
refuses 2 "compare: --methods 'sheet,taylor': no method 'taylor', expected some of" compare r.gsf --methods sheet,taylor --out a
refuses 2 "compare: --fault 'all': unknown, expected one of none|plane|sign|tap$" compare r.gsf --fault all --out a
refuses 2 'compare: --device cpu has no shaders' compare r.gsf --device cpu --fault tap --out a
refuses 3 'compare: none.gsf' compare none.gsf --quiet --out a
refuses 3 'compare: none/compare.json' compare --rebuild none
refuses 3 "compare: first.html/x: cannot make the folder: Not a directory" compare "${tiny[@]}" --out first.html/x
__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent refuses 4 'compare: no GPU: ' compare "${tiny[@]}" --out bare
ok "nothing was written" [ ! -e bare ]
cp good/compare.json out
if [ "$(json device.software)" = true ]; then
    refuses 4 'compare: .*software' compare "${tiny[@]}" --require-hardware --out a
else
    run 0 compare "${tiny[@]}" --no-pictures --require-hardware --out a
fi
finish
