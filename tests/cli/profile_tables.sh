# What --profile says in the terms of Salm's tables: rows that a run has nothing of show a dash, the
# shading is named by what is on, and a picture's final rendering is the sum of its two parts.
. "$SOURCE/tests/cli/shared_functions"
make_box --scene cornell --points 2000 -o box.ply
lamp='point at 0.5,0.4,0.7 intensity 1'
rows() { # says which rows of the bake's table have numbers
	awk '/^thesis/ { on = 1 } on && NF == 0 { exit }
		on && /^(static|dynamic|shadows)/ { print $1, ($2 == "-" ? "-" : "ms") }' said.txt
}
light() { # arguments...
	glowworm bake "$@" -q --estimate-points 0 --bounces 1 --profile 2>said.txt || cat said.txt
	rows
}
light box.ply --light "$lamp" -o lit.ply
light box.ply --light "$lamp" --shadows none -o open.ply
echo == stages, with what the device was asked for
glowworm bake box.ply -q --estimate-points 0 --passes device --profile -o device.ply 2>said.txt ||
	cat said.txt
# Milliseconds are rounded to 0.1, and so are megabytes, by up to 0.05 a stage.
awk '/^stage/ { on = 1; next } on && NF == 0 { exit }
	on && $1 != "net" { stages++; for (i = 0; i < 4; i++) sum[i] += $(NF - i) }
	on && $1 == "net" { for (i = 0; i < 4; i++) {
		apart = sum[i] - $(NF - i)
		room = i < 2 ? 0.05 * (stages + 1) + 0.001 : 0
		print ($(NF - i) > 0 ? "something" : "nothing"),
			(apart * apart > room * room ? "apart" : "adds up") } }' said.txt
echo == what three bounces more ask of the device: submissions, dispatches, bytes up and down
asked() { # bounces: says what their stage asked for
	glowworm bake box.ply -q -f --estimate-points 0 --passes device --bounces $1 \
		--report asked.json -o device.ply
	grep '"name": "bounces"' asked.json |
		grep -o '"\(dispatches\|submissions\|uploaded_bytes\|downloaded_bytes\)": [0-9]*' |
		grep -o '[0-9]*$'
}
# On a busy machine a run may seem so long that it is submitted by itself, but not all of them do.
echo $(asked 3) $(asked 6) | awk 'NF == 8 {
	print ($6 - $2 < ($5 - $1) / 2 ? "submissions are fewer" : $0), $7 - $3, $8 - $4 }'
echo == a lamp stands still while a cube moves
cat >moving.json <<-EOF
	{"version": 1, "frames": 2, "inputs": [{"file": "box.ply"}, {"file": "box.ply",
	 "path": [{"frame": 0, "scale": 0.1}, {"frame": 1, "scale": 0.1, "move": [0.1, 0, 0]}]}],
	 "lights": [{"type": "point", "position": [0.5, 0.4, 0.7], "intensity": [1, 1, 1]}]}
EOF
glowworm bake moving.json -q --frames all --estimate-points 0 --bounces 1 --profile -o moved.ply \
	2>both.txt || cat both.txt
awk '/^(static|dynamic)/ { print $1, ($2 == "-" ? "-" : "ms") }' both.txt

echo == pictures
camera='at 0.5,-1.6,0.5 to 0.5,0.5,0.5 fov 40'
for radiance in points trilinear tricubic; do
	glowworm render lit.ply -q -f -o p.png --size 64x48 --camera "$camera" --radiance $radiance \
		--profile 2>said.txt || cat said.txt
	# Each of the three numbers is rounded to 0.1, by up to 0.05.
	awk '/^thesis/ { on = 1 }
		on && /^(g-pass|ds|final)/ { print $1; sum += ($1 == "final" ? -$2 : $2) }
		on && /^G-buffer/ { print $1, $3 }
		END { if (sum > 0.151 || sum < -0.151) print "final is off by", sum, "ms" }' said.txt
done
# Pictures side by side: of all inputs.
one=$(glowworm render lit.ply -q -f -o p.png --size 64x48 --camera "$camera" --profile 2>&1)
glowworm render lit.ply lit.ply --row -q -f -o p.png --size 64x48 --camera "$camera" --profile \
	>said.txt 2>&1
{ echo "$one"; cat said.txt; } | awk '/^(points|in view) / { n[$1] = n[$1] " " $NF }
	/^(read|surface) / && !($2 > 0) { print $1 " took no time" }
	END { for (i in n) { split(n[i], of, " "); print of[2] / of[1] " times the", i } }' | sort
