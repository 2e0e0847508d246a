/* An element's law in two stages: tensions are contracted once for all elements that share it; then the polynomial of the
 * wrench is evaluated, as sums over products of the force and, inside these, over products of the moment. */
#ifndef FINGERFEM_ELEMENT_H
#define FINGERFEM_ELEMENT_H
#include "wide.h"
#include "tensions.h"

enum { ELEMENT_PRODUCT = 4 /* numbers of a product of a force, or of a moment: its value and its derivatives */ };

/* Numbers of contracted coefficients, and of products of a wrench. */
int element_contracted(const fingerfem_segment *segment, const fingerfem_law *law);
int element_products(const fingerfem_segment *segment, const fingerfem_law *law);

/* Coefficients of the wrench's products at tensions of which the monomials are known, (groups, 8), and, with `rates`, their derivatives
 * by these, (tensions, slope_count, 8). */
void element_contract(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials, int rates, double *contracted);

/* Pose and its derivatives by the wrench, (1 + 6, 8), from contracted coefficients; linear beyond the box. Products of force
 * and moment are left in `products`. */
void element_pose(const fingerfem_law *law, const double *contracted, const double *wrench, double *products, double *pose);

/* Derivatives of the pose by the tensions, (tensions, 8), with the products that `element_pose` has left, inside the box.
 * Beyond it, the slopes by the wrench do not change with the tensions. */
void element_by_tensions(const fingerfem_segment *segment, const fingerfem_law *law, const double *contracted,
                         const double *products, double *by_tensions);

/* Pose without a wrench and its derivatives by the tensions, (1 + tensions, 8). */
void element_free(const fingerfem_segment *segment, const fingerfem_law *law, const double *monomials, double *found);

/* Whether a wrench, (6), lies in the trained box, and its force is none larger than was trained. */
int element_inside(const fingerfem_law *law, const double *wrench);
#endif
