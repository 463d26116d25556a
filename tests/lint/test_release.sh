#!/usr/bin/env bash
# A tarball has the same bytes whenever it is made, from a clone or from what it unpacks to, and
# owners and times that are nobody's; and all that has a version takes it from lib/glowworm.h: the
# program, the library, the manual, the change log, a Debian package. Looks at BUILD, build unless
# set.
build=$(realpath "${BUILD:-build}")
# shellcheck source=tests/release/release_words
. "$(dirname "$0")/../release/release_words"
set +e
scratch=$(mktemp -d "${TMPDIR:-/tmp}/glowworm-release.XXXXXX") || exit 70
trap 'rm -rf "$scratch"' EXIT
version=$(version_of "$root")
bad=0

complain() {
	echo "$*"
	bad=1
}

expect_version() { # what version
	[ "$2" = "$version" ] || complain "$1 is of version \"$2\", lib/glowworm.h of $version"
}

first=$("$root/tests/release/make_tarball.sh" "$scratch/first" 2>/dev/null)
mkdir "$scratch/tree"
tar -xf "$first" -C "$scratch/tree"
tree=$(echo "$scratch"/tree/*)
# Neither what was built nor when a file was touched, nor by whom, is in it.
mkdir -p "$tree/build" "$tree/debian"
touch "$tree/build/program" "$tree/README.md"
chmod -R g+w "$tree"
second=$(umask 077 && cd / && "$tree/tests/release/make_tarball.sh" "$scratch/second")
cmp "$first" "$second" || complain "the tarball is another one when it is made again"
if tar -tvf "$first" | awk '{ print $2 }' | sort -u | grep -vx 0/0; then
	complain "the tarball says who made it"
fi

if is_clone "$root"; then
	[ "$(git -C "$root" ls-files | wc -l)" -lt 100 ] && complain "git lists too few files"
	git -C "$root" archive HEAD | tar -t | grep -v '/$' | sort >"$scratch/committed"
	tar -tf "$first" | sed 's|^[^/]*/||' | grep -v -e '/$' -e '^$' | sort |
		diff "$scratch/committed" - || complain "the tarball lacks files"
fi

"$tree/tests/release/write_debian.sh" "$tree" || complain "debian/ cannot be written"
# A version that is not yet committed is not in the tarball either.
version=$(version_of "$tree")
expect_version "debian/changelog" \
	"$(sed -n '1s/^glowworm (\([0-9.]*\)-.*/\1/p' "$tree/debian/changelog")"
grep -q '^ libvulkan-dev,$' "$tree/debian/control" ||
	complain "debian/control lacks what .debian-packages lists"
! grep -H '@[A-Z_]*@' "$tree"/debian/* 2>/dev/null || complain "debian/ has gaps"
soname=libglowworm${version%.*}
[ -f "$tree/debian/$soname.install" ] && grep -qx "Package: $soname" "$tree/debian/control" ||
	complain ".debian names no package $soname, as Debian calls a library of this soname"

version=$(version_of "$root")
expect_version "CHANGELOG.md" "$(newest_change "$root" | cut -d , -f 1)"
expect_version "$build/glowworm" "$("$build/glowworm" --version | cut -d ' ' -f 2)"
[ ! -e "$build/libglowworm.so" ] || expect_version "$build/libglowworm.so" \
	"$(basename "$(realpath "$build/libglowworm.so")" | sed 's/.*\.so\.//')"
for page in "$build"/man/*.1; do
	[ ! -e "$page" ] || expect_version "$page" \
		"$(sed -n '1s/.*"glowworm \([0-9.]*\)".*/\1/p' "$page")"
done
exit $bad
