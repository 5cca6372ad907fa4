#!/usr/bin/env bash
# Preparation on the command line: every step, their order, what is said and recorded, what is refused.
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 25.6 --pixels 128 --psi-deg 10 --out s.gsf

# a scan as it might come: text without our provenance, tilted, with lines of their own height, a spike and a gap
awk 'BEGIN {
    srand(3)
    for (y = 0; y < 100; y++) {
        offset = 40 * rand()
        for (x = 0; x < 120; x++) {
            z = 60 * sin(2 * 3.14159265358979 * x * 50 / 800) + 6 * x + 3 * y + offset + 2 * rand()
            if (x == 30 && y == 40) z += 900
            printf "%s%.6f", x ? "\t" : "", z
        }
        print "" } }' >scan.txt
sed '50,52s/^\([^\t]*\t[^\t]*\t\)[^\t]*\t[^\t]*/\1NaN\tNaN/' scan.txt >holes.txt
flags=(--pixel-nm 50 --z-unit nm)

# the hint
run 0 info scan.txt "${flags[@]}"
err_has '^info: not levelled: a tilt of [0-9.]+ deg makes [0-9]+ % of .*--level plane takes it off, --level none keeps it$'
for level in none auto plane poly:2; do
    run 0 info scan.txt "${flags[@]}" --level $level
    ok "--level $level: no hint" bash -c '! grep -q "not levelled" err'
done
run 0 info s.gsf
ok "no hint at a synthetic surface" bash -c '! grep -q "not levelled" err'
run 0 info scan.txt "${flags[@]}" --quiet
ok "--quiet: no hint" [ ! -s err ]

# every step says what it did, in the order given, and the provenance keeps it
run 0 convert scan.txt "${flags[@]}" --despike-nm 300 --level plane --lines median --out p.gsf
ok "three lines, in order" [ "$(grep -o '^convert: [a-z-]*' err | tr '\n' ' ')" = "convert: despike-nm convert: level convert: lines " ]
err_has '^convert: despike-nm 300: 1 points replaced \(0.00833 %\), rms [0-9.]+ nm \(from [0-9.]+ nm\)$'
err_has '^convert: level plane: rms [0-9.]+ nm \(from [0-9.]+ nm\)$'
grep -a '^diffbench.preparation = despike-nm 300: .*; level plane: .*; lines median: ' p.gsf >kept
ok "recorded in order" [ -s kept ]
run 0 fit p.gsf --json
near "period" "$(json period_nm)" 800 1
run 0 convert scan.txt "${flags[@]}" --lines median --level plane --despike-nm 300 --out q.gsf --quiet
ok "another order is recorded as such" grep -a -q '^diffbench.preparation = lines median: .*; level plane: .*; despike' q.gsf
run 0 fit scan.txt "${flags[@]}" --level poly:1 --level poly:3 --json --quiet
ok "a step may come twice" bash -c 'grep -q "level poly:1: .*; level poly:3: " out'

# verbs that read a surface have the same steps
run 0 table scan.txt "${flags[@]}" --level plane --theta-i-deg 10 --angle-deg 0:20:5 --lambda-nm 500
out_has '^# preparation: level plane: '
run 0 map scan.txt "${flags[@]}" --level plane --theta-i-deg 10 --pixels 16 --out m.exr
ok "maps" grep -a -q 'level plane: rms' m.exr

# missing points
refuses 3 'fit: holes.txt: .*--fill' fit holes.txt "${flags[@]}"
run 3 fit holes.txt "${flags[@]}" --level plane
err_has '^diffbench fit: holes.txt: 6 of 12000 heights are missing, expected --fill$'
run 3 fit holes.txt "${flags[@]}" --resample-nm 40
err_has 'holes.txt: resample-nm: resampling needs every height, and 6 of 12000 are missing: fill them first$'
for method in --fill --fill=plate --fill=laplace; do
    run 0 convert holes.txt "${flags[@]}" --level plane $method --out f.gsf
    err_has '^convert: fill.*: 6 points filled \(0.05 %\), the farthest [12] samples from a measured one, rms '
done
run 0 convert s.gsf --fill --out f.gsf
err_has '^convert: fill: nothing was missing, rms '

