#!/usr/bin/env bash
# diffbench view
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture elaphe --pixels 400 --size-um 20 --out shed.gsf
size_of() { od -An -j16 -N8 -tu1 "$1" | awk '{ print $1 * 16777216 + $2 * 65536 + $3 * 256 + $4, $5 * 16777216 + $6 * 65536 + $7 * 256 + $8 }'; }

# a picture has the surface's size times the zoom, half of it if seen from 60 degrees
run 0 view shed.gsf --zoom 0.25 --out v.png
out_has '^100 x 100 pixels, 64 places read a pixel$'
ok "size" [ "$(size_of v.png)" = "100 100" ]
ok "says how it was made" grep -aq 'viridis, ' v.png
run 0 view shed.gsf --zoom 0.25 --theta-deg 60 --out t.png
ok "seen from the side" [ "$(size_of t.png)" = "100 50" ]

# filtered is nearer to the truth than the mean height, and that than no filter at all; far more than an eye can tell
for zoom in 0.25 0.0625; do
    run 0 view shed.gsf --zoom $zoom --compare c.png --json
    point=$(json point.de_mean) mean=$(json mean.de_mean) filtered=$(json filtered.de_mean)
    ok "zoom $zoom: $filtered < $mean / 2 < $point" awk -v p="$point" -v m="$mean" -v f="$filtered" \
        'BEGIN { exit !(f < 0.5 * m && m < p && f < 0.5) }'
    ok "a picture of four" [ "$(head -c 4 c.png | tail -c 3)" = PNG ]
done
run 0 view shed.gsf --zoom 0.25 --compare c.png
out_has '^filter +dE2000 mean +median +p95 +worst +rms +reads$'
out_has '^filtered +0\.'

# any filter on its own; a flat surface has one colour
for filter in point mean filtered truth; do
    run 0 view shed.gsf --zoom 0.1 --filter $filter --samples 4 --out $filter.png
done
run 0 fixture flat --pixels 32 --size-um 2 --out flat.gsf
run 0 view flat.gsf --zoom 2 --out flat.png

for i in 1 2; do
    last="view, run $i"
    SOURCE_DATE_EPOCH=1700000000 OMP_NUM_THREADS=$i "$program" view shed.gsf --zoom 0.1 --compare c.png --quiet >out
    mv c.png c$i.png
done
ok "the same picture whatever the threads" cmp -s c1.png c2.png

refuses 2 'view: nowhere to put the picture' view shed.gsf
refuses 2 "view: --out 'x.exr': expected F.png" view shed.gsf --out x.exr
refuses 2 "view: --compare 'x.jpg': expected F.png" view shed.gsf --out x.png --compare x.jpg
refuses 2 "view: --zoom '0': out of range" view shed.gsf --zoom 0 --out x.png
refuses 2 "view: --theta-deg '90': out of range" view shed.gsf --theta-deg 90 --out x.png
refuses 3 'view: picture of 25600 x 25600 pixels, want at most 8192 on a side \(a smaller zoom\)' view shed.gsf --zoom 64 --out x.png
refuses 3 'view: none/x.png: cannot write' view shed.gsf --out none/x.png
refuses 3 'view: none.gsf: ' view none.gsf --out x.png
ok "nothing left behind" [ -z "$(find . -name 'x.*')" ]
finish
