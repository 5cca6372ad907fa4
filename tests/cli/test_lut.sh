#!/usr/bin/env bash
# diffbench lut
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture flat --size-um 10 --pixels 64 --out flat.gsf
run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 20 --pixels 128 --out sine.exr
small=(--azimuths 128 --radii 64 --sigma-um 3 --lambda-nm 400:700:25)

# a mirror at the mirror direction is D65's white
run 0 lut flat.gsf "${small[@]}" --out flat.lut.exr
err_has '128 azimuths x 64 radii x 1 maps from 13 wavelengths, 1 window'
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n20,0,-20,0\n20,0,20,180\n55,30,-55,30\n0,0,0,0\n' >d.csv
run 0 lut flat.lut.exr --eval d.csv --quantity power
out_has '^theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,X,Y,Z,R,G,B$'
out_has '^# table_window: gauss$'
out_has '^# table_lut_version: 1$'
rows out >rows
ok "four rows" [ "$(wc -l <rows)" -eq 4 ]
while IFS=, read -r _ _ _ _ x y z r g b; do
    near X "$x" 0.95047 2e-4
    near Y "$y" 1 2e-4
    near Z "$z" 1.08883 2e-4
    for c in "$r" "$g" "$b"; do
        near "white" "$c" 1 5e-4
    done
done <rows

# against full sampling: the figures are printed, a fine table is good
run 0 lut sine.exr --azimuths 1024 --radii 256 --sigma-um 3 --lambda-nm 400:700:25 --tol 1e-5 --check 100 --out sine.lut.exr --json
err_has 'against full spectral sampling in 100 random direction pairs'
err_has 'CIEDE2000, 99th percentile of Y shown white +median [0-9.e-]+, p95 [0-9.e-]+, worst [0-9.e-]+$'
ok "tail below tol" awk -v t="$(json tail)" 'BEGIN { exit !(t > 0 && t < 1e-5) }'
near "median error, share of the brightest" "$(json check.of_brightest.median)" 0 1e-4
near "median CIEDE2000" "$(json check.de2000.median)" 0 0.1
near "p95 CIEDE2000" "$(json check.de2000.p95)" 0 0.5

# the table's Y is the sum of what eval says, one wavelength each (D65 and the observer at 400:700:25 nm are in the map)
run 0 lut sine.lut.exr --eval d.csv --json
near "rows in JSON" "$(json 'samples#')" 4 0
run 0 map sine.exr --theta-i-deg 0 --pixels 16 --sigma-um 3 --lambda-nm 400:700:25 --quantity power --png m.png --json
peak_y=$(json light.peak_Y)
awk -v t="$(json light.peak_theta_deg)" -v p="$(json light.peak_phi_deg)" 'BEGIN {
    print "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm"; printf "0,0,%.12g,%.12g,550\n", t, p }' >peak.csv
run 0 lut sine.lut.exr --eval peak.csv --quantity power --json
near "the map's brightest pixel" "$(json samples.0.Y)" "$peak_y" "$(awk -v y="$peak_y" 'BEGIN { print 0.02 * y }')"

# stdin, a file, the source's diameter
"$program" lut sine.lut.exr --eval - --quiet <d.csv >piped 2>err
run 0 lut sine.lut.exr --eval d.csv --out e.csv
ok "stdin and file" cmp -s <(rows piped) <(rows e.csv)
run 0 lut sine.exr "${small[@]}" --maps 5 --source-deg 0.53 --out sun.exr
err_has 'x 5 maps'
run 0 lut sine.exr "${small[@]}" --maps 20 --out many.exr
err_has 'a pixel costs 19 texture reads on a GPU, more than the 16 that real time allows: --maps 16'

# the same bytes whatever the number of threads
for n in 1 3; do
    last="lut with $n threads"
    SOURCE_DATE_EPOCH=1700000000 OMP_NUM_THREADS=$n "$program" lut sine.exr "${small[@]}" --quiet --out t.exr 2>err
    mv t.exr t$n.exr
done
ok "the table does not depend on threads" cmp -s t1.exr t3.exr

# bad tables
head -c 100000 sine.lut.exr >cut.exr
refuses 3 'lut: cut.exr: EXR' lut cut.exr --eval d.csv
refuses 3 'lut: sine.exr: not a table' lut sine.exr --eval d.csv
refuses 3 'lut: d.csv: not an EXR file' lut d.csv --eval d.csv
sed 's/\(lut_version.string.....\)1/\12/' <t1.exr >old.exr
refuses 3 'lut: old.exr: table of version 2, want 1: build it again' lut old.exr --eval d.csv
refuses 3 "info: t1.exr: holds 'lut: x = azimuth, y = radius', want a heightfield" info t1.exr --pixel-nm 10

refuses 2 'lut: expected --out F.exr to build a table' lut sine.exr
refuses 2 "lut: --azimuths '15': out of range" lut sine.exr --out x.exr --azimuths 15
refuses 2 "lut: --radii '1000000': out of range" lut sine.exr --out x.exr --radii 1000000
refuses 2 "lut: --maps '0': out of range" lut sine.exr --out x.exr --maps 0
refuses 2 'lut: --tol 1e-09: expected at least 1e-6' lut sine.exr --out x.exr --tol 1e-9
refuses 2 'lut: --method direct: tables are built by the sheet transform' lut sine.exr --out x.exr --method direct
refuses 2 'lut: --quantity brdf' lut sine.lut.exr --eval d.csv --quantity brdf
refuses 2 'lut: --check with --eval' lut sine.lut.exr --eval d.csv --check 5
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n95,0,0,0\n' >bad.csv
refuses 3 'lut: bad.csv: line 2: theta_i_deg is 95' lut sine.lut.exr --eval bad.csv
printf 'theta_i_deg,phi_i_deg\n5,0\n' >bad.csv
refuses 3 'lut: bad.csv: .*theta_r_deg' lut sine.lut.exr --eval bad.csv
ok "nothing left behind" [ -z "$(find . -name 'x.*')" ]
finish
