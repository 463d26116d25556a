# Bad inputs and outputs: the status tells the class, the message names the file.
header() { # points
	printf 'ply\nformat ascii 1.0\nelement vertex %s\n' "$1"
	printf 'property float %s\n' x y z
	echo end_header
}
. "$SOURCE/tests/cli/shared_functions"
header 0 >zero.ply
header 2 >short.ply
echo 1 2 3 >>short.ply
{ header 1; echo 1 2 3; } >one.ply
: >empty.ply
lamp='sky radiance 1'
run 66 bake missing.ply --light "$lamp" -o out.ply
run 66 info missing.ply
run 66 bake . --light "$lamp" -o out.ply
run 65 bake zero.ply --light "$lamp" -o out.ply
run 65 info zero.ply
run 65 bake short.ply --light "$lamp" -o out.ply
run 65 bake empty.ply --light "$lamp" -o out.ply
run 65 bake - --light "$lamp" -o out.ply </dev/null
run 2 bake one.ply -o out.ply
run 2 bake one.ply --light "$lamp" --albedo rgb -o out.ply
run 2 bake one.ply --light "$lamp" --albedo property:wetness -o out.ply
run 73 bake one.ply --light "$lamp" -o missing/out.ply
run 73 bake one.ply --light "$lamp" -o /proc/out.ply
run 73 bake one.ply --light "$lamp" -o out.ply --report missing/report.json
run 73 bake one.ply --light "$lamp" -o out.ply --vdb missing/grid.vdb
run 2 bake one.ply --light "$lamp" -o one.ply --force
touch there.ply
run 73 bake one.ply --light "$lamp" -o there.ply
# Nothing was left behind.
ls -A
