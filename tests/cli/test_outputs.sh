#!/usr/bin/env bash
# Outputs: whole or not at all; what cannot be written is said; a reader that goes away ends the program quietly.
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture sine --pixels 64 --size-um 10 --out s.gsf
small=(--theta-i-deg 10 --angle-deg -20:20:10 --lambda-nm 500)
large=(--theta-i-deg 10 --angle-deg -85:85:0.1 --lambda-nm 380:780:2)

# nowhere to write: said before any work, without a trace
refuses 3 'table: none/t.csv: cannot write: No such file' table s.gsf "${small[@]}" --out none/t.csv
mkdir folder.csv
refuses 3 'table: folder.csv: is a directory' table s.gsf "${small[@]}" --out folder.csv
if [ "$(id -u)" -ne 0 ]; then
    mkdir closed && chmod 555 closed
    refuses 3 'closed/t.csv: cannot write: Permission denied' table s.gsf "${small[@]}" --out closed/t.csv
fi
run 0 eval s.gsf --help
printf 'theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm\n1,0,2,0,500\n' >q.csv
refuses 3 'eval: none/e.csv: cannot write' eval s.gsf --queries q.csv --out none/e.csv
refuses 3 'orders: none/o.csv: cannot write' orders --period-nm 900 --theta-i-deg 1 --lambda-nm 500 --out none/o.csv
refuses 3 'fixture: none/f.gsf: ' fixture flat --pixels 4 --out none/f.gsf
ok "no temporary files" [ -z "$(find . -name '*.tmp.*')" ]

# a full disk
mkdir small
if mount -t tmpfs -o size=64k tmpfs small 2>mount.err; then
    trap 'umount "$scratch/small"; rm -rf "$scratch"' EXIT
    echo "disk full: a tmpfs of 64 kB"
    echo old >small/t.csv
    refuses 3 'small/t.csv: cannot write: No space left' table s.gsf "${large[@]}" --out small/t.csv --quiet
    ok "the old file is whole" [ "$(cat small/t.csv)" = old ]
    ok "no temporary file" [ "$(ls small)" = t.csv ]
    refuses 3 'small/f.gsf: cannot write: No space left' fixture flat --pixels 512 --out small/f.gsf
    refuses 3 'small/t.exr: cannot write: No space left' table s.gsf --theta-i-deg 1 --angle-deg -85:85:0.01 --quiet \
        --out small/t.exr
    ok "no temporary file" [ "$(ls small)" = t.csv ]
else
    echo "disk full: no tmpfs can be mounted here ($(cat mount.err)); /dev/full and a file size limit instead"
fi
for call in "table s.gsf ${small[*]}" "orders --period-nm 900 --theta-i-deg 1 --lambda-nm 500" "info s.gsf" "--help" \
    "table --help" "info s.gsf --json" "--version"; do
    last="diffbench $call >/dev/full"
    "$program" $call --quiet >/dev/full 2>err || "$program" $call >/dev/full 2>err
    code=$?
    ok "exit code $code, want 3" [ $code -eq 3 ]
    err_has '(stdout|standard output).*(No space left|write failed)'
done

# a limit on file sizes: write fails in mid-file, or the program is killed there
echo old >t.csv
last="diffbench table under ulimit -f"
(trap '' XFSZ && ulimit -f 64 && "$program" table s.gsf "${large[@]}" --quiet --out t.csv 2>err)
code=$?
ok "exit code $code, want 3" [ $code -eq 3 ]
err_has '^diffbench table: t.csv: cannot write: File too large'
ok "the old file is whole" [ "$(cat t.csv)" = old ]
ok "no temporary file" [ -z "$(find . -name 't.csv.tmp.*')" ]
(ulimit -c 0 && ulimit -f 64 && "$program" table s.gsf "${large[@]}" --quiet --out t.csv) >/dev/null 2>&1
code=$?
ok "killed by a signal, not $code" [ $code -gt 128 ]
ok "the old file is whole after a kill in mid-write" [ "$(cat t.csv)" = old ]
rm -f t.csv.tmp.*

# killed while the temporary file grows
"$program" table s.gsf "${large[@]}" --quiet --out t.csv &
pid=$!
while [ ! -e t.csv.tmp.$pid ] && kill -0 $pid 2>/dev/null; do :; done
kill -9 $pid 2>/dev/null
wait $pid 2>/dev/null
code=$?
if [ $code -eq 137 ]; then
    ok "the old file is whole after kill -9" [ "$(cat t.csv)" = old ]
else
    ok "the new file is whole" [ "$(rows t.csv | wc -l)" -eq $((1701 * 201)) ]
    echo "kill -9 came too late"
fi
rm -f t.csv.tmp.*

# replaced as a whole
run 0 table s.gsf "${small[@]}" --out t.csv
ok "the new file" [ "$(rows t.csv | wc -l)" -eq 5 ]
ln -s t.csv link.csv
run 0 table s.gsf "${small[@]}" --angle-deg 0 --out link.csv
ok "a link stays a link" [ -L link.csv -a "$(rows t.csv | wc -l)" -eq 1 ]
run 0 table s.gsf "${small[@]}" --out /dev/null

# a reader that goes away
last="diffbench table | head"
"$program" table s.gsf "${large[@]}" --quiet 2>err | head -n 1 >out
ok "the first line came" [ -s out ]
ok "no complaint" [ ! -s err ]
(trap '' PIPE; "$program" table s.gsf "${large[@]}" --quiet 2>err; echo $? >code) | head -n 1 >out
ok "no complaint if SIGPIPE is ignored, too" [ ! -s err ]
finish
