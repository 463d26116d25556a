# A .cloud has room for places, normals and colours: what is left out is said, by convert and bake.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
awk 'BEGIN { print "x,y,z,nx,ny,nz,red,green,blue,intensity"
	for (i = 0; i < 100; i++) print i % 10 "," int(i / 10) ",0,0,0,1,90,90,90,7" }' >plane.csv
glowworm convert plane.csv plane.cloud
glowworm convert plane.csv quiet.cloud -q
glowworm convert plane.cloud again.cloud
glowworm bake plane.csv --light 'sky radiance 1' --estimate-points 0 -o lit.cloud 2>&1 |
	grep -o 'a .cloud has room.*'
