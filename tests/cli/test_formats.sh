#!/usr/bin/env bash
# Files as instruments and spreadsheets leave them, through the program: SDF, x3p, text, gzip.
. "$(dirname "$0")/harness.sh" "$@"

sdf()
{
    printf 'aISO-1.0\r\nManufacID = x\r\nNumPoints = 4\r\nNumProfiles = 3\r\nXscale = 2.5E-7\r\nYscale = 5e-7\r\n'
    printf 'Zscale = 1e-9\r\nZresolution = -1\r\nCompression = 0\r\nDataType = 7\r\nCheckType = 0\r\n*\r\n'
    printf '1 2 3 4\r\n5 %s 7 8\r\n9 10 11 12\r\n*\r\n' "$1"
}

sdf 6 >a.sdf
run 0 info a.sdf --json
ok "format" [ "$(json format)" = sdf ]
near "pitch along x" "$(json pitch_x_nm)" 250 1e-12
near "pitch along y" "$(json pitch_y_nm)" 500 1e-12
near "highest" "$(json heights.max_um)" 0.012 1e-12

# a point that was not measured
sdf BAD >bad.sdf
refuses 3 'bad.sdf: height at column 1, row 1 is nan, want a finite number \(missing points: --fill' info bad.sdf
run 0 convert bad.sdf --fill --out filled.gsf
run 0 info filled.gsf --json

# packed, and whatever it is called
gzip -c a.sdf >scan.dat
run 0 info scan.dat --json
ok "packed SDF" [ "$(json format)" = sdf ]
head -c 60 scan.dat >cut.dat
refuses 3 'cut.dat: the gzip archive ends before its data do \(truncated\?\)' info cut.dat

# a spreadsheet's export
printf '1,5;2;3\n4;;6\n' >cells.csv
refuses 3 'cells.csv: text has no scale in it, give --pixel-nm or --size-um, and --z-unit' info cells.csv
refuses 3 'cells.csv: height at column 1, row 1 is nan' info cells.csv --pixel-nm 50 --z-unit nm
run 0 convert cells.csv --pixel-nm 50 --z-unit nm --fill --level none --out cells.txt
ok "header of an export" grep -qx '# Value units: m' cells.txt
ok "numbers in m" grep -q '^1.5e-09	2e-09	3e-09$' cells.txt
run 0 info cells.txt --json
near "pitch" "$(json pitch_x_nm)" 50 1e-12

# an archive that is no surface, and surfaces inside a folder and with a wrong sum
printf 'PK\003\004 and so on' >some.zip
refuses 3 'some.zip: damaged zip archive \(truncated\?\)' info some.zip
if [ -d "$data/afm/x3p" ]; then
    run 0 info "$data/afm/x3p/csafe-logo.x3p"
    out_has 'x3p$'
    err_has 'wrong MD5 check sum of main.xml; floating-point heights are times the file.s Increment of 1e-06$'
    run 0 convert "$data/afm/x3p/testing.x3p" --out x.png
    out_has ' -> x.png: 30 x 20 samples of 2.75e\+07 x 2.75e\+07 nm$'
    run 0 convert x.png --out x.txt --level none
    out_has '^x.png -> x.txt: 30 x 20 samples of 2.75e\+07 x 2.75e\+07 nm$'
else
    echo "no x3p files in $data: left out"
fi
finish
