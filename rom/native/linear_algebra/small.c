#include "small.h"

int small_solve(int size, double *matrix, int columns, double *right)
{
    return size == 1 && columns == 1 ? small_solve_of(1, matrix, 1, right) : small_solve_of(size, matrix, columns, right);
}

#include <string.h>

#define SWEEPS 20      /* of Jacobi's method, which squares what is off the diagonal in each */
#define DIAGONAL 1e-14 /* off the diagonal, of the largest on it: nothing */

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

/* Turn rows and columns i and j so that the matrix has 0 there (Golub and Van Loan, Matrix Computations, 8.5). */
static void turn(int size, double *matrix, double *vectors, int i, int j)
{
    const double off = matrix[size * i + j];
    if (off == 0.0) return;
    const double tau = (matrix[size * j + j] - matrix[size * i + i]) / (2.0 * off);
    const double t = copysign(1.0 / (fabs(tau) + sqrt(1.0 + tau * tau)), tau), c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    for (int k = 0; k < size; k++) {
        const double one = matrix[size * k + i], other = matrix[size * k + j];
        matrix[size * k + i] = c * one - s * other;
        matrix[size * k + j] = s * one + c * other;
    }
    for (int k = 0; k < size; k++) {
        const double one = matrix[size * i + k], other = matrix[size * j + k];
        matrix[size * i + k] = c * one - s * other;
        matrix[size * j + k] = s * one + c * other;
    }
    for (int k = 0; k < size; k++) {
        const double one = vectors[size * k + i], other = vectors[size * k + j];
        vectors[size * k + i] = c * one - s * other;
        vectors[size * k + j] = s * one + c * other;
    }
}

void small_nonnegative(int size, double *matrix, double *work)
{
    double *diagonal = work, *vectors = work + size * size;
    symmetrise(size, matrix);
    memcpy(diagonal, matrix, (size_t)(size * size) * sizeof *matrix);
    if (!small_negative(size, diagonal)) return;
    memcpy(diagonal, matrix, (size_t)(size * size) * sizeof *matrix);
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) vectors[size * i + j] = i == j;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double off = 0.0, largest = 0.0;
        for (int i = 0; i < size; i++) {
            largest = fmax(largest, fabs(diagonal[size * i + i]));
            for (int j = 0; j < i; j++) off = fmax(off, fabs(diagonal[size * i + j]));
        }
        if (!(off > DIAGONAL * largest)) break;
        for (int i = 0; i < size; i++)
            for (int j = i + 1; j < size; j++) turn(size, diagonal, vectors, i, j);
    }
    memset(matrix, 0, (size_t)(size * size) * sizeof *matrix);
    for (int k = 0; k < size; k++) {
        const double value = fmax(diagonal[size * k + k], 0.0);
        for (int i = 0; i < size; i++)
            for (int j = 0; j < size; j++)
                matrix[size * i + j] += value * vectors[size * i + k] * vectors[size * j + k];
    }
}
