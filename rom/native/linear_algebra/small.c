/* Small dense systems and eigenvalues; nothing is allocated. */
#include "small.h"

int small_solve(int size, double *matrix, int columns, double *right)
{
    /* a single equation has a copy of its own, with unrolled loops */
    return size == 1 && columns == 1 ? small_solve_of(1, matrix, 1, right) : small_solve_of(size, matrix, columns, right);
}

#include <string.h>

int small_factorise(int size, int stride, double *matrix, int *exchanged)
{
    for (int k = 0; k < size; k++) {
        double *own = matrix + stride * k;
        int pivot = k;
        for (int i = k + 1; i < size; i++)
            if (fabs(matrix[stride * i + k]) > fabs(matrix[stride * pivot + k])) pivot = i;
        if (!(fabs(matrix[stride * pivot + k]) > 0.0)) return 0;
        exchanged[k] = pivot;
        for (int j = 0; pivot != k && j < size; j++) {
            const double swap = own[j];
            own[j] = matrix[stride * pivot + j];
            matrix[stride * pivot + j] = swap;
        }
        /* L below the diagonal, U above it, and the inverse of its diagonal */
        own[k] = 1.0 / own[k];
        for (int i = k + 1; i < size; i++) {
            double *restrict row = matrix + stride * i;
            const double factor = row[k] *= own[k];
            for (int j = k + 1; j < size; j++) row[j] -= factor * own[j];
        }
    }
    return 1;
}

void small_substitute(int size, int stride, const double *factors, const int *exchanged, double *right)
{
    /* exchanges of rows, then L y = right, then U x = y */
    for (int k = 0; k < size; k++) {
        const double swap = right[k];
        right[k] = right[exchanged[k]];
        right[exchanged[k]] = swap;
    }
    for (int i = 1; i < size; i++) {
        double sum = 0.0;
        for (int j = 0; j < i; j++) sum += factors[stride * i + j] * right[j];
        right[i] -= sum;
    }
    for (int i = size - 1; i >= 0; i--) {
        double sum = 0.0;
        for (int j = i + 1; j < size; j++) sum += factors[stride * i + j] * right[j];
        right[i] = (right[i] - sum) * factors[stride * i + i];
    }
}

/* By four sums, none of which waits for another. */
void small_combine(int count, const double *factors, const small_columns *rows, double *found)
{
    small_columns one = {0.0}, two = {0.0}, three = {0.0}, four = {0.0};
    int j = 0;
    for (; j + 3 < count; j += 4)
        for (int c = 0; c < SMALL_COLUMNS; c++) {
            one[c] += factors[j] * rows[j][c];
            two[c] += factors[j + 1] * rows[j + 1][c];
            three[c] += factors[j + 2] * rows[j + 2][c];
            four[c] += factors[j + 3] * rows[j + 3][c];
        }
    for (; j < count; j++)
        for (int c = 0; c < SMALL_COLUMNS; c++) one[c] += factors[j] * rows[j][c];
    for (int c = 0; c < SMALL_COLUMNS; c++) found[c] = one[c] + two[c] + three[c] + four[c];
}

void small_substitute_columns(int size, int stride, const double *factors, const int *exchanged, small_columns *right)
{
    small_columns sum;
    for (int k = 0; k < size; k++) {
        small_columns swap;
        memcpy(swap, right[k], sizeof swap);
        memcpy(right[k], right[exchanged[k]], sizeof swap);
        memcpy(right[exchanged[k]], swap, sizeof swap);
    }
    for (int i = 1; i < size; i++) {
        small_combine(i, factors + stride * i, right, sum);
        for (int c = 0; c < SMALL_COLUMNS; c++) right[i][c] -= sum[c];
    }
    for (int i = size - 1; i >= 0; i--) {
        const double *row = factors + stride * i + i;
        small_combine(size - 1 - i, row + 1, right + i + 1, sum);
        for (int c = 0; c < SMALL_COLUMNS; c++) right[i][c] = (right[i][c] - sum[c]) * row[0];
    }
}

#define SWEEPS 20      /* most sweeps of Jacobi's method, each of which squares what is off the diagonal */
#define DIAGONAL 1e-14 /* converged: largest number off the diagonal over the largest on it [-] */

