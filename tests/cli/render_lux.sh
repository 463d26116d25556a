# Illuminance in pictures: by colours of a fixed scale, with lines; several inputs side by side by
# one camera, one exposure, one scale; and what makes no sense is refused.
make_box --scene cornell --points 1500 -o box.ply
. "$SOURCE/tests/cli/shared_functions"
data() { # the pixels of a PNG, without what it says of itself
	tail -c +"$(($(grep -abo IDAT "$1" | head -n 1 | cut -d: -f1) + 1))" "$1" | cksum
}
wide() { # width and height of a PNG
	od -An -tu1 -j16 -N8 "$1" | awk '{ print $3 * 256 + $4, $7 * 256 + $8 }'
}
light() { # name, strength and fields
	glowworm bake box.ply -q --estimate-points 0 --bounces 2 -o "$1.ply" --fields "$3" \
		--light "point at 0.5,0.5,0.5 intensity $2"
}
light dim 5cd illuminance
light bright 50cd illuminance,irradiance
light parts 50cd irradiance
light watts 5W/sr irradiance
light plain 5cd ao
small='--size 160x120 --samples 1'
camera='at 0.5,-1.6,0.5 to 0.5,0.5,0.5 fov 40'
picture() { # name input options...
	name=$1
	shift
	# shellcheck disable=SC2086
	run 0 render "$@" -o "$name.png" $small --camera "$camera"
}
# shellcheck disable=SC2086
{
	picture scaled bright.ply --view illuminance --scale 0,100
	picture again parts.ply --view illuminance --scale 0,100 # from the irradiance
	picture other bright.ply --view illuminance --scale 0,1000
	picture logarithmic bright.ply --view illuminance --scale 1,1000,log
	picture lines bright.ply --view illuminance --scale 0,100 --isolux 20,50,100
	picture fitted bright.ply --view illuminance
	picture irradiance watts.ply --view irradiance --false-colour --scale 0,50
	picture radiance bright.ply --false-colour --scale 0,50
	picture row dim.ply bright.ply --row
	picture row-lux dim.ply bright.ply dim.ply --row --view illuminance --isolux 20
	picture row-same bright.ply bright.ply --row
}
[ "$(data scaled.png)" = "$(data again.png)" ] || echo "lux differ from those of the irradiance"
for name in *.png; do
	data "$name"
done | sort | uniq -d | wc -l
wide row.png
wide row-lux.png

echo == bad wishes
run 65 render watts.ply -o x.png --view illuminance
run 65 render plain.ply -o x.png --view illuminance
run 65 render box.ply -o x.png --view illuminance
run 65 render plain.ply -o x.png --view irradiance
run 2 render bright.ply -o x.png --view illuminance --scale 500
run 2 render bright.ply -o x.png --view illuminance --scale 500,0
run 2 render bright.ply -o x.png --view illuminance --scale 0,500,log
run 2 render bright.ply -o x.png --scale 0,500
run 2 render bright.ply -o x.exr --view illuminance --scale 0,500
run 2 render bright.ply -o x.png --view illuminance --isolux 50,20
run 2 render bright.ply -o x.png --view illuminance --isolux ''
run 2 render bright.ply -o x.png --isolux 50
run 2 render bright.ply -o x.exr --view illuminance --isolux 50
run 2 render bright.ply -o x.png --row
run 2 render bright.ply dim.ply -o x.png --row --orbit 3
run 2 render bright.ply dim.ply -o x.exr --row
run 2 render bright.ply dim.ply dim.ply -o x.png --row --size 8000x10 --samples 1
run 65 render bright.ply box.ply -o x.png --row $small
run 65 render bright.ply watts.ply -o x.png --row $small
run 65 render bright.ply dim.ply -o x.png --row $small --camera 'at 9,9,9 to 10,10,10 fov 40'
ls x.* 2>/dev/null
true
