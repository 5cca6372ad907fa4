#!/usr/bin/env bash
# Runs the example of every verb's --help as it stands, each in a folder of its own.
. "$(dirname "$0")/harness.sh" "$@"

for verb in fixture info convert table eval map lut orders maxima fit report; do
    run 0 $verb --help
    sed '1,/^Example$/d' out >example
    ok "$verb: an example that uses the verb" grep -q "diffbench $verb" example
    mkdir $verb
    last="the example of diffbench $verb"
    (cd $verb && bash -e ../example >../out 2>../err </dev/null)
    code=$?
    ok "$verb: the example ends with $code" [ $code -eq 0 ]
    ok "$verb: the example prints or makes something" [ -n "$(ls $verb)" -o -s out ]
done
finish
