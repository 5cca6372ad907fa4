#!/usr/bin/env bash
# diffbench fit
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture blazed --period-nm 2500 --height-nm 250 --size-um 65 --pixels 1332 --out b.gsf
run 0 table b.gsf --theta-i-deg 75 --angle-deg -55:-40:0.05 --lambda-nm 380:780:10 --out b.csv

run 0 fit b.csv --json
ok "read as a table" [ "$(json kind)" = table ]
period=$(json period_nm)
error=$(json period_uncertainty_nm)
near "period" "$period" 2500 0.5
ok "the stated error is the largest one" awk -v u="$error" -v a="$(json period_sd_nm)" -v b="$(json period_scatter_nm)" \
    -v c="$(json period_model_nm)" 'BEGIN { m = a > b ? a : b; m = m > c ? m : c; exit !(u >= m * 0.999999 && u <= m * 1.000001) }'
ok "2500 lies within three errors of $period +- $error" awk -v p="$period" -v u="$error" \
    'BEGIN { d = p - 2500; exit !(d * d <= 9 * u * u) }'
near "order" "$(json ridges.0.order)" 1 0
ok "a grating of ours has one period" [ "$(json common_period)" = true ]
run 0 fit b.csv
out_has '^period +2[45][0-9.]+ nm \+- [0-9.]+ nm \(one standard error'
out_has 'covariance [0-9.e-]+ nm, scatter over [0-9]+ disjoint parts [0-9.e-]+ nm, model [0-9.e-]+ nm$'
out_has '^ridges +order +period_nm'

# heights
run 0 fit b.gsf --json
ok "read as a surface" [ "$(json kind)" = surface ]
near "period" "$(json period_nm)" 2500 0.6
run 0 fit b.gsf
out_has '^period +2[45][0-9.]+ nm \+- '
out_has '^groove +normal at azimuth'

# a table without provenance: free line, or what flags say
grep -v '^#' b.csv >bare.csv
run 0 fit bare.csv --json --quantity rho
ok "each its own period" [ "$(json common_period)" = false ]
near "period with a free line" "$(json period_nm)" 2500 3
refuses 2 'bare.csv: .*--line known, but the table does not tell its window, expected --window' fit bare.csv --line known
run 0 fit bare.csv --quantity rho --window gauss --sigma-um 16.25 --patch-x-um 65 --patch-y-um 65 --json
near "period with the line that flags give" "$(json period_nm)" 2500 0.5

# what is no grating has no period
awk 'BEGIN {
    print "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value"
    for (l = 500; l <= 600; l += 10) for (a = -20; a <= 20; a += 1) printf "10,0,%.9g,0,%.9g,1\n", a, l }' >flat.csv
refuses 1 'fit: flat.csv: no period: .* \(if it is a grating: --periods common\)$' fit flat.csv
run 0 fixture flat --pixels 64 --size-um 10 --out flat.gsf
refuses 1 'fit: flat.gsf: no period: ' fit flat.gsf
run 0 fixture random --pixels 128 --size-um 20 --seed 3 --out random.gsf
refuses 1 'fit: random.gsf: no period: ' fit random.gsf

# shadowing scales lines: said, and the period moves by less than its uncertainty
run 0 fixture blazed --period-nm 2500 --height-nm 250 --size-um 40 --pixels 800 --out dark.gsf
run 0 table dark.gsf --theta-i-deg 75 --angle-deg -55:-40:0.1 --lambda-nm 380:780:20 --shadowing smith --out dark.csv
run 0 fit dark.csv --json
err_has '^fit: the table holds smith shadowing'
near "period of a shadowed table" "$(json period_nm)" 2500 0.5

refuses 3 'fit: none.csv: ' fit none.csv
refuses 2 "fit: --ridges '17': out of range, expected at least 1 and at most 16" fit b.csv --ridges 17
refuses 2 "fit: --parts '1': out of range" fit b.csv --parts 1
finish
