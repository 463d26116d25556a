// pcl_loaders.cpp - see pcl_loaders.h. No exception leaves it.
#include "pcl_loaders.h"

#include <pcl/console/print.h>
#include <pcl/io/obj_io.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <string>

static bool ends_in(const std::string &path, const char *extension)
{
	std::string end(extension);
	return path.size() >= end.size() &&
		   path.compare(path.size() - end.size(), end.size(), end) == 0;
}

static int load(const std::string &path, pcl::PCLPointCloud2 &cloud)
{
	pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
	if (ends_in(path, ".ply"))
		return pcl::PLYReader().read(path, cloud);
	if (ends_in(path, ".pcd"))
		return pcl::PCDReader().read(path, cloud);
	if (ends_in(path, ".obj"))
		return pcl::OBJReader().read(path, cloud);
	return -1;
}

size_t pcl_load(const char *path)
try {
	pcl::PCLPointCloud2 cloud;
	return load(path, cloud) < 0 ? 0 : static_cast<size_t>(cloud.width) * cloud.height;
} catch (...) {
	return 0;
}

bool pcl_save_text(const char *from, const char *to)
try {
	pcl::PCLPointCloud2 cloud;
	return load(from, cloud) >= 0 && pcl::PCDWriter().writeASCII(to, cloud) >= 0;
} catch (...) {
	return false;
}

bool pcl_save_compressed(const char *from, const char *to)
try {
	pcl::PCLPointCloud2 cloud;
	return load(from, cloud) >= 0 && pcl::PCDWriter().writeBinaryCompressed(to, cloud) >= 0;
} catch (...) {
	return false;
}
