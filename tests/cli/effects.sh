# Effects that are chosen, forced and forbidden; what a plan says; and sentences for what can't be.
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
{
	printf 'ply\nformat ascii 1.0\nelement vertex 800\nproperty float x\nproperty float y\n'
	printf 'property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 400; i++) print i % 20 * 0.1, int(i / 20) * 0.1, 0, 0, 0, 1
		for (i = 0; i < 400; i++) print 0, i % 20 * 0.1, int(i / 20) * 0.1, 1, 0, 0 }'
} >corner.ply
lit() {
	glowworm bake corner.ply -q --albedo constant:0.5 -o lit.ply --force "$@" &&
		glowworm convert lit.ply - --output-format csv --columns x,y,z,radiance | sha256sum
}
lamp='point name lamp at 1,1,1 intensity 5'
away='spot name away at 1,1,3 to 1,1,9 intensity 5 inner 10 outer 20'
# The words of a plan; figures are another machine's.
plan() {
	glowworm plan corner.ply --albedo constant:0.5 "$@" |
		sed -E '/^foretold|^  /d; s/ +[0-9.]+ s  / /; s/ +/ /g'
}
echo "-- plan"
plan --light "$lamp" --light "$away" --bounces 1
echo "-- dark"
plan 2>&1
echo "-- without shadows and bounces"
plan --light "$lamp" --effects lamps,error
glowworm bake corner.ply -q --light "$lamp" --effects lamps,error --report report.json -o lit.ply
sed -nE '/"pass_runs"/,/]/s/.*"name": "([a-z_]*)".*/ran: \1/p' report.json
# Forced effects and an explained bake give the same light.
lit --light "$lamp" >plain.txt
for effects in auto all +gaps,+sky; do
	lit --light "$lamp" --effects "$effects" | cmp - plain.txt && echo "same: $effects"
done
lit --light "$lamp" --explain 2>explained.txt | cmp - plain.txt && echo "same: explained"
grep -c '^foretold\|^came' explained.txt
lit --light "$lamp" --effects=-bounces >direct.txt
lit --light "$lamp" --bounces 1 | cmp - direct.txt && echo "as one bounce"
cmp -s direct.txt plain.txt || echo "other than with bounces"
# Also where what is foretold finds out what surface keeps apart, by which records are placed: in a
# cave whose light comes from the sky and from what glows.
make_cave --points 1000 -o cave.ply
in_cave() {
	glowworm bake cave.ply --light 'sky radiance 1' --strays keep --rays 8 -f -o lit.ply "$@" \
		>/dev/null 2>&1
	body lit.ply
}
for how in '--method rays' '--method volume' '--max-error 0.5'; do
	[ "$(in_cave $how)" = "$(in_cave $how --explain)" ] && echo "same: explained cave, $how"
done
# Where the surface is in doubt, half of the points will be baked: the error that is foretold has
# what they may add, and what came says how much of it is by them.
sed -n '/end_header/,$p' corner.ply | awk 'NR > 1 { off = 0.04 * (NR * 37 % 23 / 23 - 0.5)
	print $1 + off * ($1 == 0), $2, $3 + off * ($3 == 0) }' >bare.xyz
glowworm bake bare.xyz --albedo constant:0.5 --light "$lamp" --explain -f -o lit.ply 2>&1 |
	sed -nE '/^(foretold|came)/s/[0-9.]+/N/gp' | sed 's/ s, .*, error/ error/; s/, N refl.*//'
# Points of the same with normals, few of them afar: hills that few points see are in doubt too.
awk 'BEGIN { print "x,y,z,nx,ny,nz"
	for (i = 0; i < 4000; i++) {
		r = exp(i / 4000 * log(40)); a = 2.399963 * i; x = r * cos(a); y = r * sin(a)
		s = 0.8 * cos(2 * x); l = sqrt(1 + s * s)
		print x "," y "," 0.4 * sin(2 * x) "," -s / l ",0," 1 / l } }' >hills.csv
glowworm bake hills.csv --albedo constant:0.5 --light 'sun direction 1,0,-0.5 irradiance 3' \
	--explain -f -o lit.ply 2>&1 |
	sed -nE '/^(foretold|came)/s/[0-9.]+/N/gp; /half of the points gives/p' |
	sed -E 's/ s, .*, error/ error/; s/, N refl.*//; s/is [0-9.]+ %/is N %/'
# From a scene file, and back into one.
cat >scene.json <<'END'
{"version": 1, "inputs": [{"file": "corner.ply"}], "bake": {"effects": "auto,-bounces,+octree"},
 "lights": [{"type": "point", "position": [1, 1, 1], "intensity": 5}]}
END
glowworm bake scene.json --print-scene -o lit.ply | grep effects
glowworm plan corner.ply --light "$lamp" --json | grep -c '"effect"\|"forecast"'
for bad in bouncing '+' ',' -octree 'lamps,,sky'; do
	glowworm plan corner.ply --light "$lamp" --effects="$bad" 2>&1
	echo "exit $?"
done
glowworm plan corner.ply --light "$lamp" --shadows none --effects +shadows 2>&1
echo "exit $?"
glowworm plan 2>&1
echo "exit $?"
