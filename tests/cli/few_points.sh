# What takes long elsewhere, each once, with the fewest points and rays that still go all of its
# way: sanitizers look at this in place of the scripts that ask whether numbers are right.
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
few='-q --rays 4 --bounces 2 --estimate-points 0'
lamp='point at 0.5,0.5,0.8 intensity 1'
glowworm sample "$SOURCE/samples/cornell.obj" --count 300 -o room.csv -q
count() { awk 'END { print NR - 1 " points" }' "$1"; }

# Albedo of photographs: exposure unknown and known, what remains as light and as albedo.
for how in '--capture-scale 0.5' '--capture-scale 0.5 --remainder light' '--capture overcast'; do
	case $how in
	*overcast) lit= ;;
	*) lit="$lamp" ;;
	esac
	# shellcheck disable=SC2086
	run 0 albedo room.csv ${lit:+--light "$lit"} $how --rays 4 -q -f -o albedo.csv
	count albedo.csv
done

# Gloss, in each way that pictures have it, one picture and two of an orbit; with what they took.
make_box --scene cornell --points 400 -o box.ply
cat >glossy.scene.json <<'END'
{"version": 1, "inputs": [{"file": "box.ply", "specular": 0.5, "roughness": 0.5}]}
END
# shellcheck disable=SC2086
run 0 bake glossy.scene.json -o glossy.ply $few
for how in rays cones caches probes; do
	run 0 render glossy.ply -o $how.png --size 16x12 --samples 1 --glossy $how --profile |
		sed -n '/^glowworm/p'
done
run 0 render glossy.ply -o orbit.png -q --size 16x12 --samples 1 --glossy caches --orbit 2 \
	--camera 'at 0,-3.4,1 to 0,0,1 fov 46'
cat >three.ply <<'END'
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property float specular
property float roughness
property float scalar_radiance_r
property float scalar_radiance_g
property float scalar_radiance_b
end_header
0 0 0 0.5 0.2 1 1 1
0 1 0 0.5 0.2 1 1 1
0 1 1 0.5 0.2 1 1 1
END
run 0 render three.ply -o three.png --size 16x12 --samples 1 --glossy probes
ls ./*.png

# Views, each of which draws something else; and probes, kept and read again.
camera='at 0.5,-1.6,0.5 to 0.5,0.5,0.5 fov 40'
# shellcheck disable=SC2086
run 0 bake box.ply $few --light "$lamp name lamp" -o lit.ply
for view in cells:3 border:4 octree:4 samples opacity:4:+x radiance:4:-z records shaded; do
	run 0 render lit.ply -q -f -o view.png --size 16x12 --camera "$camera" --view "$view"
done
run 0 render lit.ply -q -f -o view.png --size 16x12 --camera "$camera" --view shadow:lamp \
	--light "$lamp name lamp" --shadows maps
run 0 compare lit.ply glossy.ply --worst worst.ply --worst-count 10 >figures.txt
run 0 render worst.ply -q -f -o view.png --size 16x12 --camera "$camera" --view error
probes='--rays 4 --moves 1 --size 8 -q -f'
# shellcheck disable=SC2086
run 0 probes box.ply $probes -o plain.exr --vdb plain.vdb --save-transport t.gwt
# shellcheck disable=SC2086
run 0 probes box.ply $probes -o again.exr --vdb again.vdb --transport t.gwt
cmp plain.exr again.exr

# Light by a grid, which is written; frames; shares of lamps; effects; points of no surface.
# shellcheck disable=SC2086
run 0 bake box.ply $few --method volume --volume-cells 4 --vdb-sh grid.vdb -o volume.ply
for method in lpv probes buffers; do
	# shellcheck disable=SC2086
	run 0 bake box.ply $few --method $method -f -o other.ply
done
glowworm plan box.ply --method buffers --rays 4 >plan.txt 2>&1 || cat plan.txt
echo '1e9,0,0,0,0,1' >stray.txt
{ printf 'x,y,z,nx,ny,nz\n'; cut -d, -f1-6 room.csv | tail -n +2; cat stray.txt; } >strays.csv
for strays in keep light; do
	# shellcheck disable=SC2086
	run 0 bake strays.csv $few --strays $strays --light "$lamp" --light "sky radiance 1" \
		--effects -portals --report report.json -f -o strays.ply
	grep -ac '^ "points": ' report.json
done
cat >moving.scene.json <<'END'
{"version": 1, "frames": 2, "inputs": [{"file": "box.ply"}, {"file": "box.ply",
 "path": [{"frame": 0, "scale": 0.1}, {"frame": 1, "scale": 0.1, "move": [0.1, 0, 0]}]}]}
END
# shellcheck disable=SC2086
run 0 bake moving.scene.json $few --frames all --profile -o moved-%d.ply |
	grep -c '^static\|^dynamic'
ls ./*.ply ./*.vdb
