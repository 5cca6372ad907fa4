#!/usr/bin/env bash
# Real scans: the maxima of one centred window, and periods of calibrated and synthetic gratings.
. "$(dirname "$0")/harness.sh" "$@"
needs_data measured/xenopeltis_65um.png

xeno=("$data/measured/xenopeltis_65um.png" --size-um 65 --height-um 0.81869)
elaphe=("$data/measured/elaphe_65um.png" --size-um 65 --height-um 0.375)
plan=(--theta-i-deg 75 --lambda-nm 380:780:1)

# the figures that direct sums in extended precision gave
measure()
{
    local name=$1 azimuth=$2 range=$3 want=$4
    shift 4
    run 0 table "$@" "${plan[@]}" --azimuth-deg $azimuth --angle-deg $range --average none --quantity power \
        --out $name.exr --quiet
    run 0 maxima $name.exr --json
    near "$name at azimuth $azimuth" "$(json first_order.mean_nm)" $want 0.1
}
measure x90 90 -50:-25:0.01 1436.6 "${xeno[@]}"
measure x270 270 -50:-25:0.01 1553.3 "${xeno[@]}"
measure e180 180 -40:-15:0.01 1126.8 "${elaphe[@]}"

run 0 table "${xeno[@]}" "${plan[@]}" --azimuth-deg 90 --angle-deg -50:-25:0.05 --out w.csv
err_has '8.bit'
err_has 'average welch \(by default'

# several ridges are told as such, with weights, not as one period
run 0 table "${elaphe[@]}" --theta-i-deg 75 --lambda-nm 380:780:4 --azimuth-deg 0 --angle-deg -40:-15:0.05 --out e0.csv --quiet
run 0 fit e0.csv
out_has '^strongest +[0-9.]+ nm \+- '
out_has '^ +of [0-9]+ ridges, [0-9]+ % of the power: no single period$'
run 0 fit e0.csv --json
ok "several ridges" [ "$(json 'ridges#')" -gt 1 ]
near "weights sum to 1" "$("$tool" json ridges <out | sed 's/}/\n/g' | sed -n 's/.*"weight": \([0-9.e-]*\).*/\1/p' |
    awk '{ sum += $1 } END { print sum }')" 1 1e-4

# periods of surfaces
run 0 fit "$data/afm/bipm_grating.gsf" --json
near "grating of the BIPM" "$(json period_nm)" 287.99 0.6
ok "the scatter is stated, not the covariance" awk -v u="$(json period_uncertainty_nm)" 'BEGIN { exit !(u > 0.05 && u < 1) }'
finish
