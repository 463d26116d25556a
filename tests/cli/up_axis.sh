# Which axis is up decides which way bare points of open ground face: --up reaches their normals,
# from a scene file too.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# Ground with two hollows along y; y up makes hollows of them, y down makes hills.
awk 'BEGIN {
	print "x y z"
	for (i = 0; i < 2500; i++) {
		x = i % 50 * 0.14; z = int(i / 50) * 0.14
		print x, -0.8 * exp(-(x - 2) ^ 2 - (z - 4) ^ 2) - 0.5 * exp(-(x - 5) ^ 2 - (z - 3) ^ 2), z
	}
}' >ground.xyz
facing() { # arguments of bake
	glowworm bake "$@" -q --light 'sky radiance 1' --albedo constant:0.5 --estimate-points 0 \
		-o lit.ply --force
	glowworm convert lit.ply - --output-format csv | awk -F , '
		NR == 1 { for (i = 1; i <= NF; i++) if ($i == "ny") c = i }
		NR > 1 { if ($c > 0) up++; else down++ }
		END { printf "%d face along y, %d against it\n", up, down }'
}
facing ground.xyz --up y
facing ground.xyz --up -y
echo '{"version": 1, "inputs": [{"file": "ground.xyz"}], "bake": {"up": "y"}}' >ground.json
facing ground.json
facing ground.json --up -y
