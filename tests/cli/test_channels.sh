#!/usr/bin/env bash
# Files with several channels: what info lists, and --channel
. "$(dirname "$0")/harness.sh" "$@"

# nano FILE SCAN_SIZE: a NanoScope file of 4 x 4 samples in three channels, an amplitude in mV and two heights
nano()
{
    local file=$1 size=$2 i
    local kinds=('[AmplitudeError] "Amplitude Error"' '[Height] "Height"' '[ZSensor] "Height Sensor"')
    local scales=('[Sens. Ampl] (0.06 mV/LSB) 4000 mV' '[Sens. Zsens] (0.5 V/LSB) 64 V' '[Sens. Zsens] (0.5 V/LSB) 128 V')
    {
        printf '\\*File list\r\n\\Version: 0x09010201\r\n\\*Scanner list\r\n\\@Sens. Zsens: V 10.24 nm/V\r\n'
        printf '\\*Ciao scan list\r\n\\@Sens. Ampl: V 1.0 \r\n'
        for i in 0 1 2; do
            printf '\\*Ciao image list\r\n\\Data offset: %d\r\n\\Data length: 32\r\n\\Bytes/pixel: 2\r\n' $((2048 + 32 * i))
            printf '\\Samps/line: 4\r\n\\Number of lines: 4\r\n\\Scan Size: %s\r\n\\Line Direction: Trace\r\n' "$size"
            printf '\\@2:Image Data: S %s\r\n\\@2:Z scale: V %s\r\n' "${kinds[i]}" "${scales[i]}"
        done
        printf '\\*File list end\r\n\x1a'
        head -c 2048 /dev/zero
    } | head -c 2048 >"$file"
    for i in 0 1 2; do
        printf '\0\001\0\002\0\003\0\0\0\001\0\003\0\002\0\0\0\001\0\002\0\003\0\001\0\002\0\001\0\003\0\0' >>"$file"
    done
}

nano scan.spm '4 4 ~m'
run 0 info scan.spm
out_has '^scan.spm: nanoscope, "ZSensor"$'
out_has '^channels +1 +4 x 4 +mV +AmplitudeError = Amplitude Error \(Trace\)$'
out_has '^ +2 +4 x 4 +nm +Height \(Trace\)$'
out_has '^ +\* 3 +4 x 4 +nm +ZSensor = Height Sensor \(Trace\)$'
out_has '^size +4 x 4 samples, pitch 1000 x 1000 nm, 4 x 4 um$'
out_has '^heights +0 to 0.01536 um' # 768 * 128 * 10.24 nm / 65536

run 0 info scan.spm --channel height
out_has '^scan.spm: nanoscope, "Height"$'
out_has '^ +\* 2 '
out_has '^heights +0 to 0.00768 um'
run 0 info scan.spm --channel 2 --json
ok "three channels" [ "$(json 'channels#')" = 3 ]
ok "the second is read" [ "$(json channels.1.is_read)" = true ]
ok "the third is not" [ "$(json channels.2.is_read)" = false ]
ok "its unit" [ "$(json channels.0.unit)" = mV ]
ok "a number" [ "$(json channels.2.number)" = 3 ]
ok "no height" [ "$(json channels.0.is_height)" = false ]
ok "another name" [ "$(json channels.2.alias)" = "Height Sensor" ]

# a channel in another unit is listed, and not read but on demand
run 3 info scan.spm --channel ampl
err_has "^diffbench info: scan.spm: channel 'AmplitudeError' is in mV, which is no length; .*--z-unit"
out_has '^channels +1 '
out_lacks '^heights'
run 3 info scan.spm --channel 1 --json
ok "channels without a surface" [ "$(json kind)" = channels ]
ok "none is read" [ "$(json channels.0.is_read)" = false ]
run 0 info scan.spm --channel 1 --z-unit nm
out_has '^heights +0 to 0.046875 um'
refuses 3 "scan.spm: no channel 'phase', it has 1 AmplitudeError \(mV\), 2 Height \(nm\), 3 ZSensor \(nm\)" \
    table scan.spm --theta-i-deg 30 --angle-deg 0 --lambda-nm 500 --channel phase
refuses 3 "no channel '4'" fit scan.spm --channel 4

# no scan size: the flag is named
nano unsized.spm '0 0 nm'
run 3 info unsized.spm
err_has 'nanoscope has no lateral scale in it, give --pixel-nm or --size-um$'
out_has '^channels +1 '
run 0 info unsized.spm --pixel-nm 250
out_has '^size +4 x 4 samples, pitch 250 x 250 nm'

# files with one channel: number 1 or its title
run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 40 --pixels 64 --out s.gsf
run 0 info s.gsf --channel 1
out_lacks '^channels'
run 0 info s.gsf --json
ok "one channel" [ "$(json 'channels#')" = 1 ]
refuses 3 "s.gsf: no channel '2'" info s.gsf --channel 2

# provenance says which channel it was
run 0 table scan.spm --theta-i-deg 30 --angle-deg 0 --lambda-nm 4000:5000:1000 --channel 2 --tol 1e-3
out_has '^# surface_channel: 2 of 3$'
finish
