# Memory and threads that run out in the program or in a library: the bake ends with 71 and a
# sentence, or it is as it would have been; no temporary file is left. Grids that fail do not cost
# the points. Sanitizers have an allocator of their own.
# sanitize: no
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
shim=$(dirname "$GLOWWORM")/tests/torture/fault_shim.so
[ -f "$shim" ] || { echo "$shim was not built"; exit 77; }
make_box --scene cornell --points 300 -o box.ply

bake() { # environment...
	rm -f points.ply grids.vdb
	env "$@" LD_PRELOAD="$shim" timeout -k 1 60 glowworm bake box.ply --light 'sky radiance 1' \
		--quiet -o points.ply --vdb grids.vdb 2>said
}

check() { # what, environment...
	what=$1
	shift
	bake "$@"
	status=$?
	case $status in
	0) cmp -s points.ply good.ply || grep -q coarser said || echo "$what: other light" ;;
	71) grep -q '^glowworm: ' said || echo "$what: not a word" ;;
	*) echo "$what: status $status" ;;
	esac
	[ "$(ls -A | grep -c part)" = 0 ] || { echo "$what: a file is left" && rm -f .*.part; }
}

bake FAULT_KIND=thread FAULT_AT=0 FAULT_REPORT="$PWD/threads" && mv points.ply good.ply
threads=$(sed -n 's/^calls //p' threads | head -n 1)
check 'no threads' FAULT_KIND=thread FAULT_AT=1 FAULT_ONWARDS=1
check 'few threads' FAULT_KIND=thread FAULT_AT=3 FAULT_ONWARDS=1
check 'no thread for the device' FAULT_KIND=thread FAULT_AT=9 FAULT_ONWARDS=1
check 'a thread of OpenVDB' FAULT_KIND=thread FAULT_AT="$((threads + 1))" FAULT_ONWARDS=1
cmp points.ply good.ply
sed -n 's/.*\(OpenVDB died\|the grids\).*/grids: 71/p' said
for owner in program library; do
	bake FAULT_KIND=alloc FAULT_AT=0 FAULT_OWNER=$owner FAULT_REPORT="$PWD/$owner"
	calls=$(sed -n 's/^calls //p' $owner | head -n 1)
	for part in 1 2 3 4; do
		check "$owner $part" FAULT_KIND=alloc FAULT_OWNER=$owner FAULT_ONWARDS=1 \
			FAULT_AT=$((calls * part / 5))
	done
done
(
	ulimit -v 200000
	glowworm bake box.ply --light 'sky radiance 1' -o points.ply --force
) 2>said
echo "little memory: $?"
