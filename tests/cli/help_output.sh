# Help that was asked for goes to standard output with status 0; without arguments it is misuse.
glowworm --version
glowworm --help
for verb in bake plan info convert render doctor; do
	glowworm $verb --help >short.txt || echo "status $?"
	glowworm $verb --help all >help.txt || echo "status $?"
	head -n 3 help.txt
	# Every option that the completion knows is in the help, and the other way round.
	glowworm --generate fish | sed -n "s/.*subcommand_from $verb' -l \([a-z-]*\).*/\1/p" |
		sort >one
	options() { sed -n 's/^  [ -][ a-z][ ,] --\([a-z-]*\).*/\1/p' "$1" | sort; }
	options help.txt >other
	cmp one other && [ "$(wc -l <one)" -gt 4 ]
	# The short help has some of them, and all where there are few.
	options short.txt | comm -23 - other
	[ "$(options short.txt | wc -l)" -lt "$(wc -l <other)" ] && echo "$verb: some" ||
		echo "$verb: all"
done
# No line is wider than a terminal.
{
	glowworm --help
	glowworm --help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | while read -r verb; do
		glowworm "$verb" --help
		glowworm "$verb" --help all
	done
} | awk 'length($0) > 80 { print "too wide: " $0 }'
# Of help that there is not; of a command that it is asked for in the middle of.
for asked in 'bake --help al' 'bake -h lights' 'help bake al' '--help bak'; do
	glowworm $asked 2>&1 || echo "status $?"
done
for asked in '--help bake' 'bake --help cave.ply' 'bake -h --light sky'; do
	glowworm $asked | head -n 1
done
# Every verb has examples, which its own options are in.
glowworm --help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | while read -r verb; do
	glowworm "$verb" --help | sed -n '/^Examples/,/^$/p' | grep -o -- '--[a-z-]*' | sort -u >one
	glowworm "$verb" --help all | grep -o -- '--[a-z-]*' | sort -u | comm -23 one -
	glowworm "$verb" --help | grep -q "^  glowworm $verb" || echo "no example: $verb"
done
# How to write lights stands at the top of bake's; and each is one that it takes.
glowworm bake --help | sed -n '/^Lights/,/^$/p' | sed -n "s/^  --light '\([^']*\)'.*/\1/p" >lights
wc -l <lights
while read -r light; do
	glowworm bake none.ply --light "$light" -o lit.ply 2>&1 | grep -v 'none.ply' || :
done <lights
# Formats that can be read, and those that can be written.
glowworm convert --help | grep -oE -- '--(output-)?format [a-z0-9|]*'
glowworm render --help >help.txt
glowworm help render | cmp - help.txt
glowworm render --help all >help.txt
glowworm help render all | cmp - help.txt
glowworm help render more 2>&1 || echo "status $?"
glowworm help | head -n 1
glowworm bake --help >/dev/full
echo "full disk: $?"
glowworm
echo "no arguments: $?"
# Who reads the beginning alone is told nothing more.
mkfifo pipe
exec 3<>pipe 4>pipe 3<&-
glowworm bake --help >&4
echo "nobody reads: $?"
