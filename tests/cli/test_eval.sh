#!/usr/bin/env bash
# diffbench eval
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 40 --pixels 256 --out s.exr
cat >q.csv <<'END'
# directions of an imaginary goniometer
lambda_nm,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg
550,20,0,-20,0
550,20,0,20,180
450,30,40,10,250
700,60,-30,5,0
END
run 0 eval s.exr --queries q.csv --tol 1e-9
out_has '^theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,power,rho,brdf$'
out_has "^# queries_sha256: $(sha256sum q.csv | cut -c1-64)\$"
rows out >rows
ok "four rows in order" [ "$(cut -d, -f5 rows | tr '\n' ' ')" = "550 550 450 700 " ]
ok "-theta is azimuth + 180" [ "$(sed -n 1p rows | cut -d, -f6 | cut -c1-9)" = "$(sed -n 2p rows | cut -d, -f6 | cut -c1-9)" ]
mirror=$(sed -n 1p rows | cut -d, -f6)

# J_0(k w H/2)^2 with w = 2 cos 20, H = 120 nm
near "mirror order of the sinusoid" "$mirror" "$(awk 'BEGIN {
    x = 2 * 3.14159265358979 / 550 * 2 * cos(20 / 57.29577951308232) * 60
    n = 2000; for (i = 0; i < n; i++) j += cos(x * sin(3.14159265358979 * (i + 0.5) / n)) / n; printf "%.12g", j * j }')" 1e-4

# against the direct sum, amplitudes
run 0 eval s.exr --queries q.csv --tol 1e-9 --amplitude
rows out | cut -d, -f9,10 >sheet
out_has '^theta_i_deg.*brdf,amplitude_re,amplitude_im$'
out_has '^# average: none$'
run 0 eval s.exr --queries q.csv --method direct --amplitude
rows out | cut -d, -f9,10 >direct
ok "amplitudes to 1e-9" bash -c 'paste -d, sheet direct | awk -F, "
    { d = (\$1 - \$3)^2 + (\$2 - \$4)^2; if (d > 1e-18) exit 1 }"'

# the check does the same
run 0 eval s.exr --queries q.csv --check 3 --tol 1e-9
err_has 'checked 3 queries: largest amplitude error [0-9.e-]+ \(tol 1e-09\) at query [1-4]$'
out_has '^# check_worst_amplitude_error: '
run 0 eval s.exr --queries q.csv --check 99 --average welch --sigma-um 5
err_has 'checked 4 queries'
run 1 eval s.exr --queries q.csv --check 4 --method taylor --terms 1 --quiet
err_has '^diffbench eval: s.exr: amplitude error .* at query [1-4], expected at most 1e-06 \(--tol\)$'

# stdin, files, JSON
"$program" eval s.exr --queries - --quiet <q.csv >piped 2>err
ok "stdin as a file" cmp -s <(rows piped) <("$program" eval s.exr --queries q.csv --quiet | grep -v '^#' | tail -n +2)
cat q.csv | "$program" eval s.exr --queries - --quiet >piped2 2>err
ok "stdin as a pipe" cmp -s <(rows piped) <(rows piped2)
run 0 eval s.exr --queries q.csv --out e.csv --quiet
ok "a file" cmp -s <(rows e.csv) <(rows piped)
run 0 eval s.exr --queries q.csv --json --amplitude --tol 1e-9
near "four samples" "$(json 'samples#')" 4 0
near "power" "$(json samples.0.power)" "$mirror" 1e-9
near "amplitude" "$(json samples.0.amplitude_re)" "$(head -1 sheet | cut -d, -f1)" 1e-12

refuses 2 'eval: no queries, expected --queries' eval s.exr
refuses 2 'eval: --amplitude with --average welch' eval s.exr --queries q.csv --amplitude --average welch
refuses 2 'eval: --quantity: unknown flag' eval s.exr --queries q.csv --quantity rho
refuses 3 'eval: none.csv: ' eval s.exr --queries none.csv
refuses 3 'eval: none.exr: ' eval none.exr --queries q.csv
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm\n' >empty.csv
refuses 3 'eval: empty.csv: ' eval s.exr --queries empty.csv
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n1,2,3,4\n' >short.csv
refuses 3 'eval: short.csv: .*lambda_nm' eval s.exr --queries short.csv
for bad in 90,0,0,0,500 0,0,-95,0,500 0,0,0,0,0 0,0,0,0,-500 0,0,0,0,nan 0,0,0,0 0,0,0,0,500x inf,0,0,0,500; do
    printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm\n1,0,2,0,500\n%s\n' "$bad" >bad.csv
    refuses 3 'eval: bad.csv: .*(line|row) 3' eval s.exr --queries bad.csv
done

# shadowing keeps the BRDF reciprocal and the power as it is
run 0 fixture random --size-um 10 --pixels 128 --height-nm 300 --out rough.gsf
printf '%s\n' theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm 75,10,40,200,550 40,200,75,10,550 >pairs.csv
run 0 eval rough.gsf --queries pairs.csv --sigma-um 3 --json
power=$(json samples.0.power)
brdf=$(json samples.0.brdf)
for kind in vcavity smith ndf; do
    run 0 eval rough.gsf --queries pairs.csv --sigma-um 3 --shadowing $kind --json
    ok "$kind: the power stays" [ "$(json samples.0.power)" = "$power" ]
    ok "$kind: the BRDF shrinks" awk -v a="$(json samples.0.brdf)" -v b="$brdf" 'BEGIN { exit !(a < b) }'
    ok "$kind: reciprocal" awk -v a="$(json samples.0.brdf)" -v b="$(json samples.1.brdf)" 'BEGIN { exit !(a / b > 0.999999 && a / b < 1.000001) }'
done
finish
