# Light by a radiance volume, and radiance in free space as grids: what is written, the same bytes
# twice, what the report has; and sizes and options that make no sense.
glowworm info --devices >/dev/null 2>&1 || { echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_box --scene cornell --points 2000 -o box.ply

run 0 bake box.ply -q --method volume --volume-cells 16 --report one.json -o one.ply \
	--vdb-sh one.vdb
run 0 bake box.ply -q --method volume --volume-cells 16 -o two.ply --vdb-sh two.vdb --threads 3
[ "$(body one.ply)" = "$(body two.ply)" ] && echo "the same light"
# The cells that have light, beside how many there were to be along a side.
grep -c volume_cells one.json
head -c 4 one.vdb && echo
strings one.vdb | grep '^sh_[0-8]$' | sort -u | wc -l
# Nine harmonics have nine grids, by any method; none is made where nobody asks.
run 0 bake box.ply -q --volume-cells 8 --volume-sh 9 --report rays.json --vdb-sh nine.vdb
strings nine.vdb | grep '^sh_[0-8]$' | sort -u | wc -l
run 0 bake box.ply -q --report none.json -o rays.ply
grep -c volume_cells none.json
[ "$(body one.ply)" != "$(body rays.ply)" ] && echo "other light than by rays"
glowworm plan box.ply --method volume 2>&1 | grep -o '^ *bounces.*volume' | sed 's/  */ /g'

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
