# A matrix in a scene file moves and turns points, and turns normals, which keep their length; a
# point light straight above then gives I / h^2 * albedo / pi.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
{
	printf 'ply\nformat ascii 1.0\nelement vertex 25\n'
	printf 'property float %s\n' x y z nx ny nz
	echo end_header
	# A wall at y = 0 that faces -y.
	awk 'BEGIN { for (i = 0; i < 25; i++) print i % 5 * 0.1, 0, int(i / 5) * 0.1, 0, -1, 0 }'
} >a.ply
# Turned about x and scaled by 2, the wall is a floor at z = 5 that faces up: z' = -2 y + 5.
cat >scene.json <<'EOF'
{"version": 1,
 "inputs": [{"file": "a.ply", "albedo": 0.5, "matrix": [2,0,0,0, 0,0,2,0, 0,-2,0,5, 0,0,0,1]}],
 "lights": [{"type": "point", "position": [0.4, 0.4, 7], "intensity": 40}],
 "bake": {"bounces": 1}}
EOF
glowworm bake scene.json -q -o lit.ply
glowworm info lit.ply --json | tr '{' '\n' |
	sed -n 's/^"name": "\([xyzn]*\)".*"minimum": \(.*\), "not.*/\1 \2/p'
# 40 / 2^2 * 0.5 / pi = 1.5915 below the light; float32 and the albedo's path round to 1e-5.
glowworm info lit.ply --json | tr '{' '\n' |
	sed -n 's/.*radiance_r.*"maximum": \([0-9.]*\).*/\1/p' |
	awk '{ print ($1 > 1.5915 && $1 < 1.5916) ? "as the closed form" : $1 }'
