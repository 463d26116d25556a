# A bake by parts that was killed or stopped goes on with --resume: the same bytes as in one go, and
# nothing left behind; what it would go on with has to be whole and of the same bake.
# sanitize: no
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 90000 -o cave.ply
what="cave.ply --strays keep --effects lamps --memory 150M"
lamp='point at 3.4,0,1.9 intensity 40'
glowworm bake $what -q --light "$lamp" -o whole.ply
# Begins, and is sent a signal when some parts are written. One that is too quick is begun again.
to=lit.ply
stop_writing() { # signal options...
	signal=$1
	shift
	for attempt in 1 2 3 4 5; do
		rm -f $to said
		mkfifo said
		glowworm bake $what --light "$lamp" -o $to --progress json "$@" 2>said &
		parts=0
		while read -r line; do
			case $line in
			*'"write"'*) parts=$((parts + 1)) ;;
			*kept*) echo "$line" ;;
			esac
			[ $parts -ne 4 ] || kill -s "$signal" $! 2>/dev/null
		done <said
		wait $! 2>/dev/null
		[ -e $to ] || return 0
	done
	echo "it was never stopped"
}
stop_writing KILL --resume
ls lit.ply*
cp lit.ply.resume killed.resume
cp lit.ply.part killed.part
glowworm bake $what --light "$lamp" -o lit.ply --resume --progress json 2>said.txt
grep -o -e 'goes on with lit.ply.resume' -e '"octree"' said.txt
cmp lit.ply whole.ply && ls lit.ply*
# LAS, whose parts have places as well.
glowworm bake $what -q --light "$lamp" -o whole.las
to=lit.las
stop_writing KILL --resume
ls lit.las*
glowworm bake $what -q --light "$lamp" -o lit.las --resume
cmp lit.las whole.las && ls lit.las* && rm lit.las
to=lit.ply
# Stopped by the user: kept if asked for, else nothing is left.
stop_writing INT --resume
glowworm bake $what -q --light "$lamp" -o lit.ply --resume
cmp lit.ply whole.ply && rm -f lit.ply
stop_writing TERM
ls -A | grep lit
# A part that is not on the disk, and an account that was torn, are written again.
take_up() { cp killed.resume lit.ply.resume && cp killed.part lit.ply.part; }
damage() { # file offset
	printf '\125\252\125' | dd of="$1" bs=1 seek="$2" conv=notrunc status=none
}
take_up
damage lit.ply.part 200000
truncate -s -40 lit.ply.resume
glowworm bake $what -q --light "$lamp" -o lit.ply --resume
cmp lit.ply whole.ply && rm -f lit.ply
# Damage, other options, another input: refused, and nothing else is said.
resume() { run "$@" --memory 150M --resume -o lit.ply; }
take_up
damage lit.ply.resume 100
resume 65 bake ${what%--memory*} --light "$lamp"
take_up
damage lit.ply.resume 60000
resume 65 bake ${what%--memory*} --light "$lamp"
# As well where it ends within the points that were kept.
take_up
truncate -s 9000 lit.ply.resume
resume 65 bake ${what%--memory*} --light "$lamp"
take_up
resume 2 bake ${what%--memory*} --light 'sky radiance 2'
run 2 bake $what --memory 160M --light "$lamp" --resume -q -o lit.ply
touch -d '2001-02-03 04:05:06' cave.ply
resume 2 bake ${what%--memory*} --light "$lamp" |
	sed "s/ of [0-9]* bytes.*now/, now/
		s/ of [0-9]* bytes.*sum [0-9a-f]*//"
cmp lit.ply.resume killed.resume
# A command that is wrong leaves nothing that the right one could not go on with.
rm lit.ply.*
resume 2 bake ${what%--memory*} --light 'point at floor:77 intensity 3'
ls -A | grep '^lit\.ply'
take_up
# What nobody goes on with is named, and removed by --force.
make_cave --points 1000 -o few.ply
bake_few() { run 0 bake few.ply --light "$lamp" --effects lamps -o lit.ply "$@" | grep note; }
bake_few
ls lit.ply*
bake_few -f
ls lit.ply*
bake_few -f --resume
# Where it could not keep anything.
run 2 bake $what --light "$lamp" --resume -o -
run 2 bake $what --light "$lamp" --resume -o grid.ply --vdb grid.vdb
run 2 bake ${what%150M}278M --light "$lamp" --resume --save-transport kept -f -o lit.ply
