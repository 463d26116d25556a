# The ways in which light is gathered: every --method that there is, and as JSON.
glowworm methods >methods.txt
choices=$(glowworm bake --help all | sed -n 's/.*--method \([a-z|]*\).*/\1/p' | head -1)
for method in $(echo "$choices" | tr '|' ' '); do
	grep -qx "$method" methods.txt || echo "methods says nothing of $method"
done
cat methods.txt
glowworm methods --json | sed -n '/"name"/s/^ *//p'
glowworm methods cloud.ply || echo "status $?"
