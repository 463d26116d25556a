# Several processes share a bake by parts under mpirun: the same bytes by any number; where one of
# them dies the others end, and a later run goes on.
# sanitize: no
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
command -v mpirun >/dev/null || { echo "there is no mpirun (openmpi-bin)"; exit 77; }
[ -e "$(dirname "$GLOWWORM")/libglowworm-mpi.so" ] ||
	{ echo "built without Open MPI (libopenmpi-dev)"; exit 77; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 TMPDIR=$PWD
make_cave --points 150000 -o cave.ply
# Each process leaves its number in a file before it becomes glowworm.
start() ( # processes options...
	count=$1
	shift
	# shellcheck disable=SC2016 # for the shells that mpirun starts
	exec mpirun --oversubscribe --bind-to none -n "$count" \
		sh -c 'echo $$ >"process.$OMPI_COMM_WORLD_RANK" && exec glowworm "$@"' sh \
		bake cave.ply -j 1 --strays keep --effects lamps \
		--light 'point at 3.4,0,1.9 intensity 40' "$@"
)
start 1 -q --memory 150M -o one.ply
start 3 --memory 150M --report lit.json -o three.ply 2>&1 | cut -d ' ' -f 2,4-8
grep -o '^ "points": [0-9]*' lit.json
cmp three.ply one.ply
# The second of two is killed.
start 2 --memory 150M --resume -o lit.ply 2>said.txt &
until [ -s lit.ply.resume ]; do sleep 0.01; done
kill -9 "$(cat process.1)"
wait $! || ls lit.ply*
sed -n 's/.*noticed that process \(rank .\) .*\(exited .*\)/\1 \2/p' said.txt
grep -h kept said.txt
start 1 -q --memory 150M --resume -o lit.ply
cmp lit.ply one.ply
# What several cannot share.
start 2 -q -o all.ply 2>&1 | grep ^glowworm
start 2 -q --memory 150M -o lit.ply 2>&1 | grep ^glowworm
ls ./*.ply*
