#!/usr/bin/env bash
# Writes the folder debian/ of an unpacked tarball: what .debian/ holds and what is said elsewhere
# already, the version, the packages to build with, who maintains it (DEBFULLNAME and DEBEMAIL, as
# Debian's own tools take them).
# shellcheck source=tests/release/release_words
. "$(dirname "$0")/release_words"
[ $# -eq 1 ] || { echo "usage: write_debian.sh TREE" >&2; exit 64; }
tree=$1
maintainer="${DEBFULLNAME:-the glowworm authors}"
maintainer+=" <${DEBEMAIL:-glowworm@users.noreply.github.com}>"

# The first section of .debian-packages but what every build in Debian has.
build_depends() {
	sed -n '/^# building$/,/^$/p' "$tree/.debian-packages" | sed 's/[ \t]*#.*//; /^$/d' |
		grep -vxE 'gcc|g\+\+|make|binutils' |
		sed -e 's/^libopenmpi-dev$/& <!pkg.glowworm.nompi>/' -e 's/^/ /; s/$/,/'
}

# The day of the release; before there is one, that of the commit.
day=$(newest_change "$tree" | sed -n 's/.*, \([0-9-]*\)$/\1/p')
version=$(version_of "$tree")
release=$(sed -n 's/^VERSION_ID="\(.*\)"/\1/p' /etc/os-release)
name=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
rm -rf "$tree/debian"
cp -R "$tree/.debian" "$tree/debian"
rm "$tree/debian/README.md" "$tree/debian/control.in"
# A package of our own sorts before what Debian may have of the same version.
cat >"$tree/debian/changelog" <<-END
	glowworm ($version-1~deb$release) ${name:-unstable}; urgency=medium

	  * Version $version; changelog.gz beside this file says what is new.

	 -- $maintainer  $(date -R -d "${day:-@$(time_of "$tree")}")
END
build_depends >"$tree/debian/depends"
sed -e "s|@MAINTAINER@|$maintainer|" -e "/^@BUILD_DEPENDS@\$/{r $tree/debian/depends" -e 'd}' \
	"$tree/.debian/control.in" >"$tree/debian/control"
rm "$tree/debian/depends"
