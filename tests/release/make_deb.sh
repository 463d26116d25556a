#!/usr/bin/env bash
# Makes Debian packages in a folder: program, library, headers and documents, and what apt needs of
# the sources. The tarball is unpacked there, gets its folder debian/, and is built by Debian's own
# tools, by any user and without a network; nothing is written elsewhere. What lintian says is a
# failure. DEB_BUILD_PROFILES=pkg.glowworm.nompi builds without Open MPI.
# shellcheck source=tests/release/release_words
. "$(dirname "$0")/release_words"
[ $# -eq 1 ] || { echo "usage: make_deb.sh FOLDER" >&2; exit 64; }
rm -rf "$1"
mkdir -p "$1"
folder=$(cd "$1" && pwd)
tarball=$("$root/tests/release/make_tarball.sh" "$folder")
name=$(basename "$tarball" .tar.gz)
tar -xf "$tarball" -C "$folder"
mv "$tarball" "$folder/${name/-/_}.orig.tar.gz"
"$folder/$name/tests/release/write_debian.sh" "$folder/$name"

cd "$folder/$name"
options=${DEB_BUILD_OPTIONS:-"parallel=$(nproc) noautodbgsym"}
if ! DEB_BUILD_OPTIONS=$options dpkg-buildpackage -us -uc >"$folder/log" 2>&1
then
	tail -n 40 "$folder/log" >&2
	echo "make_deb.sh: dpkg-buildpackage failed; $folder/log has all that it said" >&2
	exit 1
fi
cd "$folder"
lintian --no-cfg --allow-root --fail-on error,warning ./*.changes >lintian 2>&1 || {
	cat lintian >&2
	echo "make_deb.sh: lintian complains" >&2
	exit 1
}
cat lintian
ls -s --block-size=K ./*.deb | sed "s|\\./|$folder/|"
