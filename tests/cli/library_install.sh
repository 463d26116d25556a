# `make install` puts the library where pkg-config and the loader find it, `make uninstall` leaves
# nothing behind, and a program is built against what lies there alone.
# sanitize: no
install() {
	make -s -C "$SOURCE" BUILD="$(dirname "$GLOWWORM")" PREFIX=/opt/glow DESTDIR="$PWD/root" "$@"
}
install install >log 2>&1 || cat log
(cd root/opt/glow && ls include lib lib/pkgconfig | grep -v '^$') | sed 's/so\.[0-9.]*$/so.N/'
export PKG_CONFIG_PATH=$PWD/root/opt/glow/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$PWD/root
sed -n 's/.*GW_VERSION "\(.*\)"/\1/p' "$SOURCE/lib/glowworm.h" >version
pkg-config --modversion libglowworm | cmp - version
cat >say.c <<'END'
#include <glowworm.h>
#include <stdio.h>
int main(void)
{
	return puts(gw_version()) < 0;
}
END
# shellcheck disable=SC2046
gcc say.c $(pkg-config --cflags --libs libglowworm) -o say
LD_LIBRARY_PATH=$PWD/root/opt/glow/lib ./say | cmp - version
# Without the shared library the static one is enough.
rm root/opt/glow/lib/libglowworm.so
# shellcheck disable=SC2046
gcc say.c $(pkg-config --static --cflags --libs libglowworm) -o say && ./say | cmp - version
install uninstall
find root -type f -o -type l
# Where LIBDIR says so the library lies elsewhere; plugins stay where the program finds them.
install install LIBDIR=/opt/glow/lib/here >log 2>&1 || cat log
(cd root/opt/glow/lib && ls here glowworm/libglowworm-proj.so) | sed 's/so\.[0-9.]*$/so.N/'
PKG_CONFIG_PATH=$PWD/root/opt/glow/lib/here/pkgconfig pkg-config --libs libglowworm |
	grep -o '/opt/glow/lib/here '
install uninstall LIBDIR=/opt/glow/lib/here
find root -type f -o -type l
