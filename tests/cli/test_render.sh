#!/usr/bin/env bash
# diffbench render
. "$(dirname "$0")/harness.sh" "$@"

run 0 fixture sine --period-nm 1600 --height-nm 120 --size-um 16 --pixels 128 --out sine.gsf
run 0 lut sine.gsf --azimuths 256 --radii 64 --sigma-um 4 --average welch --out sine.lut.exr
small=(--cpu --size 64x48 --detail 1)

# every mesh, from a table and from the surface
for mesh in plane disc cylinder sphere snake; do
    run 0 render sine.lut.exr "${small[@]}" --mesh $mesh --out $mesh.png
    err_has "64 x 48 pixels, [0-9]+ triangles, exposure [0-9.e+]+ \(auto\), drawn on cpu"
    ok "a picture" [ "$(head -c 4 $mesh.png | tail -c 3)" = PNG ]
done
ok "the picture says how it was made" grep -aq 'diffbench.renderer' snake.png
ok "and what the table was made of" grep -aq 'diffbench.table_input' snake.png
run 0 render sine.gsf "${small[@]}" --azimuths 256 --radii 64 --sigma-um 4 --lambda-nm 400:700:50 --out surface.exr --json
ok "EXR holds coverage" grep -aq 'diffbench.samples_per_pixel' surface.exr
near "as wide as wanted" "$(json width)" 64 0
ok "the renderer" [ "$(json provenance.renderer)" = cpu ]

# a mesh from a file: the built-in plane as OBJ gives the same picture
printf 'v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n' >plane.obj
view=(--camera 50,-90,4 --light-deg 30,90 --exposure 100)
for mesh in plane plane.obj; do
    SOURCE_DATE_EPOCH=1 "$program" render sine.lut.exr "${small[@]}" "${view[@]}" --quiet --mesh $mesh --out $mesh.png 2>err
done
ok "file and built-in mesh: the same picture" [ "$("$tool" pixels plane.png)" = "$("$tool" pixels plane.obj.png)" ]
printf 'v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n' >bare.obj
run 0 render sine.lut.exr "${small[@]}" "${view[@]}" --mesh bare.obj --out bare.png
ok "without texture coordinates, combed along x" [ "$("$tool" pixels plane.png)" = "$("$tool" pixels bare.png)" ]

# the patch turned by 90 degrees on a plane is the scene turned the other way
run 0 render sine.lut.exr "${small[@]}" --mesh plane --camera 0,-90,4 --light-deg 30,0 --exposure 1e4 --out a.png
run 0 render sine.lut.exr "${small[@]}" --mesh plane --camera 0,-90,4 --light-deg 30,90 --groove-deg 90 --exposure 1e4 --out b.png
ok "both show light" [ "$("$tool" pixels a.png)" != "$("$tool" pixels bare.png)" ]

# base colour: one colour, a picture
"$tool" png 8 8 base.png
run 0 render sine.lut.exr "${small[@]}" --mesh sphere --base-colour 804020 --out base1.png
run 0 render sine.lut.exr "${small[@]}" --mesh sphere --base-colour base.png --out base2.png
ok "the base is seen" [ "$("$tool" pixels base1.png)" != "$("$tool" pixels base2.png)" ]
refuses 3 'render: bare.obj: no texture coordinates, which --base-colour' render sine.lut.exr "${small[@]}" --mesh bare.obj \
    --base-colour base.png --out x.png

# sequences
run 0 render sine.lut.exr "${small[@]}" --turntable 3 --out turn.png
ok "three frames" [ "$(ls turn.*.png | wc -l)" -eq 3 ]
ok "numbered" [ -f turn.0000.png -a -f turn.0002.png ]
ok "that differ" [ "$("$tool" pixels turn.0000.png)" != "$("$tool" pixels turn.0001.png)" ]
run 0 render sine.lut.exr "${small[@]}" --light-sweep 10:30:10 --out sweep.exr
ok "three of the sweep" [ "$(ls sweep.*.exr | wc -l)" -eq 3 ]
ok "each says its angle" grep -aq swept_theta_deg sweep.0002.exr

