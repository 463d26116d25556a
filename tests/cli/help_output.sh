# Help that was asked for goes to standard output with status 0; without arguments it is misuse.
glowworm --version
glowworm --help
for verb in bake plan info convert render doctor; do
	glowworm $verb --help >help.txt || echo "status $?"
	head -n 3 help.txt
	awk 'length($0) > 90 { print "too wide: " $0 }' help.txt
	# Every option that the completion knows is in the help, and the other way round.
	glowworm --generate fish | sed -n "s/.*subcommand_from $verb' -l \([a-z-]*\).*/\1/p" | sort >one
	sed -n 's/^  [ -][ a-z][ ,] --\([a-z-]*\).*/\1/p' help.txt | sort >other
	cmp one other && [ "$(wc -l <one)" -gt 4 ]
done
glowworm render --help >help.txt
glowworm help render | cmp - help.txt
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
