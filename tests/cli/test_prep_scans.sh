#!/usr/bin/env bash
# What each preparation does to the period fitted to real scans, and to its uncertainty: prints a table (Markdown).
# Gratings are fitted by their heights, snakes (which have no single period) by the strongest ridge of a response table.
. "$(dirname "$0")/harness.sh" "$@"
needs_data afm/bipm_grating.gsf

bipm=("$data/afm/bipm_grating.gsf")
control=("$data/afm/text/gratinglab_synthetic_blazed_scan.txt")
elaphe=("$data/measured/elaphe_65um.png" --size-um 65 --height-um 0.375)
xeno=("$data/measured/xenopeltis_65um.png" --size-um 65 --height-um 0.81869)
jmarini=("$data/afm/jmarini_full_multiple_images.spm")

printf '| scan | preparation | period / nm | standard error / nm | drift over the scan | not explained |\n'
printf '| --- | --- | --- | --- | --- | --- |\n'

# heights NAME FLAGS... -- STEPS...: fits the heights; leaves period, error, drift and residual in variables of these names.
heights()
{
    local name=$1 flags=()
    shift
    while [ "$1" != -- ]; do flags+=("$1"); shift; done
    shift
    run 0 fit "${flags[@]}" --level none "$@" --json --quiet
    period=$(json period_nm) error=$(json period_uncertainty_nm) drift=$(json drift.share) residual=$(json residual_share)
    [ "$(json drift.significant)" = true ] && sure=yes || sure=no
    awk -v name="$name" -v steps="${*:-none}" -v p="$period" -v e="$error" -v d="$drift" -v r="$residual" -v sure="$sure" \
        'BEGIN { printf "| %s | %s | %.3f | %.3f | %+.2f %%%s | %.1f %% |\n", name, steps, p, e, 100 * d,
                 sure == "yes" ? " (sure)" : "", 100 * r }'
}

# stays TEXT FACTOR: the period lies within FACTOR of the larger error from that of the scan as it came.
stays()
{
    ok "$1: $period +- $error against $as_came +- $as_came_error" awk -v p="$period" -v e="$error" -v q="$as_came" \
        -v f="$as_came_error" -v k="$2" 'BEGIN { d = p - q; s = e > f ? e : f; exit !(d * d <= k * k * s * s) }'
}

heights BIPM "${bipm[@]}" --
as_came=$period as_came_error=$error as_came_residual=$residual
ok "the calibration grating's scan drifts" [ "$sure" = yes ]
for steps in '--level plane' '--level auto' '--lines median' '--lines diff' '--highpass-um 2' '--despike-sigma 8' \
    '--level auto --lines median' '--resample-nm 20'; do
    heights BIPM "${bipm[@]}" -- $steps
    stays "BIPM $steps" 1
    [ "$steps" = '--level auto' ] && ok "levelling leaves less unexplained" \
        awk -v a="$residual" -v b="$as_came_residual" 'BEGIN { exit !(a < 0.8 * b) }'
done
heights BIPM "${bipm[@]}" -- --rotate-deg 90
stays "a quarter turn changes but which samples are fitted" 0.2
# these keep only a part of a scan that drifts
for steps in '--rotate-deg 10' '--whole-periods' '--crop-um 0:5,2:5' '--crop-um 0:5,0:2'; do
    heights BIPM "${bipm[@]}" -- $steps
    stays "BIPM $steps" 5
done
heights BIPM "${bipm[@]}" -- --level auto --calibrate-nm 288
near "calibrated" "$period" 288 1e-3

heights control "${control[@]}" --
as_came=$period as_came_error=$error
for steps in '--level plane' '--lines median' '--highpass-um 2' '--rotate-deg 10' '--resample-nm 15' '--whole-periods'; do
    heights control "${control[@]}" -- $steps
    stays "synthetic grating of 315 nm, $steps" 3
done

# ridge NAME AZIMUTH FLAGS... -- STEPS...
ridge()
{
    local name=$1 azimuth=$2 flags=()
    shift 2
    while [ "$1" != -- ]; do flags+=("$1"); shift; done
    shift
    run 0 table "${flags[@]}" --level none "$@" --theta-i-deg 75 --azimuth-deg $azimuth --lambda-nm 380:780:16 \
        --angle-deg $range --out ridge.csv --quiet
    run 0 fit ridge.csv --json --quiet
    period=$(json period_nm) error=$(json period_uncertainty_nm) residual=$(json residual_share)
    awk -v name="$name" -v steps="${*:-none}" -v p="$period" -v e="$error" -v r="$residual" \
        'BEGIN { printf "| %s | %s | %.2f | %.2f | | %.1f %% |\n", name, steps, p, e, 100 * r }'
}
snake()
{
    local name=$1 azimuth=$2
    shift 2
    ridge "$name" $azimuth "$@" --
    as_came=$period as_came_error=$error
    for steps in '--level plane' '--lines median' '--highpass-um 20'; do
        ridge "$name" $azimuth "$@" -- $steps # which of several ridges is strongest may change: told, not judged
        ok "$name $steps: the ridges stay where they were" awk -v p="$period" -v q="$as_came" \
            'BEGIN { exit !(p > 0.85 * q && p < 1.15 * q) }'
    done
    ridge "$name" $((azimuth + 90)) "$@" -- --rotate-deg 90
    near "$name turned with the plane of incidence" "$period" "$as_came" 0.01
}
range=-40:-15:0.1 snake Elaphe 0 "${elaphe[@]}"
range=-50:-25:0.1 snake Xenopeltis 90 "${xeno[@]}"

# no grating before, none after: preparation invents no period
for steps in '--level none' '--level auto' '--level auto --lines median'; do
    refuses 1 'no period: ' fit "${jmarini[@]}" $steps --quiet
    printf '| NanoScope | %s | none | | | |\n' "$steps"
done
finish
