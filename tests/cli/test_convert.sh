#!/usr/bin/env bash
# diffbench convert: formats, folders, what fails and what goes on.
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 12.8 --pixels 64 --out s.gsf

# every format and back: the heights' range survives to the format's own step
info_range() { run 0 info "$@" --json --quiet && awk -v a="$(json heights.min_um)" -v b="$(json heights.max_um)" 'BEGIN { print b - a }'; }
range=$(info_range s.gsf)
for format in exr gsf png txt; do
    run 0 convert s.gsf --out t.$format
    out_has "^s.gsf -> t.$format: 64 x 64 samples of 200 x 200 nm$"
    near "range of the $format" "$(info_range t.$format)" "$range" 2e-6
    near "pitch of the $format" "$(json pitch_x_nm)" 200 1e-6
done
run 0 convert s.gsf --out t.png
err_has '^convert: t.png: 16-bit heights: one step is 0.0016.* nm$'

# a synthetic surface stays one, and provenance tells the way
run 0 convert s.gsf --rotate-deg 90 --out r.exr --quiet
ok "--quiet says nothing" [ ! -s err ]
run 0 info r.exr --json
ok "still a fixture" [ "$(json title)" = "diffbench fixture sine" ]
run 0 table r.exr --theta-i-deg 10 --angle-deg 0 --lambda-nm 500 --quiet
grep -a -o 'rotate-deg 90: [^;]*nm)' r.exr >preparation
ok "the step is in the file" grep -q '^rotate-deg 90: rms .* nm (from .* nm)$' preparation

# several at once, into a folder that is made, or beside the inputs
mkdir in
cp s.gsf in/a.gsf
cp r.exr in/b.exr
cp s.gsf in/scan.001
cp s.gsf in/scan.002
run 0 convert in/a.gsf in/b.exr in/scan.001 in/scan.002 --out made
err_has '^convert: 4 of 4 surfaces converted, 0 failed$'
for name in a b scan.001 scan.002; do
    ok "made/$name.exr" [ -s made/$name.exr ]
done
run 0 convert in/a.gsf in/scan.001 --to txt --json
ok "beside the input" [ -s in/a.txt -a -s in/scan.001.txt ]
ok "two entries" [ "$(json '#')" = 2 ]
ok "output of the first" [ "$(json 0.output)" = in/a.txt ]
run 0 convert in/a.gsf --out made/
out_has '^in/a.gsf -> made/a.exr: '

# one bad file does not stop the others
head -c 300 s.gsf >in/cut.gsf
: >in/empty.spm
run 3 convert in/a.gsf in/cut.gsf none.gsf in/empty.spm in/b.exr --out some --to gsf
err_has '^diffbench convert: in/cut.gsf: '
err_has '^diffbench convert: none.gsf: '
err_has '^diffbench convert: in/empty.spm: empty file$'
err_has '^convert: 2 of 5 surfaces converted, 3 failed$'
ok "good ones are there" [ -s some/a.gsf -a -s some/b.gsf ]
ok "bad ones are not" [ ! -e some/cut.gsf -a ! -e some/empty.gsf ]
run 3 convert in/a.gsf in/cut.gsf --out some --json --quiet
ok "the list says which" [ "$(json 0.ok) $(json 1.ok)" = "true false" ]

# what would overwrite
refuses 2 'convert: s.gsf: s.gsf is one of the inputs, expected another --out' convert s.gsf --out s.gsf
refuses 2 'convert: s.gsf: s.gsf is one of the inputs' convert s.gsf --to gsf
mkdir twice
cp s.gsf twice/a.gsf
run 3 convert in/a.gsf twice/a.gsf --out both
err_has 'convert: twice/a.gsf: both/a.exr is already the output of an earlier one$'
ok "the input is untouched" cmp -s s.gsf twice/a.gsf

# usage
refuses 2 'convert: expected SURFACE...' convert --out x.exr
refuses 2 'convert: no output, expected --out PATH or --to exr\|gsf\|png\|txt' convert s.gsf
refuses 2 'convert: .*written as .exr, .gsf, .png or .txt' convert s.gsf --out x.tif
refuses 2 "convert: --to 'tif': unknown" convert s.gsf --to tif
refuses 3 'convert: s.gsf: not a folder' convert in/a.gsf in/b.exr --out s.gsf
refuses 3 'convert: .*No such file or directory' convert in/a.gsf --out no/such/x.exr
finish
