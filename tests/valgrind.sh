#!/usr/bin/env bash
# Small runs of the program, which together go every way through it, under valgrind: reads of
# memory that was never set, or is not ours. What filling memory, as suite.sh does, finds only
# where it shows in a result, valgrind finds where it is read.
#
#   valgrind.sh BUILD [FILE]...    files are read by `info`, beside those made here
#
# ONLY=WORD runs those whose name has it. One line a run: its name, exit status, errors, seconds.
# What valgrind said stays in BUILD/valgrind/NAME.log; of several runs of a name, as of files in
# different folders, the second one's is NAME-2.log. Exit status 1 when anything was found.
set -u
build=$(realpath -m "$1")
shift
here=$(cd "$(dirname "$0")" && pwd)
files=()
for file in "$@"; do files+=("$(realpath "$file")"); done
command -v valgrind >/dev/null || { echo "valgrind is not installed" >&2; exit 77; }
[ -n "${ONLY-}" ] || rm -rf "$build/valgrind/work"
mkdir -p "$build/valgrind/work" && cd "$build/valgrind/work" || exit 70
found=0
declare -A runs_of=()
export LC_ALL=C LP_NUM_THREADS=1 LP_NATIVE_VECTOR_WIDTH=128

# A run that is refused has not gone its way; 99 is valgrind's status.
run() { # name words...
	local name=$1 begin status errors log
	shift
	runs_of[$name]=$((${runs_of[$name]-0} + 1))
	[ "${runs_of[$name]}" -eq 1 ] || name=$name-${runs_of[$name]}
	log=$build/valgrind/$name.log
	case $name in *"${ONLY-}"*) ;; *) return ;; esac
	begin=$(date +%s)
	valgrind -q --error-exitcode=99 --num-callers=20 --suppressions="$here/errors_of_others.supp" \
		--trace-children=no --log-file="$log" "$build/glowworm" "$@" >"$build/valgrind/$name.out" \
		2>&1 </dev/null
	status=$?
	errors=$(grep -cE 'uninitialised|Invalid|overlap|Mismatched|Process terminating' "$log")
	[ "$errors" -eq 0 ] && [ "$status" -eq 0 ] || found=1
	printf '%-20s status %3d, %d errors, %4d s\n' "$name" "$status" "$errors" \
		$(($(date +%s) - begin))
}

# A cube seen from inside, of 96 points; its wall in z is of that opacity.
cube() { # columns value...
	awk -v more="$1" -v value="${2-}" 'BEGIN {
		OFS = ","
		print "x,y,z,nx,ny,nz,red,green,blue" more
		for (k = 0; k < 3; k++) for (s = -1; s < 2; s += 2)
			for (i = 0; i < 4; i++) for (j = 0; j < 4; j++) {
				p[k] = s; p[(k + 1) % 3] = (i - 1.5) / 2; p[(k + 2) % 3] = (j - 1.5) / 2
				n[k] = -s; n[(k + 1) % 3] = 0; n[(k + 2) % 3] = 0
				line = p[0] "," p[1] "," p[2] "," n[0] "," n[1] "," n[2] ",0.5,0.5,0.5"
				print line (more ? "," (k == 2 ? value : 1) : "")
			}
	}'
}

cube '' >cube.csv
cube ',opacity' 0.5 >clear.csv
# Without the middle of its wall above.
awk -F, '!($3 == 1 && $1 ^ 2 + $2 ^ 2 < 0.2)' cube.csv >open.csv
awk -F, 'NR == 1 || $1 < 1 { print $1 "," $2 "," $3 }' cube.csv >bare.csv
printf 'v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\n' >floor.obj
printf '%s\n' IESNA:LM-63-2002 TILT=NONE '1 100 1 3 1 1 2 0.1 0.1 0' '1 1 4' '0 45 90' 0 '9 5 0' \
	>lamp.ies
# 8 x 4 pixels of 1.
{
	printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n'
	for _ in {1..32}; do printf '\200\200\200\201'; done
} >sky.hdr
cat >moving.scene.json <<'END'
{"version": 1, "frames": 2, "inputs": [{"file": "cube.csv"}],
 "lights": [{"type": "point", "position": [0, 0, 0], "intensity": 1,
             "path": [{"frame": 0, "position": [0, 0, 0]}, {"frame": 1, "position": [0.2, 0, 0]}]}]}
