# Sourced by the command line tests, each of which is called as  tests/cli/test_NAME.sh DIFFBENCH TOOL DATA.
# TOOL is built from cli_tool.c; DATA is the folder of measured scans, which may be missing.
# Works in a scratch folder; stdout and stderr of the last run lie in ./out and ./err.
set -u
program=$(readlink -f "$1")
tool=$(readlink -f "$2")
data=$(readlink -f "${3-/nonexistent}" || true)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin"
ln -s "$program" "$scratch/bin/diffbench"
export PATH=$scratch/bin:$PATH LC_ALL=C
cd "$scratch" || exit 2

if [ ! -x "$program" ] || [ ! -x "$tool" ]; then
    echo "$1 or $2 is missing"
    exit 2
fi

n_check=0
n_failed=0
last=

fail()
{
    n_failed=$((n_failed + 1))
    printf 'FAILED: %s\n        after: %s\n' "$*" "$last"
    sed 's/^/        err: /' err | head -n 5
}

# ok TEXT CONDITION...: one check.
ok()
{
    local text=$1
    shift
    n_check=$((n_check + 1))
    "$@" || fail "$text"
}

# run CODE ARGS...: runs diffbench and checks its exit code.
run()
{
    local want=$1 code
    shift
    last="diffbench $*"
    "$program" "$@" >out 2>err </dev/null
    code=$?
    ok "exit code $code, want $want" [ $code -eq "$want" ]
}

# out_has REGEX, err_has REGEX: a line of stdout or stderr matches.
out_has() { ok "no line of stdout matches: $1" grep -Eq -e "$1" out; }
out_lacks() { ok "a line of stdout matches: $1" bash -c '! grep -Eq -e "$1" out' - "$1"; }
err_has() { ok "no line of stderr matches: $1" grep -Eq -e "$1" err; }

# refuses CODE REGEX ARGS...: one line `diffbench VERB: ...` on stderr that matches, nothing on stdout.
refuses()
{
    local code=$1 regex=$2
    shift 2
    run "$code" "$@"
    err_has "$regex"
    ok "stderr has $(wc -l <err) lines, want one" [ "$(wc -l <err)" -eq 1 ]
    ok "the line does not begin with 'diffbench'" grep -q '^diffbench' err
    ok "stdout is not empty" [ ! -s out ]
}

# is_near GOT WANT TOL: |got - want| <= tol, NaN and nothing fail.
is_near()
{
    awk -v got="$1" -v want="$2" -v tol="$3" 'BEGIN {
        if (got !~ /^[-+]?[0-9.]+([eE][-+]?[0-9]+)?$/) exit 1
        d = got - want; if (d < 0) d = -d
        exit !(d <= tol) }'
}
near() { ok "$1: got '$2', want $3 +- $4" is_near "$2" "$3" "$4"; }

# json PATH: the value at a dotted path of the JSON on ./out.
json() { "$tool" json "$1" <out; }

# rows FILE: lines of a CSV file that are neither comments nor the names of the columns.
rows() { grep -v '^#' "$1" | tail -n +2; }

# needs_data FILE: skips the rest of the program (exit 77) if a measured scan is missing.
needs_data()
{
    [ -f "$data/$1" ] && return
    echo "$data/$1 is not here: the rest is skipped"
    finish
    exit 77
}

finish()
{
    echo "$n_check checks, $n_failed failed"
    [ "$n_check" -gt 0 ] && [ "$n_failed" -eq 0 ] || exit 1
}
