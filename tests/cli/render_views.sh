# Views of what lies behind the light: cells, border tiles, voxels, shadows, records, errors. Each
# differs from the others, and every bad wish is one sentence with its status.
make_box --scene cornell --points 2000 -o box.ply
. "$SOURCE/tests/cli/shared_functions"
lamp='point at 0.5,0.4,0.7 intensity 1 name lamp'
run 0 bake box.ply -o lit.ply -q --light "$lamp" --estimate-points 0 --bounces 1
run 0 bake box.ply -o other.ply -q --light "$lamp" --estimate-points 0 --bounces 2
run 0 compare lit.ply other.ply --worst worst.ply --worst-count 2000 >figures.txt
camera='at 0.5,-1.6,0.5 to 0.5,0.5,0.5 fov 40'
for view in cells:3 cells:5 border:4 octree:4 samples opacity:4:+x opacity:4:-x radiance:4:+x \
	radiance:4:-z records shaded; do
	run 0 render lit.ply -o "$view.png" --size 120x90 --camera "$camera" --view "$view"
done
for shadows in traced maps none; do
	run 0 render lit.ply -o $shadows.png --size 120x90 --camera "$camera" --view shadow:lamp \
		--light "$lamp" --shadows $shadows
done
run 0 render lit.ply -o number.png --size 120x90 --camera "$camera" --view shadow:1 --light "$lamp"
run 0 render worst.ply -o error.png --size 120x90 --camera "$camera" --view error
run 0 render lit.ply -o cells.exr --size 64x48 --camera "$camera" --view cells:4
for file in *.png; do # the pixels, without what a picture says of itself
	tail -c +"$(($(grep -abo IDAT "$file" | head -n 1 | cut -d: -f1) + 1))" "$file" | cksum
done | sort | uniq -d | wc -l # a lamp by number is the lamp by name

# As many records as a bake places, more where surface is white.
make_box --scene furnace --points 3000 --albedo 0.9 --emission 0 -o white.ply
run 0 bake white.ply -o white_lit.ply -q --light 'point at 0,0,0 intensity 1' --estimate-points 0 \
	--report white.json
run 0 render white.ply -o white.png --size 64x48 --view records -v |
	sed -n 's/^shown *\([0-9]*\),.*/\1/p' >shown.txt
grep -o '"records": [0-9]*' white.json | sed 's/.* //' | cmp - shown.txt && echo same records

echo == bad wishes
bad() {
	run "$1" render "$2" -o x.png --view "$3"
}
bad 2 lit.ply cells
bad 2 lit.ply cells:
bad 2 lit.ply cells:0
bad 2 lit.ply cells:17
bad 2 lit.ply cells:16
bad 2 lit.ply cells:3:+x
bad 2 lit.ply border:-1
bad 2 lit.ply octree:
bad 2 lit.ply samples:2
bad 2 lit.ply opacity:3
bad 2 lit.ply opacity:3:up
bad 2 lit.ply radiance:99999999999999999999:+x
bad 2 lit.ply records:3
bad 2 lit.ply shadow:lamp
run 2 render lit.ply -o x.png --view shadow:lmap --light "$lamp"
run 2 render lit.ply -o x.png --view shadow:2 --light "$lamp"
run 2 render lit.ply -o x.png --view shadow:1 --light 'sky radiance 1'
bad 65 box.ply radiance:3:+x
bad 65 lit.ply error
run 65 render lit.ply -o x.png --view cells:4 --camera 'at 5,5,5 to 9,9,9'
ls x.* 2>/dev/null
true
