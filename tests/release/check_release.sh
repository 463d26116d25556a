#!/usr/bin/env bash
# What a release has to have, a line for each: `ok`, or `missing` and below it what is. Works in a
# folder that it empties; takes the release build in build/ for granted, and from `make test` that
# it has passed. The exit status is 1 when anything is missing.
# shellcheck source=tests/release/release_words
. "$(dirname "$0")/release_words"
set +e
[ $# -eq 1 ] || { echo "usage: check_release.sh FOLDER" >&2; exit 64; }
rm -rf "$1"
mkdir -p "$1"
folder=$(cd "$1" && pwd)
cd "$root" || exit 70
version=$(version_of "$root")
unpacked=$folder/unpacked
libraries=/usr/lib/$(dpkg-architecture -q DEB_HOST_MULTIARCH)
missing=0

# What an item says is what is missing; without a word, and with status 0, all of it is there.
check() { # item command...
	local said status
	said=$("${@:2}" 2>&1)
	status=$?
	if [ $status -eq 0 ] && [ -z "$said" ]; then
		echo "ok       $1"
	else
		echo "missing  $1"
		head -n 20 <<<"${said:-it ended with status $status}" | sed 's/^/         /'
		missing=$((missing + 1))
	fi
}

# ------------------------------------------------------------------------------------- the sources

committed() {
	[ -e .git ] || echo "this is no clone"
	git status --porcelain | sed 's/^/not committed: /'
}

dated() {
	[[ $(newest_change "$root") =~ ^$version,\ [0-9]{4}-[0-9]{2}-[0-9]{2}$ ]] ||
		echo "CHANGELOG.md begins with \"$(newest_change "$root")\", not \"$version, DAY\""
}

tested() {
	local passed
	passed=$(cat build/tests_passed 2>/dev/null)
	[ "$passed" = "$(git rev-parse HEAD 2>/dev/null)" ] ||
		echo "make test has passed ${passed:+for $passed, }not for what is committed; run it"
}

# Made from the clone, and once more from what it unpacks to.
same_tarball() {
	local tarball again
	tarball=$(tests/release/make_tarball.sh "$folder/first" 2>/dev/null) &&
		mkdir "$folder/tree" && tar -xf "$tarball" -C "$folder/tree" &&
		again=$("$folder"/tree/*/tests/release/make_tarball.sh "$folder/second") &&
		cmp "$tarball" "$again" && [ "$(basename "$tarball")" = "glowworm-$version.tar.gz" ]
}

# ------------------------------------------------------------------------------------ the packages

built() {
	tests/release/make_deb.sh "$folder/deb" >"$folder/log" 2>&1
	if compgen -G "$folder/deb/*.changes" >/dev/null; then return 0; fi
	tail -n 10 "$folder/log"
	return 1
}

lintian_silent() {
	if [ ! -f "$folder/deb/lintian" ]; then
		echo "it did not run"
	else
		grep '^[EWXP]:' "$folder/deb/lintian"
	fi
	return 0
}

# Unpacks all packages into one folder, and says where two have the same file.
alone() {
	local package
	mkdir "$unpacked"
	for package in "$folder"/deb/*.deb; do
		dpkg-deb -x "$package" "$unpacked" || return
		dpkg-deb -c "$package" | awk '!/\/$/ { print $6 }'
	done | sort | uniq -d
}

# What `make install` puts anywhere is in the packages. The samples lie among the documents, to
# which their folder is a link, and manual pages are compressed.
complete() {
	make -s install DESTDIR="$folder/root" PREFIX=/usr LIBDIR="$libraries" \
		ZSHDIR=/usr/share/zsh/vendor-completions >"$folder/log" 2>&1 || cat "$folder/log"
	(cd "$folder/root" && find . ! -type d) | while read -r file; do
		[ -e "$unpacked/$file" ] || [ -e "$unpacked/$file.gz" ] ||
			echo "no package has ${file#.}"
	done
}

# Each package has this version, and depends on what it is linked to, known by name.
described() {
	local package
	for package in "$folder"/deb/*.deb; do
		case $(dpkg-deb -f "$package" Version) in
		"$version"-*) ;;
		*) echo "$(basename "$package") is of version $(dpkg-deb -f "$package" Version)" ;;
		esac
	done
	for package in libvulkan1 libopenvdb libproj libpng; do
		dpkg-deb -f "$folder"/deb/glowworm_*.deb Depends | grep -q "$package" ||
			echo "glowworm does not depend on $package"
	done
	! dpkg-deb -f "$folder"/deb/glowworm_*.deb Depends | grep "openmpi"
}

same_versions() {
	local file
	for file in "$unpacked$libraries/libglowworm.so.$version" \
		"$unpacked/usr/share/man/man1/glowworm.1.gz"; do
		[ -f "$file" ] || echo "there is no ${file#"$unpacked"}"
	done
	zcat "$unpacked/usr/share/man/man1/glowworm.1.gz" | head -n 1 | grep -qF " $version\"" ||
		echo "glowworm(1) is of another version"
	zcat "$unpacked/usr/share/doc/glowworm/manual.txt.gz" | grep -qF "glowworm $version" ||
		echo "manual.txt is of another version"
	grep -qx "Version: $version" "$unpacked$libraries/pkgconfig/libglowworm.pc" ||
		echo "libglowworm.pc is of another version"
	[ "$(run_unpacked glowworm --version)" = "glowworm $version" ] ||
		echo "the program is of another version"
}

# --------------------------------------------------------------------------------- what is in them

run_unpacked() { # command...
	LD_LIBRARY_PATH=$unpacked$libraries PATH=$unpacked/usr/bin:$PATH "$@"
}

healthy() {
	run_unpacked glowworm doctor >"$folder/log" 2>&1
	local status=$?
	grep '^  BAD ' "$folder/log"
	return $status
}

# A small box, with grids, to show that the plugin is found.
bakes() {
	run_unpacked make_box --scene furnace --points 2000 -o "$folder/box.ply" &&
		run_unpacked glowworm bake "$folder/box.ply" --vdb "$folder/box.vdb" \
			-o "$folder/lit.ply" >"$folder/log" 2>&1 &&
		run_unpacked glowworm render "$folder/lit.ply" -o "$folder/lit.png" >>"$folder/log" 2>&1 ||
		cat "$folder/log"
	for file in box.vdb lit.ply lit.png; do
		[ -s "$folder/$file" ] || echo "$file was not written"
	done
}

# The sample of the library, by the headers and the library of the packages alone.
links() {
	local flags
	flags=$(PKG_CONFIG_LIBDIR=$unpacked$libraries/pkgconfig PKG_CONFIG_SYSROOT_DIR=$unpacked \
		PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1 \
		pkg-config --cflags --libs libglowworm) || return
	# shellcheck disable=SC2086
	gcc "$unpacked/usr/share/glowworm/samples/relight_room.c" $flags -lm -o "$folder/room" &&
		run_unpacked "$folder/room" >"$folder/log" 2>&1 || cat "$folder/log"
	run_unpacked ldd "$folder/room" | grep -qF "$unpacked$libraries/libglowworm.so" ||
		echo "it takes another library"
}

check "all is committed" committed
check "the change log begins with $version and its day" dated
check "make test has passed for this commit" tested
check "the tarball is the same when it is made again" same_tarball
check "the packages are built" built
check "lintian finds nothing" lintian_silent
check "no two packages have the same file" alone
check "what make install installs is in them" complete
check "they are of this version and depend on what they need" described
check "program, library, pkg-config and manual are of this version" same_versions
check "the program from its package is healthy: doctor" healthy
check "it bakes a small box and shows it" bakes
check "a program is built with the library from its packages" links
[ "$missing" -eq 0 ]
