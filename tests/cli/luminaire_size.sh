# A luminaire that is as large as its file says: what is printed of it, read again, its soft shadow,
# and sizes that do not go together.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
write_lamp() { # width, length
	printf 'IES:LM-63-2019\n[MANUFAC] none\nTILT=NONE\n1 1000 1 91 1 1 2 %s %s 0\n1 1 10\n' "$@"
	seq -s ' ' 0 90
	echo 0
	awk 'BEGIN { for (v = 0; v <= 90; v++) print 100 * cos(v * atan2(0, -1) / 180) }'
}
write_lamp 0.6 1.2 >panel.ies
write_lamp -0.4 -0.4 >round.ies
write_lamp 0 0 >point.ies
glowworm lamp panel.ies | tail -n 2
glowworm lamp round.ies | tail -n 1
{
	echo x y z nx ny nz
	awk 'BEGIN {
		for (i = 0; i < 6400; i++)
			print (i % 80 - 39.5) / 20, (int(i / 80) - 39.5) / 20, 0, 0, 0, 1
		for (i = 0; i < 3600; i++)
			print (i % 60 - 59.5) / 30, (int(i / 60) - 29.5) / 15, 1, 0, 0, 1
	}'
} >floor.xyz
print_lights() {
	glowworm bake floor.xyz "$@" --albedo constant:0.5 --print-scene -o lit.ply 2>&1 |
		grep -e '"type"' -e '^glowworm: [^n]'
}
print_lights --light 'rectangle at 0,0,2 ies panel.ies' --light 'disc at 0,0,2 ies round.ies' \
	--light 'disc at 0,0,2 to 1,0,0 ies point.ies radius 0.3 roll 90' \
	--light 'rectangle at 0,0,2 ies panel.ies lumens 314.1512892 size 2,1'
for light in 'disc at 0,0,2 ies panel.ies' 'rectangle at 0,0,2 ies round.ies' \
	'disc at 0,0,2 ies point.ies' 'disc at 0,0,2 radius 1 lumens 3 scale 2' \
	'disc at 0,0,2 radius 1 lumens 3 roll 2' 'rectangle at 0,0,2 ies panel.ies radiance 3' \
	'disc at 0,0,2 ies round.ies radius 0'; do
	print_lights --light "$light"
done
# Half of a plate halfway hides: the edge of the shadow is as wide as the panel, and half of its
# light is there in the middle, where a point's shadow ends.
glowworm bake floor.xyz --light 'rectangle at 0,0,2 ies panel.ies' -q -b 1 --albedo constant:0.5 \
	--fields illuminance -o lit.ply
lux() { # from x, to x
	glowworm measure lit.ply --box "$1,-0.5,-0.1,$2,0.5,0.1" --json |
		sed -n 's/.*"mean": \(.*\),/\1/p'
}
echo "$(lux -0.5 -0.4) $(lux -0.1 0.1) $(lux 0.4 0.5)" |
	awk '{ print ($1 / $3 < 0.01), ($2 / $3 > 0.4 && $2 / $3 < 0.7) }'
