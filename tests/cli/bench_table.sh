# The table of the benchmarks: every way is measured, what one way reached is its least time, and
# the ratios are of the medians; a second round adds to the first. Other programs are left to
# interop/peers_table.sh.
# sanitize: no
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
BUILD=$(dirname "$GLOWWORM") WORK=$PWD SCENES=cornell POINTS=1000 ROUNDS=2 SECONDS_A_WAY=1 \
	PATHS_A_POINT=16 WAYS='paths cached presets targets surfaces' \
	"$SOURCE/tests/bench/bench_table.py" bench.json >table.txt || exit
/usr/bin/python3 - <<'END'
import json
import statistics

result = json.load(open("bench.json"))
found = result["scenes"]["cornell-1000"]
for way in ("paths", "cached", "presets", "targets", "surfaces"):
    w = found["ways"][way]
    if len(w["rounds"]) != 2 or not all(r["peak_bytes"] > 1e6 for r in w["rounds"]):
        print(way, "was not measured twice")
    if way != "surfaces" and not all(r["rows"] for r in w["rounds"]):
        print(way, "has no row")  # of 1,000 points none are left out
    took = [
        [r["processor_seconds"] for r in round["rows"] if r["relative_rms"] <= 0.05]
        for round in w["rounds"]
    ]
    median = statistics.median(min(t) for t in took) if all(took) else None
    if w["processor_seconds_to_5_percent"] != median:
        print(way, "took", w["processor_seconds_to_5_percent"], "to 5 %, by its rows", median)
b = found["bake"]
if not (b["points"] > 900 and b["error"] > 0 and b["microseconds_a_point"]["octree"] > 0):
    print("the bake:", b)
if not (b["processor_seconds"] > 0 and b["second_lighting_processor_seconds"] > 0):
    print("the second lighting:", b)
END
grep -c '^| cornell-1000 | \(paths\|cached\|presets\|targets\|surfaces\) |' table.txt