# all methods
run 0 render sine.gsf "${small[@]}" --azimuths 128 --radii 48 --sigma-um 4 --average none --lambda-nm 400:700:50 --mesh sphere \
    --contact-sheet --out sheet.png
ok "a contact sheet" [ "$(head -c 4 sheet.png | tail -c 3)" = PNG ]

# the GPU, hardware or not; without one a line that says what does without it
if "$program" render sine.lut.exr --size 64x48 --detail 1 --mesh sphere --exposure 1e4 --out gpu.png --json >out 2>err; then
    last="render on the GPU"
    ok "the renderer's name" [ "$(json provenance.renderer | grep -c 'fragment$')" -eq 1 ]
    run 0 render sine.lut.exr "${small[@]}" --mesh sphere --exposure 1e4 --out cpu.png
    ok "GPU and CPU: pictures alike ($("$tool" differ gpu.png cpu.png))" is_near "$("$tool" differ gpu.png cpu.png)" 0 0.5
    for method in sheet nmm stam; do
        run 0 render sine.gsf --size 64x48 --detail 1 --mesh sphere --exposure 1e4 --sigma-um 4 --average none \
            --lambda-nm 400:700:50 --method $method --out gpu.png
        run 0 render sine.gsf "${small[@]}" --mesh sphere --exposure 1e4 --sigma-um 4 --average none \
            --lambda-nm 400:700:50 --method $method --out cpu.png
        ok "$method likewise" is_near "$("$tool" differ gpu.png cpu.png)" 0 0.5
    done
else
    ok "names --cpu" grep -q -e '--cpu renders without a GPU' err
fi
export __EGL_VENDOR_LIBRARY_DIRS=/nonexistent
refuses 4 'render: .*--cpu renders without a GPU' render sine.lut.exr --size 64x48 --out x.png
unset __EGL_VENDOR_LIBRARY_DIRS

# mesostructure and filters
run 0 fixture random --height-nm 500 --correlation-um 7 --pitch-nm 1000 --pixels 64 --out meso.gsf
for filter in none mip slopes supersample; do
    n=$([ $filter = supersample ] && echo 4 || echo 1)
    run 0 render sine.lut.exr "${small[@]}" --mesh sphere --mesostructure meso.gsf --filter $filter --samples "$n" --out $filter.png
    ok "says so" grep -aq 'diffbench.filter' $filter.png
done
ok "filters differ" [ "$("$tool" pixels none.png)" != "$("$tool" pixels slopes.png)" ]
mkdir study
run 0 render sine.lut.exr --cpu --size 32x32 --detail 1 --mesh sphere --mesostructure meso.gsf --samples 3 --filter-study study
ok "twenty rows" [ "$(rows study/filters.csv | wc -l)" -eq 20 ]
ok "and a picture" [ "$(head -c 4 study/filters.png | tail -c 3)" = PNG ]
ok "the exposures are in the table" grep -q 'drawn on cpu: study/filters.png and .csv$' err
# mean dE2000 of a filter at a zoom: where slopes are Gaussian the filter is nearer to the truth than no filter; at a grazing
# view its light can be too much; seen from afar a row of walls is what its Gaussian is not
mean_of() { rows "$1/filters.csv" | awk -F, -v zoom="$2" -v filter="$3" -v column="${4-5}" '$1 == zoom && $2 == filter { print $column }'; }
less() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }'; }
run 0 fixture lamellar --height-nm 3000 --period-nm 16000 --pitch-nm 1000 --pixels 128 --out walls.gsf
run 0 fixture random --height-nm 500 --correlation-um 7 --pitch-nm 1000 --pixels 128 --out wrinkles.gsf
tiny=(--cpu --size 32x32 --samples 8)
run 0 render sine.lut.exr "${tiny[@]}" --detail 1 --mesh sphere --mesostructure wrinkles.gsf --filter-study waves
run 0 render sine.lut.exr "${tiny[@]}" --detail 1 --mesh sphere --mesostructure walls.gsf --filter-study walls
run 0 render sine.lut.exr "${tiny[@]}" --mesh plane --camera 84,-90 --mesostructure wrinkles.gsf --filter-study grazing
for zoom in 1 16 64; do
    ok "Gaussian, zoom $zoom" less "$(mean_of waves $zoom slopes 8)" "$(mean_of waves $zoom none 8)"
    ok "walls, zoom $zoom" less "$(mean_of walls $zoom none)" "$(mean_of walls $zoom slopes)"
    ok "grazing, zoom $zoom" less "$(mean_of grazing $zoom slopes)" "$(mean_of grazing $zoom none)"
    ok "the floor is below, zoom $zoom" less "$(mean_of walls $zoom 'truth again')" "$(mean_of walls $zoom none)"
    ok "and above 0, zoom $zoom" less 0 "$(mean_of waves $zoom 'truth again')"
