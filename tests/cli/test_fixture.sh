#!/usr/bin/env bash
# diffbench fixture
. "$(dirname "$0")/harness.sh" "$@"

for kind in flat sine blazed lamellar triangle crossed random elaphe xenopeltis cd; do
    run 0 fixture $kind --pixels 64 --size-um 10 --out $kind.gsf
    err_has "$kind, 64 x 64 samples, pitch 156.25 nm"
    ok "a file" [ -s $kind.gsf ]
    run 0 info $kind.gsf --json
    ok "info says $kind" [ "$(json title)" = "diffbench fixture $kind" ]
done

# what was asked for is in the surface
run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 40 --pixels 256 --out sine.exr
run 0 info sine.exr --json
near nx "$(json nx)" 256 0
near pitch_x_nm "$(json pitch_x_nm)" 156.25 1e-9
near "height range" "$(json heights.max_um)" 0.06 1e-5
near "strongest period" "$(json periods.0.period_nm)" 1600 8
ok "known as a fixture" [ "$(json title)" = "diffbench fixture sine" ]

# two of three fix the grid
run 0 fixture flat --pitch-nm 100 --size-um 10 --out f.gsf --json
ok "samples" [ "$(json samples)" = "100 x 100" ]
run 0 fixture flat --pitch-nm 100 --pixels 50 --out f.gsf --json
ok "samples" [ "$(json samples)" = "50 x 50" ]
ok "pitch" [ "$(json pitch_nm)" = 100 ]
refuses 2 'fixture: --pixels, --pitch-nm and --size-um: expected at most two' fixture flat --pixels 9 --pitch-nm 1 \
    --size-um 1 --out f.gsf
refuses 2 'gives 1 samples a side, expected 2 to 32768' fixture flat --size-um 1 --pitch-nm 1000 --out f.gsf
refuses 2 'gives 1e\+12 samples' fixture flat --size-um 1e6 --pitch-nm 1e-3 --out f.gsf

# the same seed, the same bytes; another one, other heights
export SOURCE_DATE_EPOCH=1700000000
run 0 fixture random --pixels 32 --size-um 5 --seed 7 --out r.gsf
cp r.gsf r7.gsf
run 0 fixture random --pixels 32 --size-um 5 --seed 7 --out r.gsf
ok "byte-identical" cmp -s r.gsf r7.gsf
run 0 fixture random --pixels 32 --size-um 5 --seed 8 --out r.gsf
ok "another seed differs" bash -c '! cmp -s <(tail -c 4096 r.gsf) <(tail -c 4096 r7.gsf)'

refuses 2 'fixture: dragon: unknown kind, expected flat, sine' fixture dragon --out f.gsf
refuses 2 'fixture: expected KIND' fixture --out f.gsf
refuses 2 'nowhere to write to, expected --out' fixture sine
refuses 2 'one operand too many' fixture sine blazed --out f.gsf
refuses 2 '\.gsf|\.exr' fixture sine --pixels 16 --out f.jpg
refuses 2 "duty '1': out of range" fixture lamellar --duty 1 --out f.gsf
refuses 2 "period-nm '0': out of range, expected more than 0" fixture sine --period-nm 0 --out f.gsf
refuses 3 'nowhere' fixture sine --pixels 16 --out nowhere/f.gsf
finish
