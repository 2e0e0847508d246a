/* Small dense systems, and linear complementarity: no allocation, a bounded number of steps. */
#ifndef FINGERFEM_SMALL_H
#define FINGERFEM_SMALL_H

/* Solve for `columns` right-hand sides, (size, columns), in place, by elimination with pivots; returns 0 if singular. The
 * matrix, (size, size), is spoilt. */
int small_solve(int size, double *matrix, int columns, double *right);

/* Number of negative eigenvalues of a matrix's symmetric part, by the signs of its pivots (Sylvester); it is spoilt. */
int small_negative(int size, double *matrix);

/* Forces x >= 0, (size), with gaps A x + b >= 0 and one of both zero everywhere, by principal pivoting (Murty 1974, least
 * index): it ends for every positive definite A. Begins with those active that have x > 0; `soft` is added to A's
 * diagonal. Returns 0 if it found none. */
int small_complementarity(int size, const double *matrix, const double *b, double soft, double *x);
#endif
