# One table of points through every format: the same numbers come back, in the same order.
printf '%s\n' '# surveyed by hand' '# x y z nx ny nz red green blue depth' \
	'500000.1234567 4000000.1 0.1 0 0 1 255 0 7 -12' \
	'-0.3 1e-300 12345678.90123456 0.6 0.8 0 1 2 3 70000' \
	'nan 3 4 0 -1 0 4 5 6 0' >a.xyz
for way in 'ply' 'pcd' 'csv' 'xyz' 'csv pcd ply xyz'; do
	last=a.xyz
	for format in $way; do
		glowworm convert "$last" "to.$format" --force || echo "to $format failed"
		cp "to.$format" last
		last=last
	done
	glowworm convert last - --output-format xyz | grep -v '^#' >back.xyz
	cut -d ' ' -f 1-10 back.xyz >numbers
	tail -n +3 a.xyz | cmp - numbers || echo "changed on the way $way"
done
# In a pipe, by name of the format, by names of the columns.
glowworm convert a.xyz - | glowworm convert - - --format ply --output-format csv | head -n 2
printf '1 7 3 2\n' | glowworm convert - - --columns z,-,x,y --output-format csv
printf '9\n1 2 3\n' | glowworm convert - out.ply
echo "status $?"
glowworm convert a.xyz to.csv
echo "status $?"
glowworm convert a.xyz a.xyz --force
echo "status $?"
glowworm convert a.xyz -q -o named.csv && cmp to.csv named.csv
glowworm convert a.xyz b.csv -o c.csv
echo "status $?"
glowworm convert a.xyz -o a.xyz --force
echo "status $?"
glowworm convert a.xyz out.obj
echo "status $?"
glowworm convert a.xyz
echo "status $?"
glowworm convert missing.pcd out.ply
echo "status $?"
glowworm convert a.xyz /dev/full --output-format csv
echo "status $?"
ls
# Where scanners stood goes along, by comments where the format has no place for it; not 65 of them.
ptx() { awk -v n="$1" 'BEGIN { for (i = 1; i <= n; i++) {
	print "1\n1\n" i " 0.5 2\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n" i " 0.5 2 1"
	print "1 " i " 0.25 0.5" } }'; }
ptx 2 >two.ptx
for to in ply las copc.laz e57 pcd xyz; do
	glowworm convert two.ptx "two.$to" --force
	glowworm convert "two.$to" next.ply --force
	for file in "two.$to" next.ply; do
		glowworm info "$file" | grep -A 1 scanner |
			awk '{ printf "%s %s %s ", $(NF - 2), $(NF - 1), $NF }'
	done
	echo "$to"
done
ptx 65 >many.ptx
glowworm convert many.ptx many.ply
glowworm convert many.ptx many.e57
# So does which axis is up, but no note on the file that was read: a picture of a depth camera.
{ printf '%s\n' 'VERSION .7' 'FIELDS x y z' 'SIZE 4 4 4' 'TYPE F F F' 'COUNT 1 1 1' 'WIDTH 40' \
	'HEIGHT 30' 'VIEWPOINT 0 0 0 1 0 0 0' 'POINTS 1200' 'DATA ascii'
awk 'BEGIN { for (j = 0; j < 30; j++) for (i = 0; i < 40; i++) {
	z = 2 + 0.1 * sin(i * j); print z * (i - 19.5) / 30, z * (j - 14.5) / 30, z } }'; } >eye.pcd
for to in ply las e57 xyz; do
	glowworm convert eye.pcd "eye.$to" -q
	glowworm info "eye.$to" | grep -e format -e note -e scanner
done
glowworm convert a.xyz a.e57
