#!/usr/bin/env bash
# Runs every `diffbench` command of the README's sh blocks in a scratch folder, in the order of the text.
#   tests/cli/test_readme.sh README.md DIFFBENCH
set -u
readme=$1
program=$(readlink -f "$2")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin"
ln -s "$program" "$scratch/bin/diffbench"
export PATH=$scratch/bin:$PATH

# A command is a line that begins with diffbench, joined with its continuation lines.
awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 }
     inside && (more || /^diffbench /) { more = sub(/\\$/, ""); printf more ? "%s" : "%s\n", $0 }' \
    "$readme" >"$scratch/commands"
cd "$scratch" || exit 2

n=0
while read -r command; do
    echo "\$ $command"
    bash -c "$command" </dev/null >out 2>&1
    code=$?
    head -n 5 out
    [ $code -eq 0 ] || { echo "exit code $code"; cat out; exit 1; }
    n=$((n + 1))
done <commands
[ $n -ge 8 ] || { echo "only $n commands found in $readme"; exit 1; }
echo "$n commands of the README ran"
