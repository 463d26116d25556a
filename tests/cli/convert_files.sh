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
