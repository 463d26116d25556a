# Gloss and motion, forced and forbidden: by how much that changes the light, and where it is
# refused.
# exit: 2
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
{
	printf 'ply\nformat ascii 1.0\nelement vertex 441\nproperty float x\nproperty float y\n'
	printf 'property float z\nproperty float nx\nproperty float ny\nproperty float nz\n'
	printf 'property float specular\nproperty float roughness\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 441; i++)
		print i % 21 * 0.1 - 1, int(i / 21) * 0.1 - 1, 0, 0, 0, 1, 0.04, 0.5 }'
} >floor.ply
options='-q --force --bounces 1 --albedo constant:0.5'
# Radiance of the point in the middle.
middle() {
	glowworm convert "$1" - --output-format csv | awk -F, 'NR == 1 { for (i = 1; i <= NF; i++)
		if ($i == "scalar_radiance_g") of = i } NR > 1 && $1 * $1 + $2 * $2 < 1e-6 { print $of }'
}
ratio() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.4f\n", a / b }'; }

echo "-- gloss"
# By Schlick's term a gloss of 0.04 reflects 0.04 + 0.96 / 21 of even light, and leaves the rest to
# the albedo: 1.0857 times as much comes back as without it.
sun='sun from 0,90 irradiance 1'
glowworm bake floor.ply --light "$sun" $options -o glossy.ply
glowworm bake floor.ply --light "$sun" $options --effects=-gloss -o matt.ply
ratio "$(middle glossy.ply)" "$(middle matt.ply)"
glowworm info glossy.ply | grep -c 'specular\|roughness'
glowworm info matt.ply | grep -c 'specular\|roughness'
glowworm plan floor.ply --light "$sun" --effects=-gloss |
	tr -s ' ' | grep '^gloss'
# A picture of the first, with its gloss, and without.
shown() {
	glowworm render glossy.ply --size 64x48 --force -v -o o.png "$@" >said.txt 2>&1 ||
		echo "no picture by $*"
	grep '^glossy' said.txt
}
shown | grep -c 'glossy *[1-9]'
shown --effects=-gloss
shown --glossy off

# Forced where no point is glossy, or nothing moves, both leave all bytes as they are.
. "$SOURCE/tests/cli/shared_functions"
same() { [ "$(body "$1")" = "$(body "$2")" ] && echo "same: $3"; }
awk '/property float (specular|roughness)/ { next } NF == 8 { NF = 6 } { print }' floor.ply \
	>dull.ply
glowworm bake dull.ply --light "$sun" $options -o plain.ply
glowworm bake dull.ply --light "$sun" $options --effects=+gloss -o forced.ply
same plain.ply forced.ply gloss
for effects in auto +gloss; do
	glowworm render plain.ply --size 64x48 --force -o "$effects.png" --effects="$effects" -q
done
pixels() { # What follows the texts, of which one is the command.
	at=$(LC_ALL=C grep -abo IDAT "$1" | head -n 1 | cut -d : -f 1)
	tail -c "+$at" "$1" | cksum
}
[ "$(pixels auto.png)" = "$(pixels ./+gloss.png)" ] && echo "same: picture"

echo "-- motion"
# A lamp rises from 1 m to 2 m: a quarter of the light.
cat >rise.scene.json <<'END'
{"version": 1, "inputs": [{"file": "floor.ply"}], "frames": 2,
 "lights": [{"type": "point", "position": [0, 0, 1], "intensity": 1,
             "path": [{"frame": 0, "position": [0, 0, 1]},
                      {"frame": 1, "position": [0, 0, 2]}]}]}
END
for effects in auto +motion -motion; do
	glowworm bake rise.scene.json --frames all $options --effects="$effects" -o "$effects.ply"
	echo "$effects $(ratio "$(middle "./$effects-0000.ply")" "$(middle "./$effects-0001.ply")")"
done
glowworm plan rise.scene.json | tr -s ' ' | grep '^motion'
glowworm plan rise.scene.json --effects=-motion | tr -s ' ' | grep '^motion'
cat >still.scene.json <<'END'
{"version": 1, "inputs": [{"file": "floor.ply"}], "frames": 2,
 "lights": [{"type": "point", "position": [0, 0, 1], "intensity": 1}]}
END
for effects in auto +motion; do
	glowworm bake still.scene.json --frames all $options --effects="$effects" -o "still$effects.ply"
done
same stillauto-0001.ply still+motion-0001.ply motion
same stillauto-0000.ply stillauto-0001.ply "frames in which nothing moves"
echo "-- refused"
glowworm bake floor.ply --light "$sun" --effects +motion -o lit.ply 2>&1
glowworm render glossy.ply --effects +shadows -o out.png 2>&1
glowworm render glossy.ply --effects +gloss --glossy off -o out.png 2>&1
