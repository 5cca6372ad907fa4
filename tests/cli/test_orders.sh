#!/usr/bin/env bash
# diffbench orders
. "$(dirname "$0")/harness.sh" "$@"

# d = 2500 nm, 75 deg, 550 nm: sin theta_m = 0.22 m - sin 75
run 0 orders --period-nm 2500 --theta-i-deg 75 --lambda-nm 550
out_has '^lambda_nm,order,propagates,theta_r_deg,phi_r_deg,angle_deg$'
rows out >rows
ok "order 0 is the mirror" grep -Eq '^550,0,1,75,(-)?180,-75$' rows
angle=$(awk -F, '$2 == 1 { print $6 }' rows)
near "order 1" "$angle" -48.2386821399 1e-8
ok "evanescent ones at both ends" [ "$(awk -F, '$3 == 0' rows | wc -l)" -eq 2 ]
ok "they have no direction" grep -Eq '^550,-1,0,nan,nan,nan$' rows
ok "nine propagate" [ "$(awk -F, '$3 == 1' rows | wc -l)" -eq 9 ]

# a sinusoid's closed form J_m(k w H/2)^2 at normal incidence, mirror order: J_0(2 pi 250/550)^2
run 0 orders --period-nm 5000 --theta-i-deg 0 --lambda-nm 550 --profile sine --height-nm 250 --json
near "lambda" "$(json wavelengths.0.lambda_nm)" 550 0
zero=$("$tool" json wavelengths.0.orders <out | tr '{' '\n' | grep '"order": 0,' | sed 's/.*"power": \([^,}]*\).*/\1/')
near "power of order 0" "$zero" 0.0430357890812 1e-12
sum=$(json wavelengths.0.efficiency_sum)
near "a gentle sinusoid keeps its energy" "$sum" 1 0.05

# conical incidence: along the grooves each order keeps u along them
run 0 orders --period-nm 2500 --theta-i-deg 30 --phi-i-deg 90 --lambda-nm 500 --order-range 1:1:1
near "theta of order 1" "$(rows out | cut -d, -f4)" "$(awk 'BEGIN { s = sqrt(0.25 + 0.04); printf "%.12g", atan2(s, sqrt(1 - s*s)) * 57.29577951308232 }')" 1e-9
near "azimuth of order 1" "$(rows out | cut -d, -f5)" "$(awk 'BEGIN { printf "%.12g", atan2(-0.5, 0.2) * 57.29577951308232 }')" 1e-9
ok "out of plane: no signed angle" [ "$(rows out | cut -d, -f6)" = nan ]

# a range of wavelengths, a file, a real index
run 0 orders --period-nm 2500 --theta-i-deg 20 --lambda-nm 400:700:100 --profile lamellar --height-nm 100 --duty 0.4 \
    --n 1.5 --out o.csv
ok "nothing on stdout" [ ! -s out ]
ok "provenance" grep -q '^# command' o.csv
ok "four wavelengths" [ "$(rows o.csv | cut -d, -f1 | sort -u | wc -l)" -eq 4 ]
ok "sum of glass below 6 %" awk -F, '!/^#/ && $9 + 0 > 0.06 { exit 1 }' o.csv

# as queries for eval
run 0 orders --period-nm 2500 --theta-i-deg 75 --lambda-nm 550 --queries
out_has '^theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm$'
ok "nine queries" [ "$(rows out | wc -l)" -eq 9 ]

refuses 2 'orders: no grating, expected --period-nm' orders --theta-i-deg 0 --lambda-nm 500
refuses 2 'orders: no angle of incidence' orders --period-nm 1000 --lambda-nm 500
refuses 2 'orders: no wavelength' orders --period-nm 1000 --theta-i-deg 0
refuses 2 'orders: --profile without its height' orders --period-nm 1000 --theta-i-deg 0 --lambda-nm 500 --profile sine
refuses 2 'orders: --kappa without --n' orders --period-nm 1000 --theta-i-deg 0 --lambda-nm 500 --kappa 1
refuses 2 'orders: --order-range: orders are whole' orders --period-nm 1000 --theta-i-deg 0 --lambda-nm 500 \
    --order-range 0:1:0.5
refuses 2 'rows, expected fewer' orders --period-nm 1e15 --theta-i-deg 0 --lambda-nm 500
refuses 2 "orders: x.csv: one operand too many, expected none" orders x.csv
finish
