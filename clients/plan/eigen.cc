// SPDX-License-Identifier: Apache-2.0
/*
 * eigen.cc - eigenvectors of a small symmetric matrix, by the library Eigen
 */
#include "eigen.h"

#include <Eigen/Eigenvalues>

void eigen_vectors(uint32_t n, const double *a, double *ret)
{
	Eigen::Map<const Eigen::MatrixXd> matrix(a, n, n);
	Eigen::Map<Eigen::MatrixXd> vectors(ret, n, n);

	vectors = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix)
			  .eigenvectors();
}