/* A <- (A + A^T) / 2. */
static void symmetrise(int size, double *matrix)
{
    for (int i = 0; i < size; i++)
        for (int j = 0; j < i; j++)
            matrix[size * i + j] = matrix[size * j + i] = 0.5 * (matrix[size * i + j] + matrix[size * j + i]);
}

int small_negative(int size, double *matrix)
{
    int negative = 0;
    symmetrise(size, matrix);
    /* elimination without exchanges, A = L D L^T: D has as many negative numbers as A negative eigenvalues */
    for (int k = 0; k < size; k++) {
        const double pivot = matrix[size * k + k];
        negative += pivot < 0.0;
        for (int i = k + 1; i < size; i++) {
            const double factor = pivot == 0.0 ? 0.0 : matrix[size * i + k] / pivot;
            for (int j = k + 1; j < size; j++) matrix[size * i + j] -= factor * matrix[size * k + j];
        }
    }
    return negative;
}

/* Jacobi rotation J of i and j: A <- J^T A J with A_ij = 0, V <- V J (Golub and Van Loan, Matrix Computations, 8.5). */
static void turn(int size, double *matrix, double *vectors, int i, int j)
{
    const double off = matrix[size * i + j];
    if (off == 0.0) return;
    /* t = tan of the angle: the smaller root of t^2 + 2 tau t - 1 = 0; c = cos, s = sin */
    const double tau = (matrix[size * j + j] - matrix[size * i + i]) / (2.0 * off);
    const double t = copysign(1.0 / (fabs(tau) + sqrt(1.0 + tau * tau)), tau), c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    /* columns: A <- A J */
    for (int k = 0; k < size; k++) {
        const double one = matrix[size * k + i], other = matrix[size * k + j];
        matrix[size * k + i] = c * one - s * other;
        matrix[size * k + j] = s * one + c * other;
    }
    /* rows: A <- J^T A */
    for (int k = 0; k < size; k++) {
        const double one = matrix[size * i + k], other = matrix[size * j + k];
        matrix[size * i + k] = c * one - s * other;
        matrix[size * j + k] = s * one + c * other;
    }
    /* eigenvectors: V <- V J */
    for (int k = 0; k < size; k++) {
        const double one = vectors[size * k + i], other = vectors[size * k + j];
        vectors[size * k + i] = c * one - s * other;
        vectors[size * k + j] = s * one + c * other;
    }
}

void small_eigen(int size, double *matrix, double *vectors)
{
    /* Jacobi's method, A = V D V^T, from V = 1 */
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) vectors[size * i + j] = i == j;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double off = 0.0, largest = 0.0;
        /* stop: what is off the diagonal is negligible */
        for (int i = 0; i < size; i++) {
            largest = fmax(largest, fabs(matrix[size * i + i]));
            for (int j = 0; j < i; j++) off = fmax(off, fabs(matrix[size * i + j]));
        }
        if (!(off > DIAGONAL * largest)) break;
        /* one sweep: a rotation for every pair */
        for (int i = 0; i < size; i++)
            for (int j = i + 1; j < size; j++) turn(size, matrix, vectors, i, j);
    }
}

void small_nonnegative(int size, double *matrix, double *work)
{
    double *diagonal = work, *vectors = work + size * size;
    symmetrise(size, matrix);
    /* no negative eigenvalue: the symmetric part is the answer */
    memcpy(diagonal, matrix, (size_t)(size * size) * sizeof *matrix);
    if (!small_negative(size, diagonal)) return;
    memcpy(diagonal, matrix, (size_t)(size * size) * sizeof *matrix);
    small_eigen(size, diagonal, vectors);
    /* A = sum_k max(d_k, 0) v_k v_k^T */
    memset(matrix, 0, (size_t)(size * size) * sizeof *matrix);
    for (int k = 0; k < size; k++) {
        const double value = fmax(diagonal[size * k + k], 0.0);
        for (int i = 0; i < size; i++)
            for (int j = 0; j < size; j++)
                matrix[size * i + j] += value * vectors[size * i + k] * vectors[size * j + k];
    }
}
