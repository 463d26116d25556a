# A line a lamp at the end of a bake: what share of the light it gives, or why it gives none; the
# same in the report; nothing to say of a lamp that is alone.
make_box --scene rooms --points 3000 --emission 0 -o rooms.ply
bake() {
	glowworm bake rooms.ply -o lit.ply -f --estimate-points 0 --bounces 2 "$@" 2>&1 |
		grep -v 'the surface has\|may face the wrong way'
}
echo == shares, and a far lamp
bake --light 'point at 0.5,0.5,0.5 intensity 30 name thrice' \
	--light 'point at 0.5,0.5,0.5 intensity 10' --report report.json \
	--light 'point at 5000.5,0.5,0.5 intensity 10 name far' |
	sed 's/ 7[456] %/ three quarters/; s/ 2[456] %/ one quarter/; s/\(it is\) [0-9]* m/\1 N m/'
# Light samples are noisy by a hundredth.
sed -n '/"light_shares"/,/\]/p' report.json | sed 's/"share": 0.7[456][0-9]*/"share": 0.75/
	s/"share": 0.2[456][0-9]*/"share": 0.25/; s/"share": [0-9.e-]*e-[0-9]*/"share": SMALL/
	s/"outside": [1-9][0-9.]*/"outside": FAR/'
echo == nothing
bake --light 'point at 0.5,0.5,0.5 intensity 0 name black' \
	--light 'spot at 0.5,0.5,-1 to 0.5,0.5,-3 intensity 5 name away' \
	--light 'sun from 90,45 irradiance 3' --light 'point at 0.5,0.5,0.5 intensity 1'
echo == many
set --
for i in 1 2 3 4 5 6 7; do
	set -- "$@" --light "point at 0.5,0.5,0.5 intensity $i" --light 'point at 1,1,1 intensity 0'
done
bake "$@"
echo == doubtful
# A lamp under the floor, as strong as the one above it, on a few points there; a wall throws a
# shadow of which the edge has an error.
{
	echo x y z nx ny nz
	awk 'BEGIN {
		for (i = 0; i < 10000; i++)
			print i % 100 / 50, int(i / 100) / 50, (i * 7919 % 13 - 6) / 500, 0, 0, 1
		for (i = 0; i < 100; i++)
			print i % 10 / 50, int(i / 10) / 50, -0.5, 0, 0, -1
		for (i = 0; i < 1000; i++)
			print 0.5 + i % 20 / 50, 0.8, 0.1 + int(i / 20) / 100, 0, 1, 0
	}'
} >floor.xyz
glowworm bake floor.xyz -o lit.ply -f --albedo constant:0.5 --normals given --report report.json \
	--light 'point at 1,1,1 intensity 10 name above' \
	--light 'point at 1.9,1.9,-0.55 intensity 10 name below' \
	--light 'point at 1,1,1 intensity 0.0001 name weak' 2>&1 |
	sed -n "s/.*light '\([a-z]*\)': [0-9.e-]* %/\1: N %/p"
grep -c '"doubtful": true' report.json
# In a cave of few points light leaks in from below its floor; a lamp there is behind what is
# nearest to it.
make_cave --points 20000 -o cave.ply
glowworm bake cave.ply -o lit.ply -f --bounces 1 \
	--light 'point at 13.5,2.6,1.8 intensity 190 name hall' \
	--light 'point at 13.5,2.6,-3 intensity 190 name below' \
	--light 'point at 24.8,0,1.1 intensity 5 name small' 2>&1 |
	sed -n "s/.*light '\([a-z]*\)': [0-9.e-]* %/\1: N %/p"
# By itself as well, where there is no other to compare with; one in the open needs no line.
glowworm bake cave.ply -o lit.ply -f --bounces 1 --report report.json \
	--light 'point at 13.5,2.6,-3 intensity 190 name below' 2>&1 |
	sed -n "s/.*light '\([a-z]*\)': [0-9.e-]* %/\1: N %/p"
grep -c '"doubtful": true' report.json
glowworm bake cave.ply -o lit.ply -f --bounces 1 \
	--light 'point at 13.5,2.6,1.8 intensity 190 name hall' 2>&1 |
	grep -c 'behind the surface'
echo == alone
bake --light 'point at 0.5,0.5,0.5 intensity 1'
bake --quiet "$@"
true
