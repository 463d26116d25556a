# Points of no surface get light, but change that of no other point: the zero point, one at 1e9 m,
# one in a thousand in the air, in coordinates as surveyors have them. They are counted by kind;
# --strays keep takes them for surface, --strays drop leaves them out.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene rooms --points 8000 -o rooms.ply
glowworm convert rooms.ply rooms.csv 2>/dev/null
awk -F, 'NR == 1 { print; next } { printf "%.6f,%.6f,%.6f", $1 + 500000, $2 + 5300000, $3 + 400
	for (i = 4; i <= NF; i++) printf ",%s", $i
	print "" }' rooms.csv >clean.csv
# In the middle of the room that is lit. The two far away are nearest to that, too: the other room
# is dark.
awk -F, 'BEGIN { srand(5) } NR == 1 { print; next } NR == 2 { split($0, first, ",")
	for (i = 0; i < 22; i++) {
		printf i == 20 ? "0,0,0" : i == 21 ? "-1e9,5300000,400" : "%.6f,%.6f,%.6f",
			500000.4 + 1.2 * rand(), 5300000.4 + 1.2 * rand(), 400.4 + 1.2 * rand()
		for (k = 4; k <= NF; k++) printf ",%s", (k > NF - 3 ? 0 : first[k])
		print "" } }
	{ print }' clean.csv >strays.csv
# Bakes are compared byte for byte, which any number of rays shows.
bake() { # name, input, options
	name=$1
	shift
	glowworm bake "$@" --estimate-points 0 --rays 16 --colors keep --report "$name.json" \
		-o "$name-lit.csv" 2>"$name.notes"
}
bake clean clean.csv
bake strays strays.csv
bake drop strays.csv --strays drop
bake keep strays.csv --strays keep
cat strays.notes
glowworm info --stats strays.csv | grep '^  strays'
glowworm info --stats clean.csv | grep -c strays || :
grep -o '"kind": "[a-z ]*", "points": [0-9]*, "example": [0-9]*' strays.json
sed 2,23d strays-lit.csv | cmp - clean-lit.csv && echo "no point that is none changed"
cmp drop-lit.csv clean-lit.csv && echo "dropped"
sed -n 2,23p strays-lit.csv | awk -F, '$NF > 0 { lit++ } END { print lit, "strays have light" }'
grep -c stray keep.notes || :
sed 2,23d keep-lit.csv | cmp -s - clean-lit.csv || echo "kept, they shade"
# A LAS file says itself what is noise, and what is withheld.
awk -F, 'BEGIN { OFS = "," } NR == 1 { print "x,y,z,nx,ny,nz,classification,withheld"; next }
	{ print $1, $2, $3, $4, $5, $6, NR % 100 == 50 ? 7 : NR % 100 == 60 ? 18 : 2,
		NR % 100 == 70 ? 1 : 0 }' rooms.csv >classes.csv
glowworm convert classes.csv classes.las 2>/dev/null
bake las classes.las --light 'point at 0.5,0.5,0.5 intensity 1' --albedo constant:0.5
bake asked classes.las --light 'point at 0.5,0.5,0.5 intensity 1' --albedo constant:0.5 \
	--strays keep
bake other classes.csv --light 'point at 0.5,0.5,0.5 intensity 1' --albedo constant:0.5
grep -o '"kind": "[a-z ]*", "points": [0-9]*, "example": [0-9]*' las.json
grep -c stray asked.notes other.notes || :
# Other formats that LAS was written as know it, too.
for to in ply e57 pcd xyz; do
	glowworm convert classes.las "classes.$to"
	glowworm info --stats "classes.$to" | grep -o '[0-9][0-9]* noise\|[0-9][0-9]* withheld' |
		xargs echo "$to"
done
