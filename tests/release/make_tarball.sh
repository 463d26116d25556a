#!/usr/bin/env bash
# Writes glowworm-VERSION.tar.gz into a folder and prints its name: what is committed or, in a tree
# that a tarball was unpacked to, what lies there. Names are sorted, owners and modes fixed, all
# times that of the commit, so that the same commit gives the same bytes, from a tarball as well.
# shellcheck source=tests/release/release_words
. "$(dirname "$0")/release_words"
[ $# -eq 1 ] || { echo "usage: make_tarball.sh FOLDER" >&2; exit 64; }
mkdir -p "$1"
folder=$(cd "$1" && pwd)
cd "$root"
scratch=$(mktemp -d "$folder/tree.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
if is_clone "$root"; then
	[ -z "$(git status --porcelain)" ] ||
		echo "make_tarball.sh: what is not committed is not in it (git status)" >&2
	git archive HEAD | tar -x -C "$scratch"
else
	tar -c --exclude=./build --exclude=./debian . | tar -x -C "$scratch"
fi
name=glowworm-$(version_of "$scratch")
tar -c --format=ustar --sort=name --owner=0 --group=0 --numeric-owner --mode=u+rw,go+r,a+X,go-w \
	--mtime="@$(time_of "$root")" --transform="flags=r;s|^\\.|$name|" -C "$scratch" . |
	gzip -n9 >"$scratch.gz"
mv "$scratch.gz" "$folder/$name.tar.gz"
echo "$folder/$name.tar.gz"
