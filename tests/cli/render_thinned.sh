# Of a cloud that memory does not hold a picture is drawn of as many points as fit, and says so;
# pages, measures and plans likewise.
# Of 64 MB and 360 bytes a point 72 MB hold some 23,000.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 60000 -o cave.ply
draw() { glowworm render cave.ply --size 64x48 "$@" 2>&1; }
draw --memory 72M -o fewer.png |
	awk "/are drawn of 60000/ { print (\$3 > 21000 && \$3 < 23400) ? \"fewer\" : \$3 }"
draw --memory 72M -j 1 -q -o one.png
cmp fewer.png one.png
glowworm convert cave.ply cave.las
glowworm render cave.las --size 64x48 --memory 72M -o las.png 2>&1 | grep -c 'are drawn of 60000'
# Where all fit nothing is said of it.
draw --memory 1G -o all.png | grep 'are drawn'
# So are measures and pages: of a floor of 6 by 4 m that sends out 2 W/(sr m^2) everywhere. Each of
# its points stands for a square as wide as they are apart, which over the borders is a hundredth.
awk 'BEGIN { print "x y z nx ny nz radiance_r radiance_g radiance_b"
	for (i = 0; i < 60000; i++)
		printf "%.4f %.4f 0 0 0 1 2 2 2\n", (i % 300) * 0.02, int(i / 300) * 0.02 }' >floor.xyz
glowworm convert floor.xyz floor.ply
glowworm measure floor.ply --box=-1,-1,-1,7,5,1 --memory 72M 2>&1 |
	awk '/are measured of 60000/ { print ($3 > 15000 && $3 < 23400) ? "fewer" : $3 }
		/^radiance/ { print ($7 > 23.5 && $7 < 24.5) ? "their area" : $0 }
		/^mean/ { print }'
glowworm page floor.ply --memory 72M -o page.html 2>&1 | grep -c 'are looked at of 60000'
glowworm plan cave.ply --light 'sky radiance 1' --memory 145M 2>&1 |
	grep -c 'points make the surface of all 60000'
