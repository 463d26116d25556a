/* plane_normal.cpp - see plane_normal.h. PCL's templates are compiled here, so that the program
 * does not load PCL's libraries. */
#define PCL_NO_PRECOMPILE
#include <pcl/features/normal_3d.h>

#include "normals/plane_normal.h"

#include <cmath>

extern "C" gw_plane gw_plane_normal(const float *point, size_t count, float normal[3],
									float *curvature)
{
	try {
		pcl::PointCloud<pcl::PointXYZ> cloud;
		cloud.reserve(count);
		for (size_t i = 0; i < count; i++)
			cloud.push_back(pcl::PointXYZ(point[3 * i], point[3 * i + 1], point[3 * i + 2]));
		Eigen::Vector4f plane;
		if (!pcl::computePointNormal(cloud, plane, *curvature))
			return GW_PLANE_NONE;
		const float length = plane.head<3>().norm();
		if (!std::isfinite(length) || length < 0.5f || !std::isfinite(*curvature))
			return GW_PLANE_NONE;
		for (int k = 0; k < 3; k++)
			normal[k] = plane[k] / length;
		return GW_PLANE_FOUND;
	} catch (...) {
		return GW_PLANE_NO_MEMORY;
	}
}