# geometry
run 0 convert s.gsf --crop-um 2:12,3:9 --out c.gsf
out_has ': 50 x 30 samples of 200 x 200 nm$'
err_has '^convert: crop-um 2:12,3:9: 50 x 30 samples of 200 x 200 nm \(from 128 x 128 of 200 x 200 nm\)$'
run 0 convert s.gsf --resample-nm 100 --out c.gsf
out_has ': 256 x 256 samples of 100 x 100 nm$'
psi_of() { run 0 fit "$@" --json --quiet && json psi_deg; }
near "azimuth" "$(psi_of s.gsf)" 10 0.01
near "turned with the sample" "$(psi_of s.gsf --rotate-deg 25)" 35 0.01
near "turned by a quarter" "$(psi_of s.gsf --rotate-deg 90)" 100 0.01
near "turned back" "$(psi_of s.gsf --rotate-deg -30)" 160 0.01
near "whole periods: normal on the axis" "$(psi_of s.gsf --whole-periods | sed 's/^1[78][0-9.]*$/0/; s/^0[0-9.]*$/0/')" 0 0
run 0 convert s.gsf --whole-periods --out w.gsf
err_has '^convert: whole-periods: 13 periods of 1600[0-9.]* nm along azimuth [0-9.]+ deg, '
near "13 periods wide" "$(sed -n 's/.* samples of \([0-9.]*\) x.*/\1/p' out | awk -v n="$(sed -n 's/.*: \([0-9]*\) x.*/\1/p' out)" '{ print $1 * n }')" 20800 3
run 0 fixture crossed --period-nm 1600 --height-nm 120 --size-um 25.6 --pixels 128 --out x.gsf
run 0 convert x.gsf --whole-periods --out w.gsf
err_has 'whole-periods: 15 periods of 113[0-9.]* nm along azimuth [0-9.]+ deg, 15 of 113[0-9.]* nm across, '

# calibration: the pitch that makes a known period
run 0 fit s.gsf --calibrate-nm 1650 --json
near "calibrated by itself" "$(json period_nm)" 1650 1e-3
run 0 convert s.gsf --calibrate-nm 1650 --out k.gsf
out_has ': 128 x 128 samples of 206.2[0-9]* x 206.2[0-9]* nm$'
ok "recorded" grep -a -q '^diffbench.preparation = calibrate-nm 1650: pitch multiplied by 1.0312[0-9]* +- ' k.gsf
run 0 convert scan.txt "${flags[@]}" --calibrate-nm 1650 --calibrate-with s.gsf --level plane --out k.gsf
err_has "calibrate-nm 1650: pitch multiplied by 1.03125[0-9]* .*nm fitted along azimuth 10[0-9.]* deg to 's.gsf', sha256 [0-9a-f]{64}\)"
run 0 convert scan.txt "${flags[@]}" --calibrate-nm 825 --calibrate-with scan.txt --level plane --out k.gsf
err_has "calibrate-nm 825: pitch multiplied by 1.03[0-9]* .* to 'scan.txt', sha256"
refuses 2 'fit: s.gsf: --calibrate-with needs --calibrate-nm' fit s.gsf --calibrate-with s.gsf
refuses 1 'fit: s.gsf: calibrate-nm: --calibrate-nm needs a period: no wave near 3 um' fit s.gsf --calibrate-nm 3000
refuses 3 'calibrate-nm: none.gsf: ' fit s.gsf --calibrate-nm 1650 --calibrate-with none.gsf

# drift
run 0 fit s.gsf
out_has '^drift      [+-][0-9.e-]+ \+- [0-9.e-]+ nm per um of y, '
out_has '^bands      y '
run 0 fit s.gsf --json
ok "eight bands" [ "$(json 'drift.bands#')" = 8 ]

# values
for bad in flat poly poly:9 poly:-1 poly:1.5 poly:x; do
    refuses 2 "fit: --level '$bad': unknown, expected none, auto, mean, plane or poly:N with N from 0 to 8" fit s.gsf --level $bad
done
refuses 2 "fit: --lines 'mean': unknown, expected median or diff" fit s.gsf --lines mean
refuses 2 "fit: --fill 'cubic': unknown, expected plate or laplace" fit s.gsf --fill=cubic
for flag in despike-nm despike-sigma scars-nm scars-sigma resample-nm highpass-um calibrate-nm; do
    refuses 2 "fit: --$flag '0': out of range, expected more than 0" fit s.gsf --$flag 0
    refuses 2 "fit: --$flag '1,5': not a number" fit s.gsf --$flag 1,5
done
refuses 2 "fit: --rotate-deg '400': out of range" fit s.gsf --rotate-deg 400
for bad in 1 1:2 1:2,3 1:2,3:4:5 a:b,c:d; do
    refuses 2 "fit: --crop-um '$bad': not a" fit s.gsf --crop-um $bad
done
refuses 2 "fit: --crop-um '2:1,0:1': an empty box" fit s.gsf --crop-um 2:1,0:1
refuses 2 "fit: s.gsf: crop-um: crop from x = 0 to 30 um, want a part of 0 to 25.6 um" fit s.gsf --crop-um 0:30,0:10
refuses 2 "fit: s.gsf: highpass-um: cut-off 0.3 um, want more than two pitches" fit s.gsf --highpass-um 0.3
steps=()
for i in $(seq 17); do steps+=(--level mean); done
refuses 2 "fit: --level 'mean': more than 16 steps" fit s.gsf "${steps[@]}"
finish
