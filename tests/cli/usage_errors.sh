# Misuse ends with status 2, one sentence, the legal values, and the name that was probably meant.
run() {
	glowworm "$@" 2>&1 >/dev/null
	[ $? -eq 2 ] || echo "status was not 2: $*"
}
lamp='sky radiance 1'
run bak a.ply
run --verison
run bake a.ply --ligth "$lamp"
run bake a.ply -z
run bake a.ply --method cone
run bake a.ply --shadows
run bake a.ply --rays 5000
run bake a.ply --rays 2.5
run bake a.ply --tolerance 0
run bake a.ply --bounces many
run bake a.ply --seed -1
run bake a.ply --memory 12X
run bake a.ply --albedo constant:2
run bake a.ply --albedo colour
run bake a.ply --fields direct,rio
run bake a.ply --force=yes
run bake a.ply --exposure nan
run bake
run bake a.ply
run bake a.ply -o a.obj
run bake - - -o out.ply
cat /dev/null | run bake - /dev/stdin -o out.ply
cat /dev/null | run tradeoff - /dev/stdin --light "$lamp"
run bake a.ply -o - --report -
run bake a.ply -o out.ply --vdb-half
echo "{\"version\": 1}" | tee a.json >b.json
run bake a.json b.json -o out.ply
run info
run info --devices a.ply
run info --format stl a.ply
run --generate nothing
run info --stats --places a.ply
run bake a.ply --light "$lamp" --ao-distance 2 -o out.ply
run measure a.ply --reach 2
run page a.ply -o a.png
