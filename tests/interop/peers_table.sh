# The table of the benchmarks has Blender's Cycles and CloudCompare's PCV, each measured.
. "$SOURCE/tests/interop/other_programs"
need blender CloudCompare xvfb-run
BUILD=$(dirname "$GLOWWORM") WORK=$PWD SCENES=cornell POINTS=1000 ROUNDS=1 SECONDS_A_WAY=1 \
	PATHS_A_POINT=16 WAYS='cycles PCV' \
	"$SOURCE/tests/bench/bench_table.py" bench.json >table.txt || exit
/usr/bin/python3 - <<'END'
import json

found = json.load(open("bench.json"))["scenes"]["cornell-1000"]
(cycles,) = found["ways"]["cycles"]["rounds"]
print("cycles", "lit" if cycles["rows"] and cycles["peak_bytes"] > 1e6 else cycles)
for program in ("PCV", "ours"):
    sky = found["sky"][program]
    print(program, "lit" if sky["processor_seconds"] > 0 and sky["peak_bytes"] > 1e6 else sky)
END
grep -c '^| cornell-1000 ' table.txt
