/* Small dense systems: no allocation. */
#ifndef FINGERFEM_SMALL_H
#define FINGERFEM_SMALL_H

#include <math.h>

/* Solve for `columns` right-hand sides, (size, columns), in place, by elimination with pivots; returns 0 if singular. The
 * matrix, (size, size), is spoilt. Where sizes are known its loops are unrolled. */
__attribute__((always_inline)) static inline int small_solve_of(int size, double *matrix, int columns, double *right)
{
    for (int k = 0; k < size; k++) {
        int pivot = k;
        for (int i = k + 1; i < size; i++)
            if (fabs(matrix[size * i + k]) > fabs(matrix[size * pivot + k])) pivot = i;
        if (!(fabs(matrix[size * pivot + k]) > 0.0)) return 0;
        for (int j = 0; pivot != k && j < size; j++) {
            const double swap = matrix[size * k + j];
            matrix[size * k + j] = matrix[size * pivot + j];
            matrix[size * pivot + j] = swap;
        }
        for (int j = 0; pivot != k && j < columns; j++) {
            const double swap = right[columns * k + j];
            right[columns * k + j] = right[columns * pivot + j];
            right[columns * pivot + j] = swap;
        }
        for (int i = 0; i < size; i++) {
            if (i == k) continue;
            const double factor = matrix[size * i + k] / matrix[size * k + k];
            for (int j = 0; j < size; j++) matrix[size * i + j] -= factor * matrix[size * k + j];
            for (int j = 0; j < columns; j++) right[columns * i + j] -= factor * right[columns * k + j];
        }
    }
    for (int k = 0; k < size; k++)
        for (int j = 0; j < columns; j++) right[columns * k + j] /= matrix[size * k + k];
    return 1;
}
int small_solve(int size, double *matrix, int columns, double *right);

/* The same in two steps: factors L U of a matrix, (size, size) with rows of `stride` numbers, in its place, and the rows that were exchanged,
 * (size), or 0 if it is singular; then the solution for a right-hand side, (size), in place. */
int small_factorise(int size, int stride, double *matrix, int *exchanged);
void small_substitute(int size, int stride, const double *factors, const int *exchanged, double *right);

/* The same of several right sides, (size). */
enum { SMALL_COLUMNS = 8 };
typedef double small_columns[SMALL_COLUMNS];
void small_combine(int count, const double *factors, const small_columns *rows, double *found); /* sum_j factors_j rows_j */
void small_substitute_columns(int size, int stride, const double *factors, const int *exchanged, small_columns *right);

/* Number of negative eigenvalues of a matrix's symmetric part, by the signs of its pivots (Sylvester); it is spoilt. */
int small_negative(int size, double *matrix);

/* Eigenvalues of a symmetric matrix, (size, size), on its diagonal in its place, and its eigenvectors in the columns of
 * `vectors`, (size, size), by Jacobi's method. */
void small_eigen(int size, double *matrix, double *vectors);

/* The symmetric part of a matrix, (size, size), in its place, with its negative eigenvalues set to 0 (by Jacobi's method);
 * `work` holds 2 size^2 numbers. */
void small_nonnegative(int size, double *matrix, double *work);
#endif
