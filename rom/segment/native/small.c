#include "small.h"
#include <math.h>
#include <string.h>
#include "segment.h"

#define PIVOTS 64
#define PULL 1e-12 /* [N] below zero that is rounding */
#define INSIDE 1e-14 /* [m] */

int small_solve(int size, double *matrix, int columns, double *right)
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
            for (int j = k; j < size; j++) matrix[size * i + j] -= factor * matrix[size * k + j];
            for (int j = 0; j < columns; j++) right[columns * i + j] -= factor * right[columns * k + j];
        }
    }
    for (int k = 0; k < size; k++)
        for (int j = 0; j < columns; j++) right[columns * k + j] /= matrix[size * k + k];
    return 1;
}

int small_negative(int size, double *matrix)
{
    int negative = 0;
    for (int i = 0; i < size; i++)
        for (int j = 0; j < i; j++)
            matrix[size * i + j] = matrix[size * j + i] = 0.5 * (matrix[size * i + j] + matrix[size * j + i]);
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

int small_complementarity(int size, const double *matrix, const double *b, double soft, double *x)
{
    int active[FINGERFEM_MOST_CONTACTS];
    for (int i = 0; i < size; i++) active[i] = x[i] > 0.0;
    for (int step = 0; step < PIVOTS; step++) {
        int rows[FINGERFEM_MOST_CONTACTS], count = 0, wrong = -1;
        double own[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], forces[FINGERFEM_MOST_CONTACTS];
        for (int i = 0; i < size; i++)
            if (active[i]) rows[count++] = i;
        for (int i = 0; i < count; i++) {
            forces[i] = -b[rows[i]];
            for (int j = 0; j < count; j++)
                own[count * i + j] = matrix[size * rows[i] + rows[j]] + (i == j ? soft : 0.0);
        }
        if (!small_solve(count, own, 1, forces)) return 0;
        memset(x, 0, (size_t)size * sizeof *x);
        for (int i = 0; i < count; i++) x[rows[i]] = forces[i];
        for (int i = 0; i < size && wrong < 0; i++) {
            double gap = b[i];
            for (int j = 0; j < count; j++) gap += matrix[size * i + rows[j]] * forces[j];
            if (active[i] ? x[i] < -PULL : gap < -INSIDE) wrong = i;
        }
        if (wrong < 0) return 1;
        active[wrong] = !active[wrong];
    }
    return 0;
}
