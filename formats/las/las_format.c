#include "las/las_format.h"
#include "las/las_flight.h"
#include "las/las_grid.h"
#include "las/las_header.h"
#include "las/las_notes.h"

#include <string.h>

/* The highest two bits of the point format say that the points are compressed. */
static bool is_las(const uint8_t *head, size_t length, bool compressed)
{
	return length > 104 && memcmp(head, "LASF", 4) == 0 && ((head[104] & 0xc0) != 0) == compressed;
}

static bool probe_las(const uint8_t *head, size_t length)
{
	return is_las(head, length, false);
}

/* The VLR that says where the octree is comes first. */
static bool probe_copc(const uint8_t *head, size_t length)
{
	const uint8_t *user = head + LAS_HEADER_BYTES_1_4 + 2;
	return is_las(head, length, true) && length > LAS_HEADER_BYTES_1_4 + LAS_VLR_BYTES &&
		   memcmp(user, LAS_USER_COPC, sizeof LAS_USER_COPC) == 0;
}

static bool probe_laz(const uint8_t *head, size_t length)
{
	return is_las(head, length, true) && !probe_copc(head, length);
}

static const char *const las_extensions[] = { "las", NULL };
static const char *const laz_extensions[] = { "laz", NULL };
static const char *const copc_extensions[] = { "copc.laz", NULL };

static gw_status las_accept(const scan *cloud, const char *name, gw_error *error)
{
	las_grid grid;
	for (int axis = 0; axis < 3; axis++)
		GW_TRY(las_grid_find(cloud, axis, name, &grid, error));
	return GW_OK;
}

const format las_format = {
	.name = "las",
	.description = "ASPRS laser scan",
	.extensions = las_extensions,
	.probe = probe_las,
	.read = las_read,
	.count_rows = las_count_rows,
	.say_bounds = las_say_bounds,
	.read_rows = las_read_rows,
	.settle_rows = las_settle_rows,
	.needs_all = las_flight_is_told,
	.accept = las_accept,
	.row_bytes = 30, /* of the smallest record that is written */
	.write = las_write,
	.parted = &las_parted,
};

const format laz_format = {
	.name = "laz",
	.description = "compressed LAS",
	.extensions = laz_extensions,
	.probe = probe_laz,
	.read = las_read,
	.count_rows = las_count_rows,
	.packed = true,
	.say_bounds = las_say_bounds,
	.read_rows = las_read_rows,
	.settle_rows = las_settle_rows,
	.needs_all = las_flight_is_told,
	.accept = las_accept,
	.row_bytes = 1, /* real points take more */
	.write = laz_write,
	.parted = &laz_parted,
};

const format copc_format = {
	.name = "copc",
	.description = "LAZ in an octree, for viewers that load what they show",
	.extensions = copc_extensions,
	.probe = probe_copc,
	.read = las_read,
	.count_rows = las_count_rows,
	.packed = true,
	.read_rows = las_read_rows,
	.settle_rows = las_settle_rows,
	.needs_all = las_flight_is_told,
	.accept = las_accept,
	.row_bytes = 1,
	.write = copc_write,
};
