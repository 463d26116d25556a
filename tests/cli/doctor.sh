#!/usr/bin/env bash
# What doctor says of this machine, of one without a driver, of a driver that dies, of a folder that
# nothing can be written to, and of a program without its plugins.

# Verdicts and names of a group, without figures.
show() { # group
	awk -v group="$1" '/^[^ ]/ { inside = $0 == group } inside && /^  / {
		print substr($0, 1, 30) }' all.txt | sed 's/ *$//'
}
glowworm doctor >all.txt
echo "status $?"
show program
show 'device 0'
show libraries | sed -E 's/note  (OpenEXR|MPI)/good  \1/' # as it is mended, or built with it
grep -o 'closed form 2.6366; error 0\.' all.txt
tail -n 4 all.txt

glowworm doctor --json --device cpu --threads 1 --memory 1G >one.json
echo "status $?"
grep -o -e '"good": true' -e '"devices_that_bake": 1' \
	-e '"group": "device cpu", "name": "canary bake"' one.json
grep -c 'may take 1.07 GB' one.json

# Nothing to run on, and a home that is not there. Which drivers may be opened is not limited here.
unset MESA_SHADER_CACHE_DIR VK_LOADER_DRIVERS_SELECT
HOME=/nowhere XDG_CACHE_HOME='' VK_ICD_FILENAMES=/nowhere.json glowworm doctor >all.txt
echo "no driver: $?"
grep -E 'BAD|shader cache' all.txt

# A driver that ends the process as LLVM does.
cat >dies.c <<'END'
#include <stdio.h>
#include <stdlib.h>
void *vk_icdGetInstanceProcAddr(void *instance, const char *name)
{
	fprintf(stderr, "LLVM ERROR: out of memory\n");
	abort();
}
END
gcc -shared -fPIC -o dies.so dies.c
echo '{"file_format_version": "1.0.0",
	"ICD": {"library_path": "./dies.so", "api_version": "1.2.0"}}' >dies.json
VK_ICD_FILENAMES=$PWD/dies.json glowworm doctor >all.txt
echo "a driver that dies: $?"
grep BAD all.txt | sed 's/after .* s:/after a while:/'

glowworm doctor --device nothing >all.txt 2>err.txt
echo "no such device: $?"
grep BAD all.txt | grep -o 'no usable Vulkan device is meant by "nothing"'

# Three things that are not good, while bakes work.
mkdir alone && cp "$GLOWWORM" alone/glowworm
here=$PWD
(cd /proc && "$here/alone/glowworm" doctor >"$here/all.txt")
echo "no plugin, nowhere to write: $?"
grep -e BAD -e 'note  MPI' all.txt | cut -c 1-60
glowworm doctor file.ply
echo "a file: $?"
