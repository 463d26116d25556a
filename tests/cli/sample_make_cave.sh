# The cave generator: exact counts, the same bytes every time, both formats, errors in words.
set -eu
make_cave --points 3000 -o a.ply
make_cave --points 3000 >b.ply
cmp a.ply b.ply
make_cave --points 3000 --seed 2 -o c.ply
if cmp -s a.ply c.ply; then echo "the seed does nothing"; fi
grep -a -c '^element vertex 3000$' a.ply

# A record is 24 bytes of position and normal, 3 of colour, 12 of emission.
header=$(sed '/^end_header$/q' a.ply | wc -c)
echo $(($(wc -c <a.ply) - header - 3000 * 39))

# .cloud: a count and 27 bytes a point; its y is the PLY's z, its z the PLY's -y.
make_cave --points 3000 --format cloud -o a.cloud
wc -c <a.cloud
ply=$(od -A n -t f4 -w12 -N 12 -j "$header" a.ply)
cloud=$(od -A n -t f4 -w12 -N 12 -j 4 a.cloud)
echo "$ply $cloud" | awk '{ print ($4 == $1 && $5 == $3 && $6 == -$2) ? "turned" : $0 }'

# Every seed keeps the stations in the air; the program itself checks that.
for seed in 1 2 3 4 5 6 7 8 9; do make_cave --seed $seed --stations | wc -l; done | sort -u

make_cave --points 0 || echo $?
make_cave --format xyz || echo $?
make_cave -o missing/cave.ply --points 10 || echo $?
make_cave -o /dev/full --points 5000 || echo $?
