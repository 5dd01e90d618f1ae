/* SPDX-License-Identifier: Apache-2.0 */
/*
 * eigen.h - eigenvectors of a small symmetric matrix, by the library Eigen
 */
#ifndef PLAN_EIGEN_H
#define PLAN_EIGEN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** eigen_vectors() - of the @n x @n matrix @a, that of the least eigenvalue
 *  first; @ret: one after the other, each of length 1. */
void eigen_vectors(uint32_t n, const double *a, double *ret);

#ifdef __cplusplus
}
#endif

#endif /* PLAN_EIGEN_H */
