#!/usr/bin/env bash
# Every kind of bad input: its exit code, its one line that names the file, nothing on stdout, no crash.
. "$(dirname "$0")/harness.sh" "$@"

plan=(--theta-i-deg 10 --angle-deg -20:20:10 --lambda-nm 500)
bad()
{
    local code=$1 regex=$2 file=$3
    shift 3
    refuses "$code" "table: $file: .*$regex" table "$file" "${plan[@]}" "$@"
    refuses "$code" "info: $file: .*$regex" info "$file" "$@"
}

# gsf NAME XRES YRES [BYTES as octal escapes]: a GSF file of 1 um with the given samples
gsf()
{
    printf 'Gwyddion Simple Field 1.0\nXRes = %s\nYRes = %s\nXReal = 1e-6\nYReal = 1e-6\nXYUnits = m\nZUnits = m\n' \
        "$2" "$3" >"$1"
    pad=$((4 - $(stat -c %s "$1") % 4))
    head -c $pad /dev/zero >>"$1"
    printf "${4-}" >>"$1"
}

bad 3 'No such file' missing.gsf
mkdir folder
bad 3 'directory' folder
: >empty.gsf
bad 3 '.' empty.gsf
head -c 1000 /dev/zero >zeros
bad 3 '.' zeros
head -c 4000 "$program" >program
bad 3 '.' program
if [ "$(id -u)" -ne 0 ]; then
    : >locked.gsf && chmod 0 locked.gsf
    bad 3 'Permission denied' locked.gsf
fi

# cut short
run 0 fixture random --pixels 64 --size-um 10 --out s.exr
run 0 fixture sine --pixels 64 --size-um 10 --out s.gsf
"$tool" png 64 64 p.png
for n in 3 20 100 300 2000; do
    head -c $n s.exr >cut.exr
    bad 3 '.' cut.exr
    head -c $n s.gsf >cut.gsf
    bad 3 '.' cut.gsf --pixel-nm 10 --z-unit nm
done
for n in 5 20 60 200; do
    head -c $n p.png >cut.png
    bad 3 '.' cut.png --pixel-nm 10 --height-um 1
done
head -c -1 s.gsf >cut.gsf
bad 3 'bytes of samples' cut.gsf
(cat s.gsf && echo more) >long.gsf
bad 3 'bytes of samples' long.gsf

# text
printf '1 2 3\n4 5\n6 7 8\n' >ragged.txt
bad 3 '(line|row) 2' ragged.txt --pixel-nm 10 --z-unit nm
for word in nan inf; do
    printf '1 2 3\n4 %s 6\n7 8 9\n' $word >bad.txt
    bad 3 '.' bad.txt --pixel-nm 10 --z-unit nm
done
printf '1 2 3\n4 five 6\n' >word.txt
bad 3 '.' word.txt --pixel-nm 10 --z-unit nm
printf '1 2 3\n4 5 6\n' >plain.txt
bad 3 '--pixel-nm' plain.txt --z-unit nm
bad 3 '--z-unit' plain.txt --pixel-nm 10
bad 2 'furlong' plain.txt --pixel-nm 10 --z-unit furlong

# NaN and infinite heights, a pitch of nothing
gsf good.gsf 2 2 '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0'
run 0 info good.gsf --quiet
gsf nan.gsf 2 2 '\0\0\0\0\0\0\300\177\0\0\0\0\0\0\0\0'
bad 3 '.' nan.gsf
gsf inf.gsf 2 2 '\0\0\0\0\0\0\200\177\0\0\0\0\0\0\0\0'
bad 3 '.' inf.gsf
gsf pitch0.gsf 2 2 '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0'
sed -i 's/XReal = 1e-6/XReal = 0e-6/' pitch0.gsf
bad 3 'XReal' pitch0.gsf
for flag in pixel-nm size-um height-um; do
    for value in 0 -1 nan inf; do
        refuses 2 "table: --$flag '$value'" table p.png "${plan[@]}" --$flag $value
    done
done

# sizes
gsf one.gsf 1 1 '\0\0\0\0'
bad 3 '1 x 1 samples, expected at least 2 x 2' one.gsf
gsf row.gsf 2 1 '\0\0\0\0\0\0\0\0'
bad 3 '2 x 1 samples' row.gsf
"$tool" png 1 1 one.png
bad 3 '1 x 1 samples' one.png --pixel-nm 10 --height-um 1
"$tool" png 3 100000 tall.png
bad 3 '.*32768' tall.png --pixel-nm 10 --height-um 1
"$tool" png 100000 3 wide.png
bad 3 '.*32768' wide.png --pixel-nm 10 --height-um 1
for size in '0 2' '2 0' '-2 2' '32769 2' '65536 65536' '4294967296 4294967296' '9223372036854775807 2' '1e300 2' '2.5 2'; do
    gsf size.gsf $size '\0\0\0\0'
    bad 3 '.' size.gsf
done

# values out of range are usage, whatever the file is
refuses 2 "table: --theta-i-deg '90'" table missing.gsf --theta-i-deg 90
refuses 2 "table: --lambda-nm" table s.gsf --theta-i-deg 1 --lambda-nm 0
refuses 2 "table: --lambda-nm.*MIN 780 is above MAX 380" table s.gsf --theta-i-deg 1 --lambda-nm 780:380:1
refuses 2 "tabel: unknown verb" tabel s.gsf
refuses 2 "table: --theta-x-deg: unknown flag" table s.gsf --theta-x-deg 1

# tables
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n10,0,1,0,500,1\n10,0,2,0,500\n' >short.csv
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n10,0,1,0,-500,1\n' >lambda.csv
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n10,0,1,0,500,1\n11,0,2,0,500,1\n' >both.csv
printf 'theta_i_deg,theta_r_deg,lambda_nm,value\n10,0,1,0,500,1\n' >columns.csv
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n' >none.csv
for file in short lambda both columns none; do
    for verb in maxima fit info; do
        refuses 3 "$verb: $file.csv: " $verb $file.csv
    done
done
finish
