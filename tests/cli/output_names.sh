# No output is an input, whatever that is read for, and no two outputs are one file: by name, link
# and symbolic link, with --force too, before any work. What was there stays as it was.
base='ply\nformat ascii 1.0\nelement vertex 1\n'
base="$base"'property float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n'
# shellcheck disable=SC2059
printf "$base" | tee cloud.ply >other.ply
printf 'mtllib a.mtl b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n' >mesh.obj
printf 'newmtl a\nKd 1 1 1\n' | tee a.mtl >b.mtl
printf '{"version": 1, "inputs": [{"file": "cloud.ply"}, {"file": "mesh.obj"}],\n' >scene.json
printf '"lights": [{"type": "environment", "map": "sky.hdr"}]}\n' >>scene.json
printf '{"version": 1, "inputs": [{"file": "mesh.obj"}]}\n' >mesh.json
printf '{"version": 1, "frames": 2, "inputs": [{"file": "frame-0001.ply"}]}\n' >frames.json
echo 'at 0,0,0 to 1,0,0' >cameras.txt
cp cloud.ply frame-0001.ply
cp cloud.ply view-0002.png
echo sky >sky.hdr
echo transport >kept.gwt
ln cloud.ply link.ply
ln -s cloud.ply pointer.ply
ln -s . here
for name in scene.json mesh.json mesh.obj a.mtl cameras.txt; do ln -s "$name" "$name.png"; done
state() { ls -A && cksum -- *.*; }
before=$(state)
refuse() { # arguments...
	glowworm "$@" --force 2>&1 </dev/null
	status=$?
	[ $status -eq 2 ] || echo "status $status: $*"
}
lamp='sky radiance 1'
echo == the scene file
refuse bake scene.json -o out.ply --report scene.json
refuse bake scene.json -o scene.json --output-format ply
refuse tradeoff scene.json --csv scene.json
refuse render scene.json -o scene.json.png
echo == inputs of a scene
refuse bake scene.json -o cloud.ply
refuse bake scene.json -o link.ply
refuse bake scene.json -o pointer.ply
refuse bake scene.json -o here/cloud.ply
refuse bake scene.json -o out.ply --report sky.hdr
refuse bake scene.json -o out.ply --report a.mtl
refuse bake scene.json -o out.ply --vdb b.mtl
refuse bake scene.json -o out.ply --save-transport mesh.obj
refuse bake frames.json --frames all --light "$lamp" -o frame.ply
echo == other roles
refuse bake cloud.ply --light "$lamp" --transport kept.gwt -o out.ply --report kept.gwt
refuse sample mesh.obj -o b.mtl --output-format ply
refuse compare cloud.ply other.ply --json other.ply
refuse compare cloud.ply other.ply --worst link.ply
refuse mix cloud.ply --gain a=2 -o pointer.ply
refuse convert cloud.ply here/link.ply
refuse render view-0002.png --orbit 3 -o view.png
refuse render cloud.ply --mesh mesh.json -o mesh.json.png
refuse render cloud.ply --mesh mesh.json -o mesh.obj.png
refuse render cloud.ply --mesh mesh.json -o a.mtl.png
refuse render cloud.ply --path cameras.txt -o cameras.txt.png
echo == two outputs
refuse bake cloud.ply --light "$lamp" -o new.ply --report new.ply
refuse bake cloud.ply --light "$lamp" -o new.ply --report ./new.ply
refuse bake cloud.ply --light "$lamp" -o new.ply --vdb here/new.ply
refuse bake cloud.ply --light "$lamp" -o sky.hdr --output-format ply --report here/sky.hdr
refuse bake frames.json --frames all --light "$lamp" -o new.ply --report here/new-0001.ply
refuse compare cloud.ply other.ply --worst new.ply --json here/new.ply
refuse tradeoff cloud.ply --light "$lamp" --csv new --svg ./new
echo == streams
glowworm convert - cloud.ply --force <cloud.ply 2>&1
glowworm convert cloud.ply - 2>&1 >>cloud.ply
[ "$before" = "$(state)" ] || { echo "$before" && state; }
# Devices hold nothing: two outputs may go there, and one that is read.
glowworm compare cloud.ply cloud.ply --worst /dev/null --json /dev/null >/dev/null 2>&1
[ $? -eq 65 ] || echo 'devices are not files'
