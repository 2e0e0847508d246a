/* A segment as a rod of elements, condensed to its plate: a march from section to section, from the plate to the clamp. */
#ifndef FINGERFEM_ROD_MARCH_H
#define FINGERFEM_ROD_MARCH_H
#include "../element/element.h"
#include "../element/outline.h"
#include "../element/variants.h"

enum { ROD_WRENCH = FINGERFEM_WRENCH };

/* An element where it is: its distal section's place and rotation, seen from the plate, and the wrench carried through it,
 * in its own frame; the element's pose, its place turned into the plate's frame, its derivatives by the wrench; and what
 * turns a change of its Gibbs vector into a turn in the plate's frame. */
typedef struct {
    double pose[FINGERFEM_POSE], by_wrench[ROD_WRENCH * FINGERFEM_POSE]; /* first, each row in one line of the cache */
    double place[3], rotation[9], wrench[ROD_WRENCH], arm[3], turning[9];
    double unused[2]; /* the next one begins in another line */
} rod_element;

/* Viscoelastic rubber in a step of time, see ../contact/relaxation.h: an element has the pose of its law under the wrench w where
 * the law sees factors w - offsets, by component; offsets of all elements, (elements, 6) [N, N m]. */
typedef struct {
    double factors[ROD_WRENCH];
    const double *offsets;
} rod_relaxation;

/* A rod at some tensions; all in memory of fingerfem_segment_memory's size, of which several rods may share the last
 * rod_work numbers, `work`. */
typedef struct {
    const fingerfem_segment *segment;
    double *monomials, *free, *contracted, *products, *work; /* products by element, free and contracted by law */
    int rates;  /* whether derivatives by the tensions are there */
    int guided; /* whether tensions differ by element, by friction in guides: then monomials, free and contracted are by element */
    double *deviations;                                      /* of the variants of all elements, (elements, count, 8) */
    double *outlines; /* contracted ones by law, or element, each behind ROD_OUTLINED numbers: the first one is 1 once it is there */
    int free_stride, contracted_stride, products_stride, outlines_stride;
    double tensions[TENSIONS_MOST];
    const double *own_tensions; /* of every element, (elements, tensions); NULL unless guided */
    rod_element *elements;
    const double *masses, *rubber; /* as those of a chain, see segment.h; NULL where nothing weighs */
    rod_relaxation relaxation;     /* its offsets are NULL at rest */
} rod_state;

/* A plate seen from its clamp: the clamp's place and rotation seen from the plate, how the plate moves by the wrench, R^T dc
 * and R^T dtheta; and whether all elements' wrenches lie in their boxes. */
typedef struct {
    double place[3], rotation[9], by_wrench[ROD_WRENCH][ROD_WRENCH];
    int inside;
} rod_end;

/* Motion and rotation of a section by the tensions, in the plate's frame: rows, one number for every tension. */
typedef struct {
    double move[3][TENSIONS_MOST], turn[3][TENSIONS_MOST];
} rod_motion;

enum { ROD_OUTLINED = FINGERFEM_POSE }; /* so that rows lie in lines of the cache */

/* Which set of monomials, contracted coefficients and free poses is an element's. */
static inline int rod_set_of(const rod_state *rod, int k) { return rod->guided ? k : rod->segment->law_of[k]; }

static inline const double *rod_contracted(const rod_state *rod, int k)
{
    return rod->contracted + rod_set_of(rod, k) * rod->contracted_stride;
}

static inline const double *rod_free_pose(const rod_state *rod, int k)
{
    return rod->free + rod_set_of(rod, k) * rod->free_stride;
}

/* Monomials of the tensions in an element, and their derivatives by the tensions at the motors, (1 + tensions, monomials). */
static inline double *rod_monomials(const rod_state *rod, int k)
{
    return rod->monomials + (rod->guided ? k * (1 + rod->segment->tensions) * rod->segment->monomials : 0);
}

static inline const double *rod_tensions(const rod_state *rod, int k)
{
    return rod->guided ? rod->own_tensions + k * rod->segment->tensions : rod->tensions;
}

/* The wrench that an element's law sees, (6). */
static inline void rod_seen(const rod_state *rod, int k, double *seen)
{
    const rod_relaxation *relaxation = &rod->relaxation;
    for (int i = 0; i < ROD_WRENCH; i++) {
        seen[i] = rod->elements[k].wrench[i];
        if (relaxation->offsets) seen[i] = relaxation->factors[i] * seen[i] - relaxation->offsets[ROD_WRENCH * k + i];
    }
}

/* Numbers of memory that a rod keeps, and that it works in. */
int rod_memory(const fingerfem_segment *segment, int guided);
int rod_work(const fingerfem_segment *segment);

/* A rod at tensions inside their box, in such memory, with derivatives by them if `rates`; for `rod_free`, it need not be contracted. */
void rod_set_tensions(const fingerfem_segment *segment, const double *tensions, int rates, double *memory, double *work, rod_state *found);

/* The same where tensions differ by element, (elements, tensions), inside their box; with their derivatives by those at the motors,
 * (elements, tensions, tensions). The former are read until the rod is set anew. */
void rod_set_guided(const fingerfem_segment *segment, const double *tensions, const double *rates, double *memory, double *work,
                    rod_state *found);
void rod_contract(const rod_state *rod);

/* A part of a rod: elements `first` to `last` - 1. Its body is the distal section of its first element, the plate if that is
 * element 0: places, rotations and motions are seen from there, and it ends where its last element does. */
typedef struct {
    int first, last;
} rod_part;

/* The pose of an element of a contracted rod under its wrench, and its derivatives by that; returns 1 if the law is inside its box. */
int rod_pose(const rod_state *rod, int k);

/* The end of a part of a contracted rod under a wrench on its body, (6), and, with `motions`, how it moves by that. */
void rod_under(const rod_state *rod, rod_part part, const double *wrench, int motions, rod_end *end);

/* Motion of the body by the tensions, (6, TENSIONS_MOST), under the wrench that `rod_under` was called with last. */
void rod_by_tensions(const rod_state *rod, rod_part part, double (*motion)[TENSIONS_MOST]);

/* Deviations of the poses of all elements by their variants, (elements, count, 8), at the same loads. */
void rod_deviate(const rod_state *rod, int pressed);

/* Motion of the body by the variants of its elements, (6, TENSIONS_MOST), at the loads that `rod_under` was called with last,
 * or, unless it is pressed, `rod_free`. */
void rod_by_variants(const rod_state *rod, rod_part part, int pressed, double (*motion)[TENSIONS_MOST]);

/* The end of a rod without a wrench, without its motion by one, and how the plate moves by the tensions. */
void rod_free(const rod_state *rod, rod_end *end, double (*motion)[TENSIONS_MOST]);

/* Motion of an element's distal section by the tensions, as `rod_free` has placed it; the clamp, if `section` is the
 * number of elements. */
void rod_free_motion(const rod_state *rod, int section, rod_motion *moved);
#endif
