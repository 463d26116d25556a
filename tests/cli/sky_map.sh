# A map of the sky: as light text and in a scene file, whose folder its path counts from; turned;
# odd pixels are counted; and what is no map is refused.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# A floor that is open to the sky.
{
	printf 'ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\n'
	printf 'property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 400; i++) print i % 20 * 0.1, int(i / 20) * 0.1, 0, 0, 0, 1 }'
} >floor.ply
# 8 x 4 flat pixels: 1 of everything, which are 128 of 256 times 2^1, so that a pixel reads as
# 128.5 / 128.
mkdir folder
{
	printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n'
	for i in 1 2 3 4 5 6 7 8; do
		printf '\200\200\200\201\200\200\200\201\200\200\200\201\200\200\200\201'
	done
} >folder/even.hdr
middle() { # mean radiance of the file: albedo / pi * E is half of the sky's radiance
	glowworm convert "$1" - --output-format csv | awk -F , '
		NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /radiance_g$/) c = i }
		NR > 1 { sum += $c; n++ }
		END { # sampled: within a few percent
			printf "%.1f of the sky\n", sum / n / (128.5 / 128)
		}'
}
light_floor() {
	glowworm bake floor.ply -q --albedo constant:0.5 --light-samples 512 -o lit.ply --force "$@"
}
light_floor --light 'sky map folder/even.hdr'
middle lit.ply
light_floor --light 'sky map folder/even.hdr radiance 3 rotation -90' --method cones
middle lit.ply
cat >folder/sky.json <<'END'
{"version": 1, "inputs": [{"file": "../floor.ply"}],
 "bake": {"albedo": "constant:0.5", "light_samples": 512},
 "lights": [{"type": "environment", "map": "even.hdr", "rotation": 45, "radiance": 2}]}
END
glowworm bake folder/sky.json -q -o lit.ply --force
middle lit.ply
glowworm bake folder/sky.json --print-scene -o lit.ply | grep environment
for light in 'sky map none.hdr' 'sky map floor.ply' 'sky rotation 3' 'sky radiance 1 rotation 3' \
	'sky map' 'sun toward 0,0,-1 irradiance 1 map a.hdr'; do
	glowworm bake floor.ply -q --light "$light" -o no.ply 2>&1
	echo "$?"
done
glowworm bake floor.ply -q --light 'sky map folder/even.hdr' --light 'sky map folder/even.hdr' \
	-o no.ply 2>&1 || echo "$?"
