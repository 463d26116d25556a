/*
 * Opens libglowworm-vdb.so and lends it a checked output: OpenVDB itself reports success on a full
 * disk. The linker's run path names the folders where the shared object may lie.
 */
#include "output_file.h"
#include "vdb_grids.h"

#include <dlfcn.h>
#include <string.h>

typedef struct plugin {
	gw_status (*encode)(const gw_voxels *, const vdb_metadata *, vdb_sink, void *, vdb_digest *,
						gw_error *);
	gw_status (*verify)(const char *, const vdb_digest *, gw_error *);
} plugin;

/* dlsym returns a pointer to data; ISO C has no cast from that to a function. */
static bool find_function(void *library, const char *name, void *function, size_t size)
{
	void *address = dlsym(library, name);
	memcpy(function, &address, size);
	return address != NULL;
}

/* Never closed: OpenVDB's threads outlive a call. Opening again only counts. */
static gw_status load(plugin *vdb, gw_error *error)
{
	void *library = dlopen("libglowworm-vdb.so", RTLD_NOW | RTLD_LOCAL);
	if (!library || !find_function(library, "vdb_encode", &vdb->encode, sizeof vdb->encode) ||
		!find_function(library, "vdb_verify", &vdb->verify, sizeof vdb->verify))
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "OpenVDB grids need libglowworm-vdb.so, which is installed beside "
					   "glowworm or in its library folder: %s",
					   dlerror());
	return GW_OK;
}

gw_status vdb_load(gw_error *error)
{
	plugin vdb;
	return load(&vdb, error);
}

static bool sink(void *user, const void *bytes, size_t length)
{
	return output_file_write(user, bytes, length, NULL) == GW_OK;
}

static gw_status encode_and_verify(const plugin *vdb, output_file *out, const gw_voxels *voxels,
								   const vdb_metadata *metadata, gw_error *error)
{
	vdb_digest digest;
	gw_status status = vdb->encode(voxels, metadata, sink, out, &digest, error);
	/* The output knows best why its bytes could not be written. */
	gw_status written = output_file_flush(out, error);
	if (status == GW_OK)
		status = written;
	const char *temporary = output_file_temporary(out);
	if (status != GW_OK || !temporary)
		return status;
	gw_error reason = { 0 };
	status = vdb->verify(temporary, &digest, &reason);
	if (status != GW_OK)
		return gw_fail(error, status, "%s was written, but cannot be read back: %s",
					   output_file_name(out), reason.text);
	return GW_OK;
}

gw_status vdb_write(const char *path, bool force, const gw_voxels *voxels,
					const vdb_metadata *metadata, gw_error *error)
{
	plugin vdb;
	output_file *out = NULL;
	gw_status status = load(&vdb, error);
	if (status == GW_OK)
		status = output_file_create(&out, path, force, error);
	if (status != GW_OK)
		return status;
	status = encode_and_verify(&vdb, out, voxels, metadata, error);
	if (status == GW_OK)
		return output_file_commit(&out, error);
	output_file_abandon(&out);
	return status;
}
