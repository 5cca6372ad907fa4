#!/usr/bin/env bash
# diffbench table
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture blazed --pixels 256 --size-um 32.5 --period-nm 2500 --height-nm 250 --out b.gsf
plan=(--theta-i-deg 75 --angle-deg -55:-40:0.25 --lambda-nm 400:700:50)

run 0 table b.gsf "${plan[@]}"
err_has 'rho of 61 angles x 7 wavelengths, average none \(by default; --average chooses\)'
err_has 'planes, .* taps, .* amplitude error at most'
out_has '^theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value$'
ok "427 rows" [ "$(rows out | wc -l)" -eq 427 ]
for key in program version command input input_sha256 quantity quantity_unit fixed_angle fixed_deg method tol bound window sigma_um average patch_x_um \
    patch_y_um pitch_x_nm index_n index_kappa azimuth_deg normalisation directions units; do
    out_has "^# $key: "
done
ok "the input's sha256" grep -q "$(sha256sum b.gsf | cut -c1-64)" out
cp out b.csv

# every method gives the same to tol; the check agrees
for method in taylor direct; do
    run 0 table b.gsf "${plan[@]}" --tol 1e-9 --method $method --quantity power
    rows out | cut -d, -f6 >$method
done
run 0 table b.gsf "${plan[@]}" --tol 1e-9 --quantity power
rows out | cut -d, -f6 >sheet
for method in taylor direct; do
    ok "sheet and $method agree" bash -c 'paste -d, sheet $0 | awk -F, "{ d = \$1 - \$2; if (d*d > 1e-16) exit 1 }"' $method
done
run 0 table b.gsf "${plan[@]}" --check 50 --out checked.csv
err_has 'checked 50 cells: largest amplitude error'
ok "the check is in the file" grep -q '^# check_worst_amplitude_error: ' checked.csv
run 1 table b.gsf "${plan[@]}" --method taylor --terms 1 --check 50 --quiet --out bad.csv
err_has '^diffbench table: b.gsf: amplitude error .* expected at most 1e-06 \(--tol\)$'

# layouts and formats hold the same numbers
run 0 table b.gsf "${plan[@]}" --layout matrix --out m.csv
run 0 table b.gsf "${plan[@]}" --out t.exr
ok "stdout is empty" [ ! -s out ]
run 0 info m.csv --json
near "largest value of the matrix" "$(json max)" "$(rows b.csv | cut -d, -f6 | sort -g | tail -1)" 1e-9
ok "seven wavelengths" [ "$(json n_lambda)" -eq 7 ]
run 0 info t.exr --json
near "largest value of the EXR" "$(json max)" "$(rows b.csv | cut -d, -f6 | sort -g | tail -1)" 1e-6
near "fixed angle" "$(json fixed_deg)" 75 1e-9
ok "fixed side" [ "$(json fixed_angle)" = theta_i ]

# the other side fixed: reciprocity of the power
run 0 table b.gsf --theta-r-deg 75 --angle-deg -55:-40:0.25 --lambda-nm 400:700:50 --tol 1e-9 --quantity power
ok "reciprocal" bash -c 'paste -d, sheet <(grep -v "^#" out | tail -n +2 | cut -d, -f6) |
    awk -F, "{ d = \$1 - \$2; if (d*d > 1e-16) exit 1 }"'
out_has '^# fixed_angle: theta_r$'

# JSON: everything on stdout, or what it was if the table went to a file
run 0 table b.gsf "${plan[@]}" --json
near "angles" "$(json 'angle_deg#')" 61 0
near "first angle" "$(json angle_deg.0)" -55 1e-12
near "rows" "$(json 'value#')" 7 0
near "first value" "$(json value.0.0)" "$(rows b.csv | head -1 | cut -d, -f6)" 1e-9
run 0 table b.gsf "${plan[@]}" --json --out j.csv --average welch --sigma-um 4
ok "welch" [ "$(json provenance.average)" = welch ]
ok "several windows" [ "$(json cost.windows)" -gt 1 ]
ok "the file it names" [ -s "$(json out)" ]

# defaults: what is not ours is averaged
cp b.gsf other.gsf
sed -i 's/diffbench\.fixture/something.fixture/' other.gsf
run 0 table other.gsf "${plan[@]}" --out o.csv
err_has 'average welch \(by default'

