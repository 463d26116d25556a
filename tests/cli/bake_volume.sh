# Light by a radiance volume, and radiance in free space as grids: what is written, the same bytes
# twice, what the report has; and sizes and options that make no sense.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_box --scene cornell --points 2000 -o box.ply
# What is asked holds to the bit.
few='--volume-cells 8 --rays 16 --estimate-points 50'

run 0 bake box.ply -q --method volume $few --report one.json -o one.ply \
	--vdb-sh one.vdb
run 0 bake box.ply -q --method volume $few -o two.ply --vdb-sh two.vdb --threads 3
[ "$(body one.ply)" = "$(body two.ply)" ] && echo "the same light"
# The cells that have light, beside how many there were to be along a side.
grep -c volume_cells one.json
head -c 4 one.vdb && echo
strings one.vdb | grep '^sh_[0-8]$' | sort -u | wc -l
# Nine harmonics have nine grids, by any method; none is made where nobody asks.
run 0 bake box.ply -q --rays 16 --volume-cells 8 --volume-sh 9 --report rays.json --vdb-sh nine.vdb
strings nine.vdb | grep '^sh_[0-8]$' | sort -u | wc -l
run 0 bake box.ply -q --rays 16 --report none.json -o rays.ply
grep -c volume_cells none.json
[ "$(body one.ply)" != "$(body rays.ply)" ] && echo "other light than by rays"
glowworm plan box.ply --method volume 2>&1 |
	sed -E 's/  */ /g; s/[0-9.]+ s\>/T s/g' |
	sed -nE 's/^(bounces.*volume).*/\1/p; s/^ (by cells[^;]*);.*/\1/p'

# A transport gives the same bytes, under other lamps too.
lamp='point at 0.5,0.5,0.7 intensity 1'
run 0 bake box.ply -q --method volume $few --save-transport kept.transport -o kept.ply
run 0 bake box.ply -q --method volume $few --transport kept.transport -o again.ply
run 0 bake box.ply -q --method volume $few --light "$lamp" -o lamp.ply
run 0 bake box.ply -q --method volume $few --light "$lamp" \
	--transport kept.transport -o lamp-again.ply
[ "$(body kept.ply)" = "$(body again.ply)" ] && echo "the same light again"
[ "$(body lamp.ply)" = "$(body lamp-again.ply)" ] && echo "the same lamp again"
[ "$(body lamp.ply)" != "$(body kept.ply)" ] && echo "another lamp"
# Frames are what bakes of them from scratch are, but for rays that graze the edge of a cell, 1e-4
# of them (bake_frames.sh); and a thing that moves changes the light.
cp "$SOURCE/samples/cornell.obj" "$SOURCE/samples/cornell.mtl" "$SOURCE/samples/cornell_cube.obj" .
cat >moves.scene.json <<'END'
{"version": 1, "frames": 2,
 "inputs": [{"file": "cornell.obj"},
            {"file": "cornell_cube.obj",
             "matrix": [0.6,0,0,0.3, 0,0.6,0,0.1, 0,0,0.6,0.301, 0,0,0,1],
             "path": [{"frame": 0, "move": [0,0,0]}, {"frame": 1, "move": [-0.7,0.2,0.3]}]}],
 "bake": {"count": 4000, "estimate_points": 0, "method": "volume", "volume_cells": 12}}
END
run 0 bake moves.scene.json -q --exposure 0 --frames all --independent -o frame-%d.ply
run 0 bake moves.scene.json -q --exposure 0 --frames all --rebuild -o scratch-%d.ply
for i in 0 1; do
	run 0 compare frame-$i.ply scratch-$i.ply --max-relrmse 0.0005 >compared.txt
done
[ "$(body frame-0.ply)" != "$(body frame-1.ply)" ] && echo "frames differ"

run 2 bake box.ply --method volume --volume-cells 0 -o bad.ply
run 2 bake box.ply --method volume --volume-cells 1e9 -o bad.ply
run 2 bake box.ply --volume-sh 5 --vdb-sh bad.vdb
run 2 bake box.ply --method volume --max-error 0.1 -o bad.ply
run 2 bake box.ply --method volume --fields lights -o bad.ply
run 2 bake box.ply --method volume --gaps black -o bad.ply
run 2 bake box.ply -o - --vdb-sh -
run 71 bake box.ply -q --method volume --volume-cells 400 --depth 9 --memory 250M -o bad.ply |
	sed 's/[0-9]\{6,\}/N/g'
! ls | grep bad
