/*
 * Opens libglowworm-vdb.so and lends it a checked output: OpenVDB itself reports success on a full
 * disk. All of that happens in a child process, because OpenVDB and what it is linked to end the
 * process when memory is short or a thread cannot be started.
 */
#include "files/output_file.h"
#include "files/plugin.h"
#include "grids/vdb_grids.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct plugin {
	gw_status (*encode)(const gw_voxels *, const vdb_metadata *, vdb_sink, void *, vdb_digest *,
						gw_error *);
	gw_status (*verify)(const char *, const vdb_digest *, gw_error *);
} plugin;

/* What the child tells, in memory that it shares. */
typedef struct verdict {
	bool given;
	gw_status status;
	gw_error error;
	uint64_t clamped;
} verdict;

/* dlsym returns a pointer to data; ISO C has no cast from that to a function. */
static gw_status load(plugin *vdb, gw_error *error)
{
	static const char file[] = "libglowworm-vdb.so", purpose[] = "OpenVDB grids need";
	const void *address = NULL;
	GW_TRY(plugin_find(file, "vdb_encode", purpose, &address, error));
	memcpy(&vdb->encode, &address, sizeof vdb->encode);
	GW_TRY(plugin_find(file, "vdb_verify", purpose, &address, error));
	memcpy(&vdb->verify, &address, sizeof vdb->verify);
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

/* ---------------------------------------------------------------------------------- the child */

/* The parent's handlers would remove its files. */
static void forget_handlers(void)
{
	static const int caught[] = {
		SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL
	};
	for (size_t i = 0; i < sizeof caught / sizeof *caught; i++)
		signal(caught[i], SIG_DFL);
}

static void write_in_child(output_file *out, const gw_voxels *voxels, const vdb_metadata *metadata,
						   verdict *told)
{
	plugin vdb;
	vdb_metadata own = *metadata;
	own.clamped = &told->clamped;
	forget_handlers();
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	told->status = load(&vdb, &told->error);
	if (told->status == GW_OK)
		told->status = encode_and_verify(&vdb, out, voxels, &own, &told->error);
	told->given = true;
	/* No buffer, handler or library of the parent's shall notice this end. */
	for (;;)
		raise(SIGKILL);
}

/* Waits for the child. A signal that asks the program to stop ends it. */
static gw_status await(pid_t child, const output_file *out, const verdict *told, gw_error *error)
{
	int end = 0;
	bool stopped = false;
	while (waitpid(child, &end, 0) < 0 && errno == EINTR) {
		stopped = true;
		kill(child, SIGKILL);
	}
	if (stopped || (WIFSIGNALED(end) && (WTERMSIG(end) == SIGINT || WTERMSIG(end) == SIGTERM)))
		return gw_fail(error, GW_ERROR_CANCELLED, "writing %s was interrupted",
					   output_file_name(out));
	if (!told->given)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "OpenVDB died while it wrote %s, most likely because memory or threads ran "
					   "out (%s): allow more, or leave the grids out",
					   output_file_name(out),
					   WIFSIGNALED(end) ? strsignal(WTERMSIG(end)) : "it ended the process");
	if (told->status != GW_OK && error)
		*error = told->error;
	return told->status;
}

static gw_status write_apart(output_file *out, const gw_voxels *voxels,
							 const vdb_metadata *metadata, gw_error *error)
{
	verdict *told =
		mmap(NULL, sizeof *told, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	pid_t child = told == MAP_FAILED ? -1 : fork();
	gw_status status;
	if (child == 0)
		write_in_child(out, voxels, metadata, told);
	if (child < 0)
		status = gw_fail(error, GW_ERROR_MEMORY, "cannot start a process that writes %s: %s",
						 output_file_name(out), strerror(errno));
	else
		status = await(child, out, told, error);
	if (status == GW_OK && metadata->clamped)
		*metadata->clamped = told->clamped;
	if (told != MAP_FAILED)
		munmap(told, sizeof *told);
	return status;
}

gw_status vdb_write(const char *path, bool force, const gw_voxels *voxels,
					const vdb_metadata *metadata, gw_error *error)
{
	output_file *out = NULL;
	GW_TRY(output_file_create(&out, path, force, error));
	gw_status status = write_apart(out, voxels, metadata, error);
	if (status == GW_OK)
		return output_file_commit(&out, error);
	output_file_abandon(&out);
	return status;
}
