# Each public header stands alone, and is clean C and C++ for compilers that take it strictly.
# sanitize: no
cp "$SOURCE"/lib/*.h .
check() { # file compiler standard
	"$2" -std="$3" -pedantic-errors -Wall -Wextra -Werror -I. -fsyntax-only "$1" ||
		echo "$header is no $3 for $2"
}
for header in *.h; do
	printf '#include "%s"\nint main(void)\n{\n\treturn 0;\n}\n' "$header" >use.c
	cp use.c use.cpp
	for standard in c99 c11 c17; do
		for compiler in gcc clang; do
			check use.c $compiler $standard
		done
	done
	for standard in c++11 c++17 c++20; do
		for compiler in g++ clang++; do
			check use.cpp $compiler $standard
		done
	done
done
# A C++ program can use it, too.
cat >bake.cpp <<'END'
#include "glowworm_picture.h"
int main()
{
	gw_bake_options options = gw_bake_options_default();
	gw_error error;
	gw_scene *scene = nullptr;
	gw_points points{};
	gw_scene_description nothing{ &points, nullptr, 0 };
	return gw_scene_create(&nothing, &options, nullptr, &scene, &error) != GW_ERROR_DATA;
}
END
folder=$(dirname "$GLOWWORM")
g++ -std=c++11 -pedantic-errors -Wall -Wextra -Werror -I. bake.cpp -o bake -L"$folder" -lglowworm &&
	LD_LIBRARY_PATH=$folder ./bake || echo "a bake of no points does not fail as it should"
