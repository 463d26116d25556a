# A line a lamp at the end of a bake: what share of the light it gives, or why it gives none; the
# same in the report; nothing to say of a lamp that is alone.
make_box --scene rooms --points 6000 --emission 0 -o rooms.ply
bake() {
	glowworm bake rooms.ply -o lit.ply -f --estimate-points 0 --bounces 2 "$@" 2>&1 |
		grep -v 'the surface has\|may face the wrong way'
}
echo == shares, and a far lamp
bake --light 'point at 0.5,0.5,0.5 intensity 30 name thrice' \
	--light 'point at 0.5,0.5,0.5 intensity 10' --report report.json \
	--light 'point at 5000.5,0.5,0.5 intensity 10 name far' |
	sed 's/ 7[45] %/ three quarters/; s/ 2[56] %/ one quarter/; s/\(it is\) [0-9]* m/\1 N m/'
sed -n '/"light_shares"/,/\]/p' report.json | sed 's/"share": 0.7[45][0-9]*/"share": 0.75/
	s/"share": 0.2[56][0-9]*/"share": 0.25/; s/"share": [0-9.e-]*e-[0-9]*/"share": SMALL/
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
echo == alone
bake --light 'point at 0.5,0.5,0.5 intensity 1'
bake --quiet "$@"
true
