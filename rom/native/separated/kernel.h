/* Numbers that the compiled answer of a separated model reads: its forms and contact-aligned coordinates.
 *
 * This is the one owner of the layout: the library's C, Python (rom.answer) and exported headers all use it.
 */
#ifndef FINGERFEM_KERNEL_H
#define FINGERFEM_KERNEL_H
#include <stdint.h>

/* Rows of an answer: tip displacement x, y, z [m], contact force [N], touch distance [m], pad pressure [Pa]. */
enum { FINGERFEM_TIP = 0, FINGERFEM_FORCE = 3, FINGERFEM_TOUCH = 4, FINGERFEM_PAD = 5 };

/* Limit of a model, which is checked when its file is read. */
enum { FINGERFEM_MOST_PARAMETERS = 9 };

/* Columns of a form's row of `forms`. */
enum { FINGERFEM_AXES, FINGERFEM_TERMS, FINGERFEM_COMPONENTS, FINGERFEM_MODES, FINGERFEM_ROW };

/* The two forms: without contact, by the tensions: tip [m], touch distance [m]; and what contact adds per length of
 * contact path, by the tensions and s: tip [-], contact force [N/m], pad pressure [Pa/m] if the model has it. */
enum { FINGERFEM_FREE_FORM = 0, FINGERFEM_CONTACT_FORM = 1, FINGERFEM_FREE_TOUCH = 3 };

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

/* A separated model; its last parameter is d, the object's distance. */
typedef struct {
    fingerfem_tables tables;
    int32_t parameters, has_pad, cells;
    const double *lower, *upper;    /* (parameters): the sampled box */
    const uint8_t *answered;        /* (cells^parameters), by tensions and s: whether the samples support an answer */
} fingerfem_kernel;
#endif