# a run's bytes depend on its input alone
export SOURCE_DATE_EPOCH=1700000000
run 0 table b.gsf "${plan[@]}" --out same.csv
cp same.csv first.csv
run 0 table b.gsf "${plan[@]}" --out same.csv
ok "byte-identical" cmp -s same.csv first.csv

# surfaces that need flags
"$tool" png 64 64 p.png
refuses 3 'table: p.png: .*(--pixel-nm|--size-um)' table p.png "${plan[@]}" --height-um 0.3
refuses 3 'table: p.png: .*--height-um' table p.png "${plan[@]}" --size-um 10
run 0 table p.png "${plan[@]}" --size-um 10 --height-um 0.3
err_has '8.bit'
printf '0 1 2\n3 4 5\n1 0 1\n' >m.txt
refuses 3 'table: m.txt: .*--pixel-nm' table m.txt "${plan[@]}" --z-unit nm
refuses 3 'table: m.txt: .*--z-unit' table m.txt "${plan[@]}" --pixel-nm 100
run 0 table m.txt "${plan[@]}" --pixel-nm 100 --z-unit nm
run 0 fixture sine --pixels 32 --size-um 10 --out s.exr
refuses 3 'table: s.exr: .*' table s.exr "${plan[@]}" --channel nowhere

# the methods for comparison: each runs, says what it leaves out, and pq and stam take or find a period
run 0 fixture blazed --pixels 520 --size-um 26 --out g.exr
line=(--theta-i-deg 75 --angle-deg -55:-45:0.02 --lambda-nm 500:600:50 --sigma-um 6.5)
for method in thesis nmm stam; do
    run 0 table g.exr "${line[@]}" --method $method --out $method.csv
    ok "$method has no bound" grep -q '^# bound: none: ' $method.csv
done
run 0 table g.exr "${line[@]}" --method pq --grating-nm 2500 --replicas 400 --out pq.csv
ok "pq says what it replicated" grep -q '^# grating: 2500 nm along azimuth 0 deg, 400 x' pq.csv
run 0 maxima pq.csv
ok "400 replicas lie on the grating equation" awk '/^  mean/ { exit !($2 > 2499.9 && $2 < 2500.1) }' out
run 0 table g.exr "${line[@]}" --method stam
err_has 'stam: period (2499.9|2500.0)[0-9]* nm along azimuth'
refuses 2 'larger than the patch' table g.exr "${line[@]}" --method pq --grating-nm 30000
run 0 fixture random --pixels 64 --size-um 3 --out r.exr
refuses 1 'table: r.exr: pq needs a period.*--grating-nm' table r.exr "${line[@]}" --method pq
refuses 2 'table: --replicas' table g.exr "${line[@]}" --method pq --replicas 0

# shadowing scales rho, is 1 where nothing hides, and says so
run 0 fixture random --size-um 10 --pixels 128 --height-nm 300 --out rough.gsf
shadow=(rough.gsf --theta-i-deg 70 --angle-deg -80:80:40 --lambda-nm 550 --sigma-um 3)
run 0 table "${shadow[@]}"
out_has '^# normalisation: rho = .*, no shadowing$'
rows out >bare
for kind in vcavity smith ndf; do
    run 0 table "${shadow[@]}" --shadowing $kind --check 5
    out_has "^# shadowing: $kind$"
    out_has '^# normalisation: rho = .* p S$'
    rows out >seen
    ok "$kind leaves less, never more" awk -F, 'NR == FNR { bare[NR] = $6; next } { if ($6 > bare[FNR]) bad = 1; if ($6 < bare[FNR]) less = 1 }
        END { exit bad || !less }' bare seen
done
run 0 table "${shadow[@]}" --quantity power
rows out >bare
run 0 table "${shadow[@]}" --quantity power --shadowing ndf
rows out >seen
ok "power knows no shadowing" cmp -s bare seen
refuses 2 "table: --shadowing 'torrance': unknown, expected one of none\|vcavity\|smith\|ndf" table "${shadow[@]}" --shadowing torrance
refuses 3 "table: the source's program has no smith shadowing" table "${shadow[@]}" --method thesis --shadowing smith --quiet
finish
