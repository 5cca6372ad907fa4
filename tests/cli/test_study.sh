#!/usr/bin/env bash
# diffbench report --study
. "$(dirname "$0")/harness.sh" "$@"

small="--angle-deg -70:10:0.25 --lambda-nm 400:720:40"
run 0 fixture blazed --pixels 96 --size-um 12 --out blazed.gsf
run 0 report --quiet --out studied --study --no-map --no-methods $small --sigma-um 2 blazed.gsf
ok "a section" grep -q '<h3 id="s1-study">' studied/index.html
ok "published periods" grep -q '<h2 id="published">' studied/index.html
ok "21 pictures" [ "$(ls studied/blazed.study-*.png | wc -l)" -eq 21 ]
cp studied/report.json out
near "rows" "$(json surfaces.0.study.rows#)" 4 0
near "the finest step is its own reference" "$(json surfaces.0.study.rows.0.items.0.de_worst)" 0 0
near "published" "$(json surfaces.0.study.published.full_nm)" 2499.997 0
cp studied/results.json out
near "the source's program on its bitmap" "$(json source_bitmap.thesis_nm)" 2499.997 0.001
near "with its deviation" "$(json source_bitmap.thesis_sd_nm)" 0.377 0.001
cp studied/index.html first-study.html
run 0 report --rebuild studied
ok "rebuilt the same" cmp -s studied/index.html first-study.html


# a picture that is gone
rm studied/blazed.study-2-3.png
refuses 3 'report: studied/blazed.study-2-3.png' report --rebuild studied
ok "the old page stays" cmp -s studied/index.html first-study.html
finish
