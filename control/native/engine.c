/* Constraints in a MuJoCo model, see engine.h. */
#include "engine.h"

double control_engine_along(const control_engine *engine, int row, const double *vector)
{
    const int is_sparse = engine->efc_J_rowadr != NULL, count = is_sparse ? engine->efc_J_rownnz[row] : engine->nv;
    const ptrdiff_t first = is_sparse ? engine->efc_J_rowadr[row] : (ptrdiff_t)row * engine->nv;
    double sum = 0.0;
    for (int i = 0; i < count; i++) sum += engine->efc_J[first + i] * vector[is_sparse ? engine->efc_J_colind[first + i] : i];
    return sum;
}
