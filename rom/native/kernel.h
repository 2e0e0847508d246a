/* What the compiled answer of a surrogate reads: separated forms, contact regimes and their coordinates.
 *
 * This is the one owner of the layout: the library's C, Python (rom.native.answer) and exported headers all use it.
 */
#ifndef FINGERFEM_KERNEL_H
#define FINGERFEM_KERNEL_H
#include <stdint.h>

/* Rows of an answer: tip displacement x, y, z [m], contact force [N], touch distance [m], pad pressure [Pa]. */
enum { FINGERFEM_TIP = 0, FINGERFEM_FORCE = 3, FINGERFEM_TOUCH = 4, FINGERFEM_PAD = 5 };

/* Limits of a model, which are checked when its file is read; regimes are the bits of a number. */
enum { FINGERFEM_MOST_PARAMETERS = 9, FINGERFEM_MOST_REGIMES = 64 };

/* Columns of a form's row of `forms`. */
enum { FINGERFEM_AXES, FINGERFEM_TERMS, FINGERFEM_COMPONENTS, FINGERFEM_MODES, FINGERFEM_ROW };

/* Components of the free form: tip, then touch heights; of a regime's form (rom/fit/layout.py): tip, force, then its
 * conditions, and the pad's pressure last if that is known. */
enum { FINGERFEM_HEIGHTS = 3, FINGERFEM_CONDITIONS = 4 };

/* Separated forms sum_k mode_jk prod_a function_ak(x_a), one after another, with cubic pieces on even intervals. */
typedef struct {
    int32_t most_axes, most_terms, most_components; /* of any form */
    const int32_t *forms;  /* (forms, FINGERFEM_ROW): how many axes, terms and components, where its modes are in data */
    const int32_t *axes;   /* (forms, most_axes, 2): intervals, where their pieces are in data */
    const double *scales;  /* (forms, most_axes, 2): lower end, intervals per unit */
    const double *data;    /* pieces, (intervals, 4, terms) by axis, and modes, (components, terms), of every form */
} fingerfem_tables;

/* Numbers of memory that functions of forms need. */
#define FINGERFEM_FORMS_MEMORY(axes, terms, components) (3 * (1 + (axes)) * (terms) + (components)) /* at most */

/* Form 0 is the free one, by tensions: tip [m], then touch heights [m] of the corners that may touch first. Form 1 + r
 * is regime r's, by tensions and contact path: what contact adds to the tip [m], contact force [N], then the regime's
 * conditions, which hold while they are positive, then the pad's pressure [Pa] if the model knows it. All but conditions
 * are per length of contact path [1/m] where the regime begins at touch.
 */
typedef struct {
    fingerfem_tables tables;
    int32_t parameters, has_obstacle, has_pad, regimes, most_conditions, lookup_cells;
    const double *lower, *upper;    /* (parameters): the trained box */
    const int32_t *corners;         /* (regimes): which touch height is the regime's own */
    const int32_t *begins;          /* (regimes): whether the regime begins at touch */
    const double *sizes;            /* (regimes, most_conditions): what a condition is large or small against */
    const uint8_t *lookup;          /* regime to begin with, by cell of lookup_cells along every parameter */
    const uint64_t *possible;       /* regimes that are possible there, a bit each; none: nothing is known there */
    double nearest, softening;      /* of the contact path: nearest plane, and what keeps it smooth [m] */
} fingerfem_kernel;
#endif
