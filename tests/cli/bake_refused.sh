# What cannot be written is refused before the light is computed: points that a format has no room
# for, names that are too long, files that are too large. No stage but reading is begun.
make_cloud() { # x
	printf 'ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n'
	printf 'property double z\nend_header\n%s 0 0\n1 2 3\n' "$1"
}
make_cloud 500000.1234 >far.ply
make_cloud nan >nan.ply
make_cloud 0 >near.ply
run() { # status arguments...
	expected=$1
	shift
	out=$(glowworm bake "$@" --light 'sky radiance 1' --progress json 2>&1)
	status=$?
	[ $status -eq "$expected" ] || echo "status $status, expected $expected: $*"
	echo "$out" | grep -v -e '"read"' -e ' note: '
}
run 65 far.ply -o out.cloud
run 65 nan.ply -o out.las
long=$(printf '%0300d' 0)
run 73 near.ply -o "$long.ply" | sed 's/0000*/0/'
run 73 near.ply -o out.ply --report "$long" | sed 's/0000*/0/'
# Numbers are added to names.
long=$(printf '%0250d' 0)
printf '{"version": 1, "frames": 2, "inputs": [{"file": "near.ply"}]}\n' >frames.json
run 73 frames.json --frames all -o "$long.ply" | sed 's/0000*/0/'
glowworm render near.ply -o "$long.png" --orbit 2 2>&1 | sed 's/0000*/0/'
{ make_cloud 0 | sed 's/vertex 2/vertex 42/' && seq 1 40 | sed 's/$/ 0 0/'; } >many.ply
for format in ply las csv cloud; do
	(ulimit -S -f 1 && run 74 many.ply -o out.$format --threads 1) 2>&1 | cat
done
{ make_cloud 0 | sed 's/vertex 2/vertex 102/' && seq 1 100 | sed 's/$/ 0 0/'; } >more.ply
for option in '--vdb out.vdb' '--save-transport out.transport'; do
	(ulimit -S -f 1 && run 74 more.ply $option --threads 1) 2>&1 | cat
done
ls -A
