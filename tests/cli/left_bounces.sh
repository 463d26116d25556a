# Where bounces are no more than so many, and what is left out is most of the error, more of them
# are the remedy: no --max-error is named, which no finer settings would reach.
make_box --scene cornell --points 4000 -o box.ply
for bounces in 2 auto; do
	glowworm bake box.ply -q --quality draft --estimate-points 100 --albedo constant:0.9 \
		--bounces $bounces --report $bounces.json -o $bounces.ply
	glowworm bake box.ply -f --quality draft --estimate-points 100 --albedo constant:0.9 \
		--bounces $bounces -o $bounces.ply 2>&1 |
		grep -o -e 'part of that is light of bounces.*bring' -e 'max-error' ||
		echo "$bounces: nothing said"
	grep -A 2 '"price"' $bounces.json | grep -c '"error": 0,'
done
