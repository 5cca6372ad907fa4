#!/usr/bin/env bash
# diffbench map
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture flat --size-um 20 --pixels 128 --out flat.gsf
run 0 fixture blazed --period-nm 2500 --height-nm 250 --size-um 40 --pixels 512 --out blazed.gsf
lambdas=(--lambda-nm 400:700:50)

# a mirror is one white spot at the mirror direction
run 0 map flat.gsf --theta-i-deg 25 --phi-i-deg 40 --pixels 128 "${lambdas[@]}" --sigma-um 4 --quantity power --out m.exr \
    --json
near "polar angle of the spot" "$(json light.peak_theta_deg)" 25 0.6
near "azimuth of the spot" "$(json light.peak_phi_deg)" -140 1.2
near "its centre, x" "$(json light.mean_x)" "$(awk 'BEGIN { r = 3.14159265 / 180; print -sin(25 * r) * cos(40 * r) }')" 0.002
near "its centre, y" "$(json light.mean_y)" "$(awk 'BEGIN { r = 3.14159265 / 180; print -sin(25 * r) * sin(40 * r) }')" 0.002
near "white at the peak, but for half a pixel" "$(json light.peak_Y)" 1 0.1
# |P|^2 of a Gaussian of sigma: a Gaussian of lambda / (2 pi sqrt 2 sigma), 555 nm where the eye is
near "as wide as the window says" "$(json light.spread_x)" 0.0156 0.0015
near "and as high" "$(json light.spread_y)" 0.0156 0.0015

# the reverse: light and detector change places
run 0 map flat.gsf --theta-r-deg 25 --phi-r-deg 40 --pixels 64 "${lambdas[@]}" --png r.png --json
near "polar angle of the light" "$(json light.peak_theta_deg)" 25 1.2
near "azimuth of the light" "$(json light.peak_phi_deg)" -140 2.4
ok "PNG" [ "$(head -c 4 r.png | tail -c 3)" = PNG ]

# orders of a grating at m lambda / d: sin theta_r = m lambda / d - sin theta_i, brightest at the blaze
run 0 map blazed.gsf --theta-i-deg 30 --pixels 512 --lambda-nm 500 --quantity power --sigma-um 6 --out b.exr --json
near "the blaze's order" "$(awk -v t="$(json light.peak_theta_deg)" 'BEGIN { print sin(t * 3.14159265 / 180) }')" 0.7 0.003
near "lies on the left" "$(awk -v p="$(json light.peak_phi_deg)" 'BEGIN { print (p < 0 ? -p : p) }')" 180 0.5

# files: spectral layers, both kinds at once; a map is no heightfield
run 0 map blazed.gsf --theta-i-deg 30 --pixels 32 "${lambdas[@]}" --spectral --out s.exr --png s.png
ok "a layer a wavelength" [ "$(grep -aoE 'T\.[0-9]+,000000nm' s.exr | sort -u | wc -l)" -eq 7 ]
ok "and the layout's version" grep -aq spectralLayoutVersion s.exr
ok "whose picture is a picture" [ "$(head -c 4 s.png | tail -c 3)" = PNG ]
err_has 'exposure [0-9.e+]+ \(auto\), clip$'
refuses 3 "info: s.exr: holds 'map: x, y = direction cosines', want a heightfield" info s.exr --pixel-nm 10
run 0 map blazed.gsf --theta-i-deg 30 --pixels 32 "${lambdas[@]}" --exposure 3 --gamut desaturate --out s2.png
err_has 'exposure 3, desaturate$'
ok "the picture says how it was made" grep -aq 'diffbench.gamut' s2.png

# checks against the direct sum
run 0 map blazed.gsf --theta-i-deg 30 --pixels 32 "${lambdas[@]}" --check 20 --out c.png
err_has 'checked 20 samples: largest amplitude error [0-9.e-]+ \(tol 0.0001\) at x '
run 1 map blazed.gsf --theta-i-deg 30 --pixels 32 "${lambdas[@]}" --method taylor --terms 1 --check 20 --out c.png --quiet
err_has '^diffbench map: blazed.gsf: amplitude error .*expected at most 0.0001 \(--tol\)$'

# the same bytes whatever the number of threads, if the date is fixed
for n in 1 2 3; do
    last="map with $n threads"
    SOURCE_DATE_EPOCH=1700000000 OMP_NUM_THREADS=$n "$program" map blazed.gsf --theta-i-deg 60 --phi-i-deg 20 --pixels 64 \
        "${lambdas[@]}" --quiet --out t.exr --png t.png 2>err
    mv t.exr t$n.exr
    mv t.png t$n.png
done
ok "EXR does not depend on threads" cmp -s t1.exr t2.exr
ok "EXR does not depend on threads" cmp -s t1.exr t3.exr
ok "PNG does not depend on threads" cmp -s t1.png t3.png

refuses 2 "map: --pixels '0': out of range, expected at least 16 and at most 4096" map blazed.gsf --theta-i-deg 1 --pixels 0 --out x.exr
refuses 2 "map: --pixels '1000000': out of range" map blazed.gsf --theta-i-deg 1 --pixels 1000000 --out x.exr
refuses 2 'map: expected exactly one of --theta-i-deg and --theta-r-deg' map blazed.gsf --out x.exr
refuses 2 'map: expected exactly one of' map blazed.gsf --theta-i-deg 1 --theta-r-deg 1 --out x.exr
refuses 2 'map: --phi-r-deg with --theta-i-deg' map blazed.gsf --theta-i-deg 1 --phi-r-deg 1 --out x.exr
refuses 2 'map: nowhere to put the map' map blazed.gsf --theta-i-deg 1
refuses 2 "map: --out 'x.csv': unknown kind of file" map blazed.gsf --theta-i-deg 1 --out x.csv
refuses 2 "map: --png 'x.exr': expected F.png" map blazed.gsf --theta-i-deg 1 --png x.exr
refuses 2 'map: --spectral without an EXR' map blazed.gsf --theta-i-deg 1 --spectral --out x.png
for bad in 0 -1 nan bright; do
    refuses 2 "map: --exposure '$bad': expected a number > 0 or auto" map blazed.gsf --theta-i-deg 1 --out x.png --exposure "$bad"
done
refuses 3 'map: none/x.exr: cannot write' map blazed.gsf --theta-i-deg 1 --out none/x.exr
refuses 3 'map: none.gsf: ' map none.gsf --theta-i-deg 1 --out x.exr
refuses 2 'map: no wavelength in 380 ... 780 nm|map: .*380' map blazed.gsf --theta-i-deg 1 --pixels 16 --lambda-nm 900 --out x.exr --quiet
ok "nothing left behind" [ -z "$(find . -name 'x.*')" ]

# shadowing darkens a map of a rough surface
run 0 fixture random --size-um 10 --pixels 128 --height-nm 300 --out rough.gsf
dark=(rough.gsf --theta-i-deg 70 --pixels 32 "${lambdas[@]}" --sigma-um 3 --json)
run 0 map "${dark[@]}" --png m.png
bare=$(json light.peak_Y)
run 0 map "${dark[@]}" --png m.png --shadowing ndf --check 20
ok "darker" awk -v a="$(json light.peak_Y)" -v b="$bare" 'BEGIN { exit !(a < b) }'
ok "and says why" [ "$(json provenance.shadowing)" = ndf ]
finish