done
run 0 render sine.lut.exr "${tiny[@]}" --mesh plane --camera 84,0 --mesostructure wrinkles.gsf --filter-study across
ok "grazing along x: too much light" less 1.3 "$(mean_of across 16 slopes 9)"
refuses 2 'render: --filter-study needs --mesostructure, --cpu' render sine.lut.exr --cpu --filter-study study
refuses 2 'render: --filter slopes averages the table, expected --method lut' render sine.gsf --cpu --method sheet --filter slopes --out x.png
refuses 3 'render: bare.obj: no texture coordinates, which --mesostructure needs' render sine.lut.exr "${small[@]}" --mesh bare.obj --mesostructure meso.gsf --out x.png
refuses 3 'render: base.png: no scale, expected --meso-pixel-um' render sine.lut.exr "${small[@]}" --mesostructure base.png --out x.png
run 0 render sine.lut.exr "${small[@]}" --mesostructure base.png --meso-pixel-um 10 --meso-height-um 1 --quiet --out m.png

# refusals: one line, nothing left behind
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 nan 1\nf 1//1 2//1 3//1\n' >nan.obj
refuses 3 'render: nan.obj: line 4: a normal of nan, want finite numbers' render sine.lut.exr "${small[@]}" --mesh nan.obj --out x.png
refuses 3 'render: torus: ' render sine.lut.exr "${small[@]}" --mesh torus --out x.png
refuses 3 'render: sine.gsf: no faces' render sine.lut.exr "${small[@]}" --mesh sine.gsf --out x.png
refuses 3 'render: none.gsf: ' render none.gsf "${small[@]}" --out x.png
refuses 3 'render: sine.lut.exr: a table, which only --method lut reads' render sine.lut.exr "${small[@]}" --method sheet --out x.png
refuses 3 'render: sine.lut.exr: a table, and --shadowing ndf needs the surface' render sine.lut.exr "${small[@]}" --shadowing ndf --out x.png
refuses 2 'render: nowhere to put the picture' render sine.lut.exr --cpu
refuses 2 "render: --out 'x.jpg': unknown kind of file" render sine.lut.exr --cpu --out x.jpg
refuses 2 "render: --size '64': expected WIDTHxHEIGHT" render sine.lut.exr --cpu --size 64 --out x.png
refuses 2 "render: --size '9x9': expected WIDTHxHEIGHT" render sine.lut.exr --cpu --size 9x9 --out x.png
refuses 2 "render: --camera '1': expected THETA,PHI" render sine.lut.exr --cpu --camera 1 --out x.png
refuses 2 "render: --camera '1,2,-3': expected THETA,PHI" render sine.lut.exr --cpu --camera 1,2,-3 --out x.png
refuses 2 "render: --light-deg '30': expected THETA,PHI" render sine.lut.exr --cpu --light-deg 30 --out x.png
refuses 2 "render: --exposure '0': expected a number > 0 or auto" render sine.lut.exr --exposure 0 --out x.png
refuses 2 'render: expected at most one of' render sine.lut.exr --turntable 3 --light-sweep 0:1:1 --out x.png
refuses 2 "render: --contact-sheet with --out 'x.exr'" render sine.gsf --contact-sheet --out x.exr
refuses 3 'render: none/x.png: cannot write' render sine.lut.exr --cpu --out none/x.png
ok "nothing left behind" [ -z "$(find . -name 'x.*')" ]
finish
