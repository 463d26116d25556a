# Nothing that a file or its name holds is obeyed by a terminal: control characters are shown.
name=$(printf 'a\033[31m\nb\302\233c\233\177.ply')
printf 'ply\nformat ascii 1.0\ncomment glowworm note: \033]0;title\007\nelement vertex 1\n' >"$name"
printf 'property float x\nproperty float y\nproperty float z\nproperty float s\033c\n' >>"$name"
printf 'end_header\n0 0 0 0\n' >>"$name"
glowworm info "$name" 2>&1 | sed -n '1p; / s\\/p'
glowworm info "missing $name" 2>&1
glowworm bake "$name" -o out.ply 2>&1
glowworm bake "$name" -o "$name" --force --light 'sky radiance 1' 2>&1
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib \033[2J.mtl\nf 1 2 3\n' >"$name.obj"
glowworm sample "$name.obj" -o out.ply -v 2>&1
# Letters of other alphabets stay.
glowworm info "$(printf 'h\303\266hle.ply')" 2>&1
true
