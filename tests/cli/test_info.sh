#!/usr/bin/env bash
# diffbench info
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 40 --pixels 256 --out s.exr
run 0 info s.exr
out_has '^s.exr: exr, "diffbench fixture sine"$'
out_has '^size +256 x 256 samples, pitch 156.25 x 156.25 nm, 40 x 40 um$'
out_has '^heights +-?[0-9.]+ to [0-9.]+ um \(range 0.1[12][0-9]* um\)'
out_has '^slopes +rms 0\.1[0-9]+ along x, [0-9.e-]+ along y'
out_has '^periods +1(599|600|60[0-9])[.0-9]* nm, groove normal at '
out_has '^sampling +NOT FINE ENOUGH at grazing angles for 380 nm'
out_has 'this pitch serves wavelengths from 625 nm$'
out_has '^accuracy +tol +sheet planes'
out_has '^trust'
out_has 'theta 75 deg: [a-z]+ at 380 nm, [a-z]+ at 780 nm$'
run 0 info s.exr --lambda-nm 650:780:10
out_has '^sampling +fine enough for 650 nm'

# slopes of a sinusoid: rms = pi H / d / sqrt(2), times sinc(2 pi pitch / d) by central differences
run 0 info s.exr --json --lambda-nm 400
near "rms slope" "$(json slopes.x_rms)" 0.15626 0.0005
near "slope across" "$(json slopes.y_rms)" 0 1e-6
near "finest wavelength" "$(json sampling.lambda_finest_nm)" 625 1e-6
ok "not fine enough" [ "$(json sampling.fine_enough)" = false ]
near "phase 2 pi 0.12/0.4" "$(json phase_rad)" 1.88 0.02
near "four tolerances" "$(json 'accuracy#')" 4 0
ok "more planes for a smaller tol" [ "$(json accuracy.3.sheet_planes)" -gt "$(json accuracy.0.sheet_planes)" ]
ok "more terms for a smaller tol" [ "$(json accuracy.3.taylor_terms)" -gt "$(json accuracy.0.taylor_terms)" ]

# how far to trust it: a gentle sinusoid near normal incidence, less at 75 deg; walls never so far
run 0 fixture sine --period-nm 5000 --height-nm 100 --size-um 40 --pixels 256 --out gentle.gsf
run 0 info gentle.gsf --json --lambda-nm 400:700:10
ok "gentle at 0 deg" [ "$(json trust.0.trust)" = shares ]
ok "gentle at 75 deg" [ "$(json trust.4.trust)" = dominant ]
run 0 fixture blazed --period-nm 5000 --height-nm 100 --size-um 40 --pixels 256 --out walls.gsf
run 0 info walls.gsf --json --lambda-nm 400:700:10
ok "walls at 0 deg" [ "$(json trust.0.trust)" = dominant ]
ok "walls at 75 deg" [ "$(json trust.4.trust)" = none ]
run 0 info walls.gsf
out_has '^ +none: Scalar theory does not'

# images: quantisation
"$tool" png 64 32 p.png
run 0 info p.png --size-um 6.4 --height-um 0.255
err_has '8.bit'
out_has 'quantised in steps of 1 nm \(8 bit\)'
out_has '^size +64 x 32 samples, pitch 100 x 100 nm'
run 0 info p.png --size-um 6.4 --height-um 0.255 --quiet
ok "--quiet keeps the warning back" [ ! -s err ]

# tables
run 0 table s.exr --theta-r-deg 30 --angle-deg -10:10:1 --lambda-nm 500:600:50 --out t.csv
run 0 info t.csv
out_has '^t.csv: response table, rho'
out_has '^plan +theta_r 30 deg fixed, plane at azimuth 0 deg$'
out_has '^angles +21 from -10 to 10 deg$'
out_has '^ +tol: 1e-06$'
run 0 info t.csv --json
ok "a table" [ "$(json kind)" = table ]
ok "its own provenance" [ "$(json table_provenance.method)" = sheet ]

# text that names its size
printf '# Channel: T\n# Width: 3 um\n# Height: 2 um\n# Value units: nm\n0 10 20\n5 15 30\n' >t.txt
run 0 info t.txt
out_has '^size +3 x 2 samples, pitch 1000 x 1000 nm'
out_has '^heights +0 to 0.03 um'
finish
