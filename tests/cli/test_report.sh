#!/usr/bin/env bash
# diffbench report
. "$(dirname "$0")/harness.sh" "$@"

small="--angle-deg -70:10:0.25 --lambda-nm 400:720:40"
run 0 fixture sine --pixels 256 --out 'a<b>&.gsf'

# one surface: the page, its JSON, the result files
run 0 report --out page $small 'a<b>&.gsf'
out_has '^page/index.html$'
ok "the page is one file" [ "$(grep -c 'https\?:' page/index.html)" -eq 0 ]
ok "no script" [ "$(grep -c '<script' page/index.html)" -eq 0 ]
ok "the name is escaped" grep -q 'a&lt;b&gt;&amp;.gsf' page/index.html
ok "the page ends" [ "$(tail -n 1 page/index.html)" = '</html>' ]
for file in results.json report.json a-b.json a-b.height.exr a-b.table.exr a-b.table.csv a-b.maxima.csv a-b.lines.csv a-b.map.exr a-b.map.png a-b.map-level.png \
    a-b.slopes.png a-b.normals.png a-b.view.png; do
    ok "$file" [ -s "page/$file" ]
done
ok "no temporary file stays" [ -z "$(ls page | grep tmp)" ]
cp page/report.json out
near "tolerance kept" "$(json surfaces.0.check.worst_amplitude)" 0 1e-6
near "samples" "$(json surfaces.0.surface.nx)" 256 0
near "angles" "$(json surfaces.0.plan.n_angle)" 321 0
ok "input's sha256" [ "$(json surfaces.0.provenance.input_sha256)" = "$(sha256sum 'a<b>&.gsf' | cut -c1-64)" ]
ok "timings" [ "$(json surfaces.0.timings.rows#)" -ge 5 ]
ok "averaged as its kind asks" [ "$(json surfaces.0.plan.average)" = none ]

near "incidence of the map" "$(json surfaces.0.map.theta_i_deg)" 30 0
near "methods" "$(json surfaces.0.methods.rows#)" 9 0
ok "the first is the sheet" [ "$(json surfaces.0.methods.rows.0.name)" = sheet ]
near "whose error is small" "$(json surfaces.0.methods.rows.0.error_worst)" 0 1e-6
near "whose colours are the reference" "$(json surfaces.0.methods.rows.0.de_worst)" 0 0
# a sine of slope pi H / d along x: the visible area is that of its moments, the view is filtered
near "slopes" "$(json surfaces.0.slopes.surface.sd_x)" 0.22 0.01
near "none across" "$(json surfaces.0.slopes.surface.sd_y)" 0 1e-6
ok "filtered is nearest to the truth" awk -v f="$(json surfaces.0.slopes.filtered.de_mean)" -v m="$(json surfaces.0.slopes.mean.de_mean)" 'BEGIN { exit !(f < m) }'

near "maxima near the grating's period" "$(json surfaces.0.methods.rows.0.maxima_nm)" 2500 25

# parts left out
run 0 report --quiet --out less --no-map --no-methods --no-gpu --no-render --no-slopes $small 'a<b>&.gsf'
ok "no map" [ ! -e less/a-b.map.png ]
ok "no slopes" [ ! -e less/a-b.slopes.png ]
ok "not on the page" bash -c '! grep -q "BRDF map\|Methods compared\|GPU against CPU\|from afar" less/index.html'
ok "but there with it" bash -c '[ $(grep -c "<h3 id=\"s1-\(map\|methods\|slopes\)\"" page/index.html) -eq 3 ]'

# GPU against CPU: on the page, and a line where there is no GPU
near "cases outside" "$(cp page/report.json out && json surfaces.0.gpu.verdict.n_failed)" 0 0
ok "many of them" [ "$(json surfaces.0.gpu.verdict.n)" -ge 14 ]
ok "on the page" grep -q '<h3 id="s1-gpu">GPU against CPU</h3>' page/index.html
__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent run 0 report --quiet --out bare --no-map --no-methods --no-render --no-slopes $small 'a<b>&.gsf'
ok "why there is none" grep -q 'Not compared: no GPU: ' bare/index.html

# the table of the report is the table of `table`
run 0 table 'a<b>&.gsf' --theta-i-deg 75 $small --azimuth-deg 0 --layout matrix --out t.csv
rows page/a-b.table.csv >a.rows
rows t.csv >t.rows
ok "same values as table" cmp -s a.rows t.rows

# rebuilt without measuring: the same bytes
cp page/index.html first.html
cp page/report.json first.json
rm page/index.html page/report.json
run 0 report --rebuild page
ok "the page is the same" cmp -s page/index.html first.html
ok "the JSON is the same" cmp -s page/report.json first.json

# byte-identical runs
export SOURCE_DATE_EPOCH=1700000000
run 0 report --quiet --out day $small 'a<b>&.gsf'
mkdir keep
mv day/* keep
run 0 report --quiet --out day $small 'a<b>&.gsf'
for file in index.html report.json results.json a-b.json a-b.maxima.csv a-b.lines.csv a-b.table.csv a-b.table.exr \
    a-b.map.exr a-b.map.png a-b.map-level.png a-b.slopes.png a-b.normals.png a-b.view.png; do
    ok "$file is the same again" cmp -s "day/$file" "keep/$file"
done
cp day/report.json out
ok "no timings then" bash -c '! grep -q timings out'
unset SOURCE_DATE_EPOCH

# several surfaces keep apart
run 0 report --out two --no-map --no-methods $small 'a<b>&.gsf' 'a<b>&.gsf' --json
ok "the page is named" [ "$(json page)" = two/index.html ]
ok "first" [ -s two/1-a-b.json ]
ok "second" [ -s two/2-a-b.json ]

# what is wrong is said in one line
refuses 2 'report: expected exactly one of --out DIR and --rebuild DIR$' report
refuses 2 'report: expected exactly one of --out DIR and --rebuild DIR$' report --out a --rebuild b
refuses 2 'report: --rebuild measures nothing, expected no SURFACE$' report --rebuild page x.gsf
refuses 2 'report: expected at most one of --theta-i-deg and --theta-r-deg$' report --out a --theta-i-deg 1 --theta-r-deg 2
refuses 2 'report: ' report --out a --angle-deg 0:90:1
refuses 3 'report: none.gsf' report --quiet --out page none.gsf
refuses 3 'report: none/results.json' report --rebuild none
refuses 3 "report: first.html/x: cannot make the folder: Not a directory" report --quiet --out first.html/x 'a<b>&.gsf'
echo 'P' >day/a-b.map.png
refuses 3 'report: day/a-b.map.png: not a PNG picture$' report --rebuild day
rm day/a-b.map.png
refuses 3 'report: day/a-b.map.png' report --rebuild day
echo '{' >day/a-b.json
refuses 3 'report: day/a-b.json: line 2: ' report --rebuild day
rm day/a-b.json
refuses 3 'report: day/a-b.json' report --rebuild day
ok "the old page stays" cmp -s day/index.html keep/index.html
path=$PATH
PATH=/nonexistent
refuses_without_tools()
{
    "$program" report --rebuild page >out 2>err </dev/null
    code=$?
}
refuses_without_tools
PATH=$path
last="report --rebuild page without gnuplot"
ok "exit code $code, want 4" [ $code -eq 4 ]
err_has 'install the package gnuplot-nox$'
ok "one line" [ "$(wc -l <err)" -eq 1 ]
finish
