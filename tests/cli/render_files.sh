# Pictures: of an unlit and of a lit cloud, to a file and to a pipe, one and several; the same bytes
# for any number of threads; and every bad wish is one sentence with its status.
make_box --scene cornell --points 3000 -o box.ply
signature() {
	head -c 8 "$1" | od -A n -t x1 | tr -d ' \n'
	echo " $1"
}
. "$SOURCE/tests/cli/shared_functions"
small='--size 200x120'
# shellcheck disable=SC2086
{
	run 0 render box.ply -o one.png $small -j 1
	run 0 render box.ply -o two.png $small -j 2
	cmp one.png two.png
	run 0 render box.ply -o one.exr $small --samples 1
	run 0 render box.ply -o depth.png $small --view depth
	run 0 render box.ply -o clear.png $small --background none
	glowworm render - -o - $small <box.ply >pipe.png -q
	signature one.png
	signature one.exr
	signature pipe.png
	run 0 render box.ply -o around.png $small --orbit 3
	# The camera that was chosen is printed as options that take the same picture again.
	glowworm render box.ply -o chosen.png $small 2>said.txt
	taken=$(sed -n 's/.*: --camera/--camera/p' said.txt)
	eval "glowworm render box.ply -o again.png $small $taken"
	for file in chosen again; do # the pixels, without what a picture says of itself
		start=$(grep -abo IDAT $file.png | head -n 1 | cut -d: -f1)
		tail -c +"$((start + 1))" $file.png >$file.txt
	done
	cmp chosen.txt again.txt
	printf '# two cameras\n\nat 9,8,7 to 0,0,0 fov 30\noutside\n' >path.txt
	run 0 render box.ply -o walk.png $small --path path.txt --up z -q
	ls around-*.png walk-*.png

	# Points far off, in the picture's middle or at the end of the world, change nothing but by
	# a disc's width.
	glowworm convert box.ply plain.txt --output-format xyz -f
	{ cat plain.txt; echo 300 0 -40; echo 1e9 0 0; } | awk '{ print $1, $2, $3 }' >far.txt
	awk '{ print $1, $2, $3 }' plain.txt >near.txt
	for file in near far; do
		glowworm render $file.txt -o $file.png $small 2>&1 | sed -n 's/.*at \([^,]*\),.*/\1/p'
	done | awk '{ x[NR] = $1 } END { print NR, (x[1] - x[2]) ^ 2 < 0.03 ^ 2 }'

	echo == bad wishes
	run 2 render box.ply $small
	run 2 render -o x.png
	run 2 render box.ply -o x.jpg
	run 2 render box.ply -o x.png --size 0x10
	run 2 render box.ply -o x.png --size 99999x10
	run 2 render box.ply -o x.png --background red
	run 2 render box.ply -o x.exr --false-colour
	run 2 render box.ply -o x.png --camera 'at 1,2,3 to 1,2,3'
	run 2 render box.ply -o x.png --camera 'at 0,0,9 to 0,0,0' --up z
	run 2 render box.ply -o x.png --camera 'at 0,0,9 to 0,0,0 fov 0'
	run 2 render box.ply -o x.png --camera 'at 0,0,9 to 0,0,0 fov 180'
	run 2 render box.ply -o x.png --camera 'at 0,0,9 to 0,0,0 fov -1'
	run 2 render box.ply -o x.png --camera 'form 1,2,3'
	run 2 render box.ply -o x.png --camera auto --path path.txt
	run 2 render box.ply -o x.png --samples 9
	run 2 render box.ply -o x.png --view sideways
	run 2 render box.ply -o - --orbit 2
	printf 'outside\nat 1,2 to 3,4,5\n' >bad.txt
	run 65 render box.ply -o x.png --path bad.txt
	printf '# nothing\n' >bad.txt
	run 65 render box.ply -o x.png --path bad.txt
	run 66 render box.ply -o x.png --path missing.txt
	run 65 render box.ply -o x.png $small --camera 'at 90,90,90 to 99,99,99'
	run 65 render box.ply -o x.png --view radiance
	run 65 render box.ply -o x.png --view direct
	run 66 render missing.ply -o x.png
	run 73 render box.ply -o missing/x.png
	run 73 render box.ply -o one.png
	run 73 render box.ply -o around.png --orbit 2
	{
		printf 'ply\nformat ascii 1.0\nelement vertex 0\n'
		printf 'property float %s\n' x y z
		echo end_header
	} >none.ply
	run 65 render none.ply -o x.png
	ls -A | grep -v '^[a-z]*\(-000[0-9]\)*\.\(png\|exr\|ply\|txt\)$'
	ls x.* 2>/dev/null
}
true
