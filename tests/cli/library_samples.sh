# The samples of the library, in C and in Python, through the shared one: a line a lighting, the
# same from both, and a mean that is 4 I / area = 0.7407 wherever the lamp is. It is off by no more
# than the root mean square of what the points are off, which the last line says, and half a digit.
# sanitize: no
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
relight_room >c.txt || exit
for python in python3 /usr/bin/python3; do
	"$python" -c 'import numpy' 2>/dev/null && break
done
GLOWWORM_LIBRARY=$(dirname "$GLOWWORM")/libglowworm.so "$python" "$SOURCE/samples/relight_room.py" \
	>python.txt || exit
cmp c.txt python.txt
awk '/^lamp at/ {
		lit++
		off = $7 - 40 / 54
		if (off * off > worst * worst) worst = off
	}
	/^estimated error/ { error = $(NF - 1) / 100 }
	END {
		print lit, "lightings"
		if (!(error > 0 && error < 0.02)) print "the error is", error
		if (worst * worst > (error * 40 / 54 + 0.0005) ^ 2) print "off by", worst
	}' c.txt
