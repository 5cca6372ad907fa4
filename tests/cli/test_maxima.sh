#!/usr/bin/env bash
# diffbench maxima
. "$(dirname "$0")/harness.sh" "$@"

# one ridge whose place is exact: a parabola around sin(theta_r) = 500..600 nm / 1000 nm - sin(10 deg)
awk 'BEGIN {
    print "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value"
    for (l = 500; l <= 600; l += 50) {
        s = l / 1000 - sin(10 / 57.29577951308232); c = atan2(s, sqrt(1 - s * s)) * 57.29577951308232
        for (a = 15; a <= 30; a += 0.5) printf "10,0,%.9g,0,%.9g,%.12g\n", a, l, 100 - (a - c) * (a - c)
    } }' >t.csv

run 0 maxima t.csv --period-nm 1000
out_has '^t.csv: 3 maxima at 3 wavelengths$'
out_has 'mean 1000 nm, standard deviation [0-9.e-]+ nm, from .* to .* nm, 3 wavelengths$'
out_has '^ +1 +3 '
run 0 maxima t.csv --period-nm 1000 --json
near "mean" "$(json first_order.mean_nm)" 1000 1e-5
near "residual" "$(json orders.0.worst_deg)" 0 1e-6
near "one order" "$(json 'orders#')" 1 0
near "three maxima" "$(json 'maxima#')" 3 0
near "angle of the first" "$(json maxima.0.angle_deg)" "$(awk 'BEGIN { s = 0.5 - sin(10 / 57.29577951308232); printf "%.12g", atan2(s, sqrt(1 - s * s)) * 57.29577951308232 }')" 1e-6

# without a period: the statistic alone
run 0 maxima t.csv
out_has 'mean 1000 nm'
out_lacks 'order'

# CSV
run 0 maxima t.csv --period-nm 1000 --out m.csv
ok "columns" grep -q '^lambda_nm,angle_deg,value,order,residual_deg,period_nm,is_global,at_edge$' m.csv
ok "three rows" [ "$(rows m.csv | wc -l)" -eq 3 ]
ok "provenance" grep -q "^# input_sha256: $(sha256sum t.csv | cut -c1-64)" m.csv
run 0 maxima t.csv --period-nm 1000 --out -
ok "the CSV alone on stdout" [ "$(grep -vc '^#' out)" -eq 4 ]

# limits
run 0 maxima t.csv --period-nm 1000 --max-residual-deg 0.001
run 1 maxima t.csv --period-nm 1010 --max-residual-deg 0.1
err_has '^diffbench maxima: t.csv: order 1 is [0-9.]+ deg off, expected at most 0.1 \(--max-residual-deg\)$'
refuses 2 'maxima: --max-residual-deg without orders, expected --period-nm' maxima t.csv --max-residual-deg 1

# the largest value at the edge of the range is said to be no maximum
grep -E '^(theta|10,0,(15|15.5|16|16.5|17|17.5),)' t.csv >edge.csv
run 0 maxima edge.csv
out_has '^at [123] wavelengths? the largest value lies at the edge'

refuses 3 'maxima: none.csv: ' maxima none.csv
run 0 fixture flat --pixels 8 --size-um 1 --out f.gsf
refuses 3 'maxima: f.gsf: ' maxima f.gsf
finish
