#include "small.h"

int small_solve(int size, double *matrix, int columns, double *right)
{
    return size == 1 && columns == 1 ? small_solve_of(1, matrix, 1, right) : small_solve_of(size, matrix, columns, right);
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
