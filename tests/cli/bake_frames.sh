# Frames: a cube and a lamp that move through the Cornell box, against bakes of the same frames from
# scratch; back at the start; names; and what is refused.
cp "$SOURCE/samples/cornell.obj" "$SOURCE/samples/cornell.mtl" "$SOURCE/samples/cornell_cube.obj" .
cat >box.scene.json <<'END'
{"version": 1, "frames": 4,
 "inputs": [{"file": "cornell.obj"},
            {"file": "cornell_cube.obj",
             "matrix": [0.6,0,0,0.3, 0,0.6,0,0.1, 0,0,0.6,0.301, 0,0,0,1],
             "path": [{"frame": 0, "move": [0,0,0], "rotate": [0,0,0]},
                      {"frame": 2, "move": [-0.7,0.2,0.3], "rotate": [0,0,50]},
                      {"frame": 3, "move": [0,0,0], "rotate": [0,0,0]}]}],
 "lights": [{"type": "point", "position": [-0.6,-0.5,1], "intensity": 1,
             "path": [{"frame": 0, "position": [-0.6,-0.5,1]},
                      {"frame": 2, "position": [0.6,-0.5,1]},
                      {"frame": 3, "position": [-0.6,-0.5,1]}]}],
 "bake": {"count": 2000, "estimate_points": 0}}
END
bake() {
	glowworm bake box.scene.json -q --exposure 0 "$@"
}
bake --frames all --independent -o same-%d.ply
bake --frames all --rebuild -o scratch-%02d.ply
bake --frames all -o carried.ply --report frames.json
bake -o first.ply
bake --frames all --independent --explain -o same-%d.ply --force 2>&1 |
	grep -c '^foretold\|^came\|each of 3 more'
glowworm plan box.scene.json --frames 1..2 --json | grep -c '"frame_seconds"'
echo *.ply
. "$SOURCE/tests/cli/shared_functions"
# Only rays that graze the edge of a cell may differ from scratch, 1e-4 of them at most.
for i in 0 1 2 3; do
	glowworm compare same-$i.ply scratch-0$i.ply --max-relrmse 0.0005 >/dev/null || echo "frame $i"
	# Bounces may leave out 0.001 of the light, on both sides; at worst all of it on the cube, which
	# has a tenth of the points: 0.002 / sqrt(0.1).
	glowworm compare carried-000$i.ply scratch-0$i.ply --max-bias 0.002 --max-relrmse 0.0063 \
		>/dev/null ||
		echo "carried frame $i"
done
# The movement shows; back at the start everything is as it was; a frame does not depend on others.
glowworm compare same-1.ply scratch-02.ply --max-relrmse 0.05 >/dev/null 2>&1 &&
	echo 'nothing moved'
[ "$(body same-0.ply)" = "$(body same-3.ply)" ] || echo 'not as at the start'
bake --frames 2 --independent -o alone-%d.ply
[ "$(body same-2.ply)" = "$(body alone-2.ply)" ] || echo 'frame 2 alone is another'
# Killed once the first is there: what has its name is whole, and the others are what they would
# have been.
glowworm bake box.scene.json -q --exposure 0 --frames all --independent -o killed-%d.ply &
until [ -e killed-0.ply ] || ! kill -0 $! 2>/dev/null; do sleep 0.01; done
kill -9 $! 2>/dev/null
wait $! 2>/dev/null
next=1
while [ -e killed-$next.ply ]; do next=$((next + 1)); done
[ $next -gt 3 ] || bake --frames $next..3 --independent -o killed-%d.ply
for i in 0 1 2 3; do
	[ "$(body killed-$i.ply)" = "$(body same-$i.ply)" ] || echo "frame $i after a kill is another"
done
[ "$(body first.ply)" = "$(body scratch-00.ply)" ] || echo 'without --frames it is not frame 0'
sed -n -e 's/.*"frame": \([0-9]*\),.*"file": "\([^"]*\)".*/\1 \2/p' frames.json
head -c 4000 same-2.ply | grep -a 'comment glowworm frame'
# A line a lamp, of all frames together, and its share of each in the report: what glows takes some
# from the one that shines, and the black one has none.
glowworm bake box.scene.json --frames 0..1 -f -o shares-%d.ply --report shares.json \
	--light 'point name black at 0,0,1 intensity 0' 2>&1 |
	sed -n '/light /s/ [0-9]* %/ N %/p; /black/p'
grep -c '"light_shares": \[0\.[0-9]*, 0\]' shares.json
# The first says how wrong it is, and what else a bake says; of one frame alone there is no mean.
for range in 0..1 1; do
	glowworm bake box.scene.json --frames $range -f -o said-%d.ply --estimate-points 64 \
		2>&1 | sed -n 's/ [0-9.]* % +- .*//p; s/^.* % \(of the light before\)/\1/p'
done
# Refused: one sentence each.
try() { # scene's end, option...
	end=$1
	shift
	printf '{"version": 1, "frames": 3, "inputs": [{"file": "cornell_cube.obj", %s' "$end" >bad.json
	glowworm bake bad.json "$@" 2>&1
	echo "status $?"
}
still='"density": 100}], "lights": [{"type": "environment", "radiance": 1}]}'
try '"path": [{"frame": 3, "scale": 2}]}]}' --frames all -o x.ply
try '"path": []}]}' --frames all -o x.ply
try '"path": [{"frame": 1}]}]}' --frames all -o x.ply
try '"path": [{"frame": 1, "scale": 0}]}]}' --frames all -o x.ply
try '"path": [{"frame": 1, "mvoe": [0,0,0]}]}]}' --frames all -o x.ply
try '"path": [{"frame": 1, "scale": 2}, {"frame": 1, "scale": 2}]}]}' --frames all -o x.ply
try '"pivot": [0,0,0]}]}' --frames all -o x.ply
try '"matrices": [[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]]}]}' --frames all -o x.ply
try '"matrices": [[1,0,0,0, 0,0,0,0, 0,0,1,0, 0,0,0,1]]}]}' --frames all -o x.ply
one='[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]'
try "\"matrices\": [$one, $one, [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]], $still" --frames all -o x.ply
try "$still" --frames 1..3 -o x.ply
try "$still" --frames 2..1 -o x.ply
try "$still" --frames now -o x.ply
try "$still" --frames all -o x-%s.ply
try "$still" --frames all -o -
try "$still" --frames all --vdb x.vdb
try "$still" --frames all -o same-%d.ply
try "$still" --independent -o x.ply
try "$still" --frames all --resume -o x.ply
try '"density": 100}], "lights": [{"type": "point", "position": [0,0,2], "intensity": 1,
 "path": [{"frame": 0, "name": "a"}]}]}' --frames all -o x.ply
glowworm bake cornell_cube.obj --frames all -o x.ply 2>&1
echo "status $?"
