# A cloud with two lamps and the rest is mixed, by columns made by hand; and what is refused.
{
	printf 'ply\nformat ascii 1.0\ncomment glowworm command: glowworm bake a.ply\n'
	printf 'comment glowworm preview: EV 3\nelement vertex 2\n'
	printf 'property double %s\n' x y z
	printf 'property uchar %s\n' red green blue albedo_r albedo_g albedo_b
	printf 'property float scalar_%s\n' radiance_r radiance_g radiance_b direct_r \
		light_lamp_r light_lamp_g light_lamp_b light_torch_r light_torch_g light_torch_b \
		light_rest_r light_rest_g light_rest_b
	echo end_header
	echo 500000.25 0 0 9 9 9 200 100 50 7 7 7 0.5 1 2 4 2 1 1 4 4 2
	set -- 0.25 0.25 0.25
	echo 500000.50 0 0 9 9 9 200 100 50 0.75 0.75 0.75 0.5 $* $* $*
} >lit.ply
show() { # The columns' smallest and largest values, and the comments.
	glowworm info "$1" --json | tr '{}' '\n\n' | sed -n -e 's/.*"comments": /comments /p' \
		-e 's/^"name": "\(.*\)", "type.*"minimum": \(.*\), "maximum": \(.*\), "not.*/\1 \2 \3/p'
}
glowworm mix lit.ply --gain lamp=2 -g torch=0,1,0.5 --exposure 3 -o mixed.ply
show mixed.ply
# At the same strengths the same light; through a pipe.
glowworm mix lit.ply --gain rest=1 -q -o - | glowworm compare - lit.ply --max-relrmse 0 | sed -n 3p
# Colours of the surface itself stay.
grep -v 'albedo' lit.ply | sed 's/ 200 100 50 / /' >own.ply
glowworm mix own.ply --gain lamp=3 -q -o own-mixed.ply
show own-mixed.ply | grep -E '^(red|quality)'
# Refused.
run() {
	glowworm mix "$@" 2>&1
	echo "status $?"
}
run lit.ply --gain lamb=2 -o a.ply
run lit.ply --gain lamp=-1 -o a.ply
run lit.ply --gain lamp=1,2 -o a.ply
run lit.ply --gain lamp=1,2,3,4 -o a.ply
run lit.ply --gain lamp -o a.ply
run lit.ply --gain =2 -o a.ply
run lit.ply -o a.ply
run lit.ply --gain lamp=2
run --gain lamp=2 -o a.ply
run lit.ply --gain lamp=2 -o lit.ply -f
run lit.ply --gain lamp=2 -o mixed.ply
run lit.ply --gain lamp=2 -o a.obj
sed 's/ 7 7 7 / 7 8 7 /' lit.ply >less.ply
run less.ply --gain lamp=2 -o a.ply
grep -v light_torch_g lit.ply | sed 's/ 4 4 2$/ 4 4/; s/ 0.25$//' >hole.ply
run hole.ply --gain lamp=2 -o a.ply
ls -A | tr '\n' ' '
