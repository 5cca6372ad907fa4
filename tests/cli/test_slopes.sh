#!/usr/bin/env bash
# diffbench slopes
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture random --size-um 25 --pixels 256 --height-nm 400 --out rough.gsf
run 0 fixture flat --size-um 10 --pixels 64 --out flat.gsf

# a flat surface: nothing but its foreshortening
run 0 slopes flat.gsf --theta-deg 60 --json
near "visible area of a flat surface" "$(json measured.norm)" 0.5 1e-12
near "and of its Gaussian" "$(json gaussian.norm)" 0.5 1e-12
near "no spread" "$(json surface.var_x)" 0 0
near "no masking" "$(json masking_smith)" 1 0

# a sine of height H and period d has slopes of rms pi H / (sqrt 2 d) along it, none across
run 0 fixture sine --period-nm 2000 --height-nm 200 --size-um 20 --pixels 1024 --out sine.gsf
run 0 slopes sine.gsf --theta-deg 0 --json
near "variance along" "$(json surface.var_x)" 0.04935 0.0002
near "variance across" "$(json surface.var_y)" 0 1e-12
near "from above all is seen" "$(json measured.norm)" 1 1e-12

# text and JSON say the same; measured and Gaussian agree for a Gaussian surface, as far as its size allows
run 0 slopes rough.gsf --theta-deg 70 --phi-deg 30 --png s.png --ndf n.exr --ndf-png n.png --texels 65
out_has '^slopes of 255 x 255 cells, seen from theta 70 deg, azimuth 30 deg$'
out_has '^surface +-?0\.[0-9]+ '
out_has '^seen, measured '
out_has '^seen, Gaussian '
out_has '^masking towards the viewer, Smith 0\.9[0-9]+, from the normals 0\.9'
for picture in s.png n.png; do
    ok "$picture is a PNG" [ "$(head -c 4 $picture | tail -c 3)" = PNG ]
done
ok "the picture says where it comes from" grep -aq 'diffbench.view_theta_deg' s.png
for channel in ndf masking texel_sr texel_area; do
    ok "EXR has $channel" grep -aq "$channel" n.exr
done
refuses 3 "info: n.exr: holds 'hemisphere: x, y = direction cosines', want a heightfield" info n.exr --pixel-nm 10
run 0 slopes rough.gsf --theta-deg 70 --phi-deg 30 --ndf n.exr --texels 65 --json
near "visible area" "$(json measured.norm)" "$(json gaussian.norm)" 0.02
near "normals against Smith" "$(json masking_ndf)" "$(json masking_smith)" 0.05
near "int D cos = 1" "$(json ndf_projected)" 1 1e-12
ok "command in the provenance" [ "$(json provenance.surface_samples)" = "256 x 256" ]

# the five cases need no surface
run 0 slopes --reference-figure cases.png
ok "five cases" [ "$(head -c 4 cases.png | tail -c 3)" = PNG ]

# byte-identical
for i in 1 2; do
    last="slopes, run $i"
    SOURCE_DATE_EPOCH=1700000000 OMP_NUM_THREADS=$i "$program" slopes rough.gsf --png s.png --ndf n.exr --texels 65 --quiet >out
    mv s.png s$i.png
    mv n.exr n$i.exr
done
ok "the same picture whatever the threads" cmp -s s1.png s2.png
ok "the same normals whatever the threads" cmp -s n1.exr n2.exr

refuses 2 'slopes: expected SURFACE, or --reference-figure' slopes
refuses 2 'slopes: --png, --ndf and --ndf-png need a SURFACE' slopes --reference-figure c.png --png x.png
refuses 2 "slopes: --theta-deg '91': out of range, expected at least 0 and at most 90" slopes rough.gsf --theta-deg 91
refuses 2 "slopes: --texels '2': out of range" slopes rough.gsf --texels 2
refuses 3 'slopes: none.gsf: ' slopes none.gsf
refuses 3 'slopes: none/x.png: cannot write' slopes rough.gsf --png none/x.png
ok "nothing left behind" [ -z "$(find . -name 'x.*')" ]
finish
