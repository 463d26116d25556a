/* plane_normal.cpp - see plane_normal.h. PCL's templates are compiled here, so that the program
 * does not load PCL's libraries: what pcl::computePointNormal is made of, whose own header takes
 * twice as long to compile. */
#define PCL_NO_PRECOMPILE
#include <pcl/common/centroid.h>
#include <pcl/common/eigen.h>
#include <pcl/point_types.h>
#include <Eigen/Eigenvalues>

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
		Eigen::Matrix3f covariance;
		Eigen::Vector4f centre;
		if (count < 3 || pcl::computeMeanAndCovarianceMatrix(cloud, covariance, centre) == 0)
			return GW_PLANE_NONE;
		float smallest;
		Eigen::Vector3f axis;
		pcl::eigen33(covariance, smallest, axis);
		const float sum = covariance(0, 0) + covariance(1, 1) + covariance(2, 2);
		*curvature = sum != 0 ? std::abs(smallest / sum) : 0;
		const float length = axis.norm();
		if (!std::isfinite(length) || length < 0.5f || !std::isfinite(*curvature))
			return GW_PLANE_NONE;
		for (int k = 0; k < 3; k++)
			normal[k] = axis[k] / length;
		return GW_PLANE_FOUND;
	} catch (...) {
		return GW_PLANE_NO_MEMORY;
	}
}

extern "C" bool gw_plane_of_covariance(const double covariance[6], double normal[3], double *least)
{
	Eigen::Matrix3d matrix;
	const double *c = covariance;
	matrix << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
	if (!matrix.allFinite())
		return false;
	Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
	solver.computeDirect(matrix);
	*least = solver.eigenvalues()[0];
	for (int k = 0; k < 3; k++)
		normal[k] = solver.eigenvectors()(k, 0);
	return true;
}