END
"$build/samples/make_cave" --points 500 --format e57 -o cave.e57
"$build/samples/make_cave" --points 500 --format ptx -o cave.ptx
"$build/samples/make_cave" --points 500 --noise 0.05 -o cave.ply
"$build/samples/make_box" --scene cornell --points 600 -o cornell.ply
for format in las pcd xyz csv cloud; do
	"$build/glowworm" convert cave.ply cave.$format -q -f || exit 70
done

quick='--threads 1 --least-records 40 --rays 8 --light-samples 8 --cones 6 --bounces 3 -f'
lamp='point at 0.1,0.2,0.3 intensity 1 name lamp'

# Readers and what is computed without a device.
for file in cave.{ply,e57,ptx,las,pcd,xyz,csv,cloud}; do
	run "info ${file##*.}" info "$file"
	run "measure ${file##*.}" info --stats "$file"
done
for file in ${files[@]+"${files[@]}"}; do
	run "info ${file##*/}" info "$file"
done
for format in ply las pcd e57 xyz csv cloud; do
	run "convert $format" convert cave.ply out.$format -f
done
run places info cave.ptx --places
run sample sample floor.obj --count 50 -o out.ply -f
run lamp lamp lamp.ies -o out.png -f
run lamps lamp

# Bakes; what the first ones write is read by what follows.
run 'bake rays' bake cube.csv -o lit.ply --light "$lamp" $quick --estimate-points 8 \
	--fields lights,error,ao,direct,irradiance \
	--save-transport cube.transport --report out.json --vdb out.vdb
run 'bake again' bake cube.csv -o again.ply --transport cube.transport --light 'sky radiance 1' \
	$quick --estimate-points 8
run 'bake cones' bake cube.csv -o cones.ply --method cones --shadows maps --shadow-map-size 32 \
	--light "$lamp" $quick --estimate-points 4
run 'bake bare' bake bare.csv -o bare.ply --light 'sky radiance 1' --light "$lamp" $quick \
	--estimate-points 8
run 'bake scanners' bake cave.ptx -o cave.lit.ply --gaps mean $quick \
	--light 'sun from 100,50 irradiance 3' \
	--estimate-points 8
run 'bake glow' bake cornell.ply -o cornell.lit.ply $quick --estimate-points 8
run 'bake opacity' bake clear.csv -o clear.ply --light "$lamp" --light 'sky radiance 1' $quick \
	--estimate-points 8
run 'bake ies' bake cube.csv -o ies.ply --light 'point at 0,0,0 ies lamp.ies to 0,0,-1' $quick \
	--estimate-points 0 --fields illuminance
run 'bake portals' bake open.csv -o portals.ply --light 'sky radiance 1' $quick --estimate-points 8
run 'bake map' bake open.csv -o map.ply --light 'sky map sky.hdr rotation 30' $quick \
	--estimate-points 8
run 'bake mesh' bake floor.obj --density 20 -o mesh.ply --light "$lamp" $quick --estimate-points 8
run 'bake frames' bake moving.scene.json -o frame-%d.ply --frames all $quick --estimate-points 0
run 'bake round' bake cube.csv -o round.ply --light "$lamp" --max-error 0.5 --threads 1 -f
run plan plan cube.csv --light "$lamp"

# What is made of lit clouds.
if [ -e lit.ply ]; then
	run mix mix lit.ply --gain lamp=2 -o mixed.ply -f
	run compare compare lit.ply mixed.ply --worst worst.ply --json out.json -f
	run measure measure lit.ply
	run 'render points' render lit.ply -o out.png --size 32x24 -f
	run 'render exr' render lit.ply -o out.exr --size 32x24 --view direct -f
	run 'render lux' render ies.ply -o out.png --size 32x24 --view illuminance --false-colour -f
	run 'render mesh' render lit.ply --mesh floor.obj -o out.png --size 32x24 -f
	run 'render octree' render cube.csv -o out.png --size 32x24 --view cells:2 -f
fi
run albedo albedo cube.csv --capture-scale 0.5 --light "$lamp" -o albedo.ply -f
run doctor doctor
exit $found
