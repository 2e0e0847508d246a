/* A segment, a rigid object, and where they touch: what Python sees. Arrays are row by row; nothing is allocated
 * and no state is kept. */
#ifndef FINGERFEM_SEGMENT_H
#define FINGERFEM_SEGMENT_H
#include <stdint.h>

/* Six numbers of an element's pose, in rows of FINGERFEM_POSE: place of its proximal section seen from the distal one [m],
 * and the Gibbs vector tan(angle / 2) axis of that rotation [-]. */
enum { FINGERFEM_POSE = 8, FINGERFEM_WRENCH = 6, FINGERFEM_MOST_CONTACTS = 96, FINGERFEM_MOST_PLATES = 8 };

/* Plates, loaded sections, and the ground: what may bear wrenches at once. */
enum { FINGERFEM_MOST_BODIES = FINGERFEM_MOST_PLATES + 9, FINGERFEM_MOST_OBJECTS = 8 };

/* Limits of a segment, which are checked before its struct is made. */
enum { FINGERFEM_MOST_TENSIONS = 8, FINGERFEM_MOST_POWER = 31, FINGERFEM_MOST_ELEMENTS = 64, FINGERFEM_MOST_VARIANTS = 8 };
enum { FINGERFEM_MOST_VERTICES = 64 /* of a section's outline */ };
enum { FINGERFEM_MOST_LOADS = FINGERFEM_WRENCH * FINGERFEM_MOST_PLATES * FINGERFEM_MOST_ELEMENTS };

/* Rows of an answer before one object, as of a separated model: tip displacement x, y, z [m], contact force [N], touch
 * distance [m]. Before several there are the forces of all, then their touch distances: 3 + 2 count rows. */
enum { FINGERFEM_ROWS = 5, FINGERFEM_MOST_ROWS_TOUCHED = 3 + 2 * FINGERFEM_MOST_OBJECTS };

/* Sections of a segment's surface besides its places: its plate's front. */
enum { FINGERFEM_FRONTS = 1 };

enum { FINGERFEM_PLANE = 0, FINGERFEM_SPHERE = 1, FINGERFEM_CYLINDER = 2, FINGERFEM_HULL = 3 };

/* An element's law: from tensions F and the wrench w that its distal section carries, in that one's frame, to the pose of
 * its proximal section seen from there, place [m] and Gibbs vector [-]: sum_gm coefficients_gm M_m(F) P_g(w), products of
 * Chebyshev polynomials of the scaled inputs. Group g is a product of the force times one of the moment. Product a of the
 * force goes with the first moments_of[a] of the moment's, of which the very first is 1; so the groups lie in `rows`. Each
 * has the first monomials of the segment's tensions, as many as its own degree leaves, the very first of which is 1. Groups
 * are stored in blocks that have as many, the most first. */
enum { FINGERFEM_BLOCK = 4, FINGERFEM_BLOCK_ROW = 24 /* 4 x 6 */ };
typedef struct {
    int32_t groups, monomials;       /* groups fill whole blocks */
    int32_t forces, moments;         /* products of each */
    int32_t most_power;              /* highest of the wrench */
    const double *lower, *upper;     /* (8): the trained box of the wrench [N, N m], then -1 and 1 */
    const int32_t *force_factors, *moment_factors; /* (forces, 3), (moments, 3): 4 (3 power + component) of every factor */
    const int32_t *moments_of;       /* (forces): how many go with each */
    const int32_t *rows;             /* (groups): the row of each among the contracted ones */
    int32_t slope_count;             /* groups that depend on tensions, which have two monomials at least; and one row more */
    const int32_t *slope_moments_of; /* (forces): how many of these go with each product of the force, the first ones */
    const int32_t *slope_rows;       /* (groups): the row of each among these; of all others the last one */
    const int32_t *block_monomials;  /* (groups / FINGERFEM_BLOCK) */
    const double *coefficients;      /* (block, block_monomials, FINGERFEM_BLOCK, 6) */
    const double *free_coefficients; /* (monomials, FINGERFEM_POSE): of the pose without a wrench */
} fingerfem_law;

/* Numbers of a plate's corners, 8 x 3. */
enum { FINGERFEM_CORNERS = 24 };

/* An element's outline: the corners, -y -z, -y z, y -z and y z, of some cross-sections, its knots, from the clamp's side to
 * the plate's, seen from its distal section, or its plate's centre [m]: sum_k coefficients_k M_k(F) P_k(w), products of
 * Chebyshev polynomials of the scaled tensions and of the wrench that its distal section carries. */
typedef struct {
    int32_t knots, numbers;           /* the latter of the corners, (knots, 4, 3), and zeros that fill eights */
    int32_t terms, products, monomials;  /* products of the wrench; the first monomials of the tensions, for those without */
    int32_t most_power;                  /* highest of the wrench */
    const double *lower, *upper;         /* (6): the trained box of the wrench [N, N m] */
    const int32_t *wrench_powers;        /* (products, 6) */
    const int32_t *term_monomials, *term_products; /* (terms): which of the segment's monomials, and of the products, in order */
    const float *coefficients;           /* (terms, numbers) */
    const double *free_coefficients;     /* (monomials, numbers): without a wrench */
} fingerfem_outline;

/* Variants of an element's law: by how much the pose of each deviates from the law's own, which is a sum of terms as an outline
 * is. The terms of product p of the wrench are starts[p] ... starts[p + 1] - 1. */
typedef struct {
    int32_t count, terms, products;
    int32_t most_power;                  /* highest of the wrench */
    const double *lower, *upper;         /* (6): the trained box of the wrench [N, N m] */
    const int32_t *wrench_powers;        /* (products, 6) */
    const int32_t *starts;               /* (products + 1) */
    const int32_t *term_monomials;       /* (terms): which of the segment's monomials */
    const float *coefficients;           /* (terms, count, FINGERFEM_POSE) */
} fingerfem_variants;

/* A segment: a rod of elements in series, from its plate to its clamp, of which several may share a law. */
typedef struct {
    int32_t tensions, combinations, monomials;
    const double *lower, *upper;         /* (tensions + 6): the box of tensions and of the plate's wrench [N, N m] */
    const double *tension_map;           /* (combinations, tensions) [-]: times the tensions, what polynomials are of */
    const double *combined_lower, *combined_upper; /* (combinations) [N]: scaled to [-1, 1] */
    const int32_t *most_powers;          /* (combinations): highest of every one */
    const int32_t *tension_powers;       /* (monomials, combinations) */
    int32_t elements, laws;
    const fingerfem_law *const *law;     /* (laws) */
    const int32_t *law_of;               /* (elements), from the plate to the clamp */
    const fingerfem_outline *const *outline; /* (laws), of the elements of each; NULL if nothing is known of the rubber */
    int32_t sixes;                       /* laws of shortenings for every law: of six tendons each; 0: not known */
    const fingerfem_law *const *shortening; /* (laws, sixes): how much shorter the segment's tendons, in the order of its
                                            tensions, are in an element [m]; the same products as its law, padded with zeros */
    int32_t deviating;                   /* number of variants that every law has; 0 if nothing is known of errors */
    const fingerfem_variants *const *variants; /* (laws) */
    int32_t knots;                    /* of the whole segment: where the rubber begins, those of its elements, its plate's
                                            face; 0 if nothing is known */
    int32_t places, near;                /* cross-sections of the rubber, evenly from the first knot to the last, each
                                            interpolated by some knots next to each other */
    const int32_t *first;                /* (places): the first of these */
    const double *between;               /* (places, near): their weights */
    const int32_t *place_elements;       /* (places - 1): of which element is the rubber from each to the next */
    const double *place_shares;          /* (places - 1): where its middle is, from the element's end, 0, to its begin, 1 */
    const double *element_lengths;       /* (elements): at rest [m] */
    const double *element_moduli;        /* (elements): of its material over that of the segment's rubber [-] */
    double half_lengths[3];              /* of the plate along its own axes, and so of its section's box [m] */
    int32_t vertices;                    /* of the outline of the plate's section, a convex polygon with a margin; 0: the outline is the box */
    const double *polygon;               /* (vertices, 2): along y and z, counterclockwise [m] */
    double margin;                       /* around the polygon [m] */
    double level;                        /* mean of y^2 - z^2 along the outline [m^2] */
    double depths[2];                    /* (12 I)^(1/4) of the plate's section, for bending towards y and z: side of a square that bends alike [m] */
    double begins;                       /* size of the section where the segment begins over that of the plate's [-] */
    double face_compliance, edge_compliance, line_compliance; /* of a slice: of a face's point, of an edge, and of the line across a face; 0: rigid [m/N] */
    const double *row_compliance, *opposite_compliance;         /* (places - 1): how far a unit force on a slice lowers the same face, and the opposite one, so many slices away [m/N] */
    const double *point_compliance;                             /* (places - 1): what that of the same face is less by, between points of the face [m/N] */
    double young_modulus, poisson;       /* of the rubber [Pa], [-] */
    const double *ridges;                /* (tensions, 2): height of the ridge above each tendon, over its tension and the curvature, for
                                            faces across y and across z; negative for the faces at -y and -z [1/Pa] */
    const double *bulges;                /* (tensions, 2): how high the highest pressure in a chamber lifts the middle of a face over it, at most,
                                            for faces across y and across z; negative for those at -y and -z; 0 of tendons [m] */
    int32_t corner_monomials;            /* of the tensions, the first ones, by which the plate is bent; 0: not known */
    const double *corner_coefficients;   /* (corner_monomials, FINGERFEM_CORNERS) */
} fingerfem_segment;

/* A rigid object at d = 0; at d it is moved by d along `direction`, away from the finger. */
typedef struct {
    int32_t shape;
    double centre[3];     /* of it; of a plane any point on it [m] */
    double direction[3];  /* unit vector */
    double axis[3];       /* of a plane its normal towards the finger, of a cylinder its axis; unit vectors */
    double radius;        /* of a sphere, a cylinder, or of what rounds a hull [m] */
    double half_length;   /* before rubber alone: of a cylinder with ends, and of the axis of a capsule, of which the ends are spheres [m]; else 0 */
    double nearest, farthest; /* of d [m] */
    /* A hull, seen from its centre: corners; edges with their ends, unit vectors along them, lengths and the faces at
     * their sides, of which the second is counterclockwise of the first about the edge; faces n . x = height, and the
     * triangles that they are made of, counterclockwise from outside. */
    int32_t corners, edges, faces, triangles;
    const double *vertices;          /* (corners, 3) [m] */
    const int32_t *ends;             /* (edges, 2) */
    const double *along;             /* (edges, 3) */
    const double *lengths;           /* (edges) [m] */
    const int32_t *sides;            /* (edges, 2) */
    const double *normals;           /* (faces, 3), outward */
    const double *heights;           /* (faces) [m] */
    const int32_t *triangle_corners; /* (triangles, 3) */
    const int32_t *triangle_faces;   /* (triangles) */
} fingerfem_object;

/* Friction of tendons in their guides: every element has its own tensions. Elements are counted segment by segment, each from its
 * plate to its clamp. See rod/guides.c for the law. */
typedef struct {
    const double *friction; /* (tensions): coefficients mu [-]; 0 of a tendon that runs straight */
    const double *drag;     /* (elements, tensions): friction besides that of turning, per length, times the element's length [N] */
    double *tensions;       /* (elements, tensions): in the middle of every element [N] */
    double *rates;          /* (elements, tensions, tensions): their derivatives by the tensions at the motors [-] */
    double *bends;          /* (elements): by how much each is bent [rad] */
    double *slips;          /* (elements, tensions): how far a tendon has moved through the end of an element towards the clamp [m] */
} fingerfem_guides;

/* Segments one after another, from clamp to tip. */
typedef struct {
    int32_t plates, tensions;
    const fingerfem_segment *const *segments;
    const int32_t *own;  /* (plates, tensions): which of the tensions are a segment's */
    const double *lower, *upper; /* (tensions): the box that all segments have in common [N, Pa] */
    double rest[3];      /* the tip plate's centre in the undeformed finger [m] */
    double gravity[3];   /* acceleration by weight, seen from the clamp [m/s^2]; zeros: nothing weighs */
    const double *masses;  /* of every segment: its plate's, then those of its elements, from the plate to the clamp [kg]; NULL: nothing weighs */
    const double *rubber;  /* likewise, lengths of rubber at rest: 0, then those of its elements [m] */
    const fingerfem_guides *guides; /* NULL: a tendon has the same tension in all elements */
    double surface_error;   /* [m] */
    /* An estimated error is a factor times the root of the sum of squares of what all variants change, and of a floor. */
    double tip_factor, force_factor, touch_factor; /* [-] */
    double place_floor, force_floor;               /* of the tip along any direction [m]; of a force, relative [-] */
    double turn_error, shortening_error;           /* of the tip's orientation [rad], and of shortenings [m] */
} fingerfem_chain;

/* Where to write what a finger reports besides an answer. Rows: the rotation of the tip plate's frame as a unit quaternion
 * w, x, y, z with w >= 0 [-], then how much shorter every tendon is between the clamp and its plate [m], NAN where that is
 * not known. The quaternion is continuous up to half a turn, where its sign changes. */
enum { FINGERFEM_QUATERNION = 4, FINGERFEM_REPORT_ERRORS = 2 };
typedef struct {
    double *rows;     /* (FINGERFEM_QUATERNION + tensions) */
    double *jacobian; /* (FINGERFEM_QUATERNION + tensions, tensions + count): by tensions and d, contact included */
    double *errors;   /* (FINGERFEM_REPORT_ERRORS): estimated, of the orientation [rad] and of shortenings [m] */
} fingerfem_report;

/* A chain that objects touch, as a model of tensions and of every object's d. */
typedef struct {
    const fingerfem_chain *chain;
    int32_t count;
    const fingerfem_object *const *objects; /* (count) */
} fingerfem_touching;

/* Numbers of a chain's loads: wrenches on the plates, (plates, 6), then on the sections where the other elements of each
 * segment begin, from its plate to its clamp, (..., 6), each in its body's own frame. */
int32_t fingerfem_chain_loads(const fingerfem_chain *chain);

/* Numbers of memory that functions of a segment, and of a chain, need: `memory`, which they spoil. */
int32_t fingerfem_segment_memory(const fingerfem_segment *segment);
int32_t fingerfem_chain_memory(const fingerfem_chain *chain);

/* Where the plate is, seen from the clamp: centre, (3) [m], and rotation, (3, 3), at tensions and a wrench, (6), and its
 * motion R^T dc, R^T dtheta by both, (6, tensions + 6). Beyond its box an element goes on linearly by its wrench, and stays
 * by the tensions; returns 1 if the inputs of all elements lie inside. */
int fingerfem_place(const fingerfem_segment *segment, const double *tensions, const double *wrench, double *memory,
                    double *centre, double *rotation, double *motion);

/* The wrench, (6), on the plate where its centre, (3) [m], and its quaternion, (4), are seen from the clamp: the
 * inverse, by Newton's method from the wrench given; and its stiffness, (6, 6), by motions R^T dc, R^T dtheta.
 * Returns the number of evaluations; negative if it found none: then the wrench is that of the nearest pose. */
int fingerfem_bear(const fingerfem_segment *segment, const double *tensions, const double *centre,
                   const double *quaternion, double *memory, double *wrench, double *stiffness, int32_t *inside);

/* The same as a spring between plate and clamp: force, (6), and stiffness, (6, 6), by motions along the clamp's axes and
 * turns about the plate's own. The stiffness is symmetric, without directions in which it would push the plate away: a
 * turn by one radian counts as the plate's half side there. */
void fingerfem_spring(const fingerfem_segment *segment, const double *quaternion, const double *wrench,
                      const double *stiffness, double *force, double *seen);

/* Where all plates of a chain are: centres, (plates, 3) [m], rotations, (plates, 3, 3), and motions by tensions and
 * wrenches on plates, (plates, 6, tensions + 6 plates), under loads, (fingerfem_chain_loads); returns 1 if every segment's inputs lie in its box. */
int fingerfem_chain_place(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                          double *centres, double *rotations, double *motions);

/* How much shorter the tendons of a chain are between the clamp and their plates, (tensions) [m], and the derivatives by
 * tensions and wrenches, (tensions, tensions + 6 plates). Inputs and the returned value as in `fingerfem_chain_place`. */
int fingerfem_chain_shortenings(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                                double *shortenings, double *changes);

/* The same shortenings where one force across the finger presses: at a position along its axis at rest, from the clamp [m], with the
 * components (2) along y and z of the cross-section there [N]. The derivatives are by tensions, position and both components,
 * (tensions, tensions + 3). Returns 1 if all inputs lie in their boxes and the position on the finger, on which it is clamped. */
int fingerfem_chain_point_force(const fingerfem_chain *chain, const double *tensions, double position, const double *force,
                                double *memory, double *shortenings, double *changes);

/* The distal sections of all elements, segment by segment, each from its plate to its clamp: places (elements, 3) [m] and
 * rotations, (elements, 3, 3), in space, and the wrenches that they transmit, in their own frames, (elements, 6). Inputs and
 * the returned value as in `fingerfem_chain_place`. */
int fingerfem_chain_elements(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                             double *places, double *rotations, double *transmitted);

/* Answer at a point, (tensions + count), of tensions and the d of every object: out, (3 + 2 count), its derivatives, (3 + 2 count,
 * tensions + count), and, unless it is NULL, by_object, (3 + 2 count, count, 6), by the place of every object and by its turning
 * about axes through its centre. The touch distance is that at which the object, coming along its direction alone, touches the
 * free finger first, a plate or the rubber. All objects come together. The loads are where the solve begins, and what it ends
 * with; zero begins without contact. Returns the number of evaluations of the map, negative without an equilibrium on the objects'
 * approach; inside is 1 if tensions, wrench and d lie where the map was trained and d may be, and the finger would rest
 * there; d = infinity is no object, and may always be. */
int fingerfem_touch(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                    double *jacobian, double *by_object, int32_t *inside);

/* An increment of a chain with guides: from the tensions and slips at the end of the last one, and those tensions at the motors, `motors`,
 * (tensions) [N], to the end of this one, all in place. At a point, (tensions + count): as of `fingerfem_touch`, but shortenings [m]
 * of the tendons that are `wound`, (tensions). The loads are where the solve begins and end; of a chain without objects they are given. Work,
 * (2) [J]: of the motors in the increment, and what friction took of it. Returns the number of steps; 0 if shortenings are not known,
 * negative if it found no equilibrium, and what it changes is of no use. Inside is 0 if a tension goes beyond its box. */
int fingerfem_guides_advance(const fingerfem_touching *touching, const double *point, const int32_t *wound, double *memory, double *loads,
                             double *motors, double *work, int32_t *inside);

/* Contacts that press: of which plate, or of the rubber of which segment, with which object, place [m] and normal in space, out of the object, and
 * the force along it on the finger [N]. */
typedef struct {
    int32_t count, plates[FINGERFEM_MOST_CONTACTS], rubber[FINGERFEM_MOST_CONTACTS], objects[FINGERFEM_MOST_CONTACTS];
    double places[FINGERFEM_MOST_CONTACTS][3], normals[FINGERFEM_MOST_CONTACTS][3], forces[FINGERFEM_MOST_CONTACTS];
} fingerfem_pressing;

/* These at a point, solved as by `fingerfem_touch`, of which the value is returned; none without an equilibrium. */
int fingerfem_touch_pressing(const fingerfem_touching *touching, const double *point, double *memory, double *loads,
                             fingerfem_pressing *pressing);

/* Bodies under loads, and their possible contacts with an object, for contact laws that are solved by the caller.
 * Of each body: the index of its load, and its motion R^T dc, R^T dtheta by the wrenches on all bodies, (6 bodies, 6 bodies).
 * Of each contact: the plate or slice of rubber (`parts`), its corner, edge or face (`names`), and the segment; the loaded bodies
 * (`on`), -1 for the ground; the gap [m]; how far each yields by a unit force on every one, (contacts, contacts) [m/N], of that by its own
 * slice (`local`), if all of it presses, and how the gap grows along the slice (`profiles`, see shapes/indentation.h); the material point, in the plate's frame [m] or in
 * coordinates of the slice [-]; the place in space [m]; the normal out of the object and two tangents; the wrenches of unit forces
 * along these on both bodies (`arms`); and the derivatives of these wrenches by the motions of both bodies (`changes`), where the tangents
 * rotate with the normal. */
typedef struct {
    int32_t inside, bodies, contacts, loads[FINGERFEM_MOST_BODIES];
    double centres[FINGERFEM_MOST_PLATES][3], rotations[FINGERFEM_MOST_PLATES][9]; /* of the plates */
    double motions[FINGERFEM_WRENCH * FINGERFEM_MOST_BODIES * FINGERFEM_WRENCH * FINGERFEM_MOST_BODIES];
    int32_t parts[FINGERFEM_MOST_CONTACTS], names[FINGERFEM_MOST_CONTACTS], segments[FINGERFEM_MOST_CONTACTS];
    int32_t rubber[FINGERFEM_MOST_CONTACTS], on[FINGERFEM_MOST_CONTACTS][2];
    double gaps[FINGERFEM_MOST_CONTACTS], compliances[FINGERFEM_MOST_CONTACTS * FINGERFEM_MOST_CONTACTS], material[FINGERFEM_MOST_CONTACTS][3];
    double local[FINGERFEM_MOST_CONTACTS], profiles[FINGERFEM_MOST_CONTACTS][8];
    double places[FINGERFEM_MOST_CONTACTS][3], axes[FINGERFEM_MOST_CONTACTS][3][3], arms[FINGERFEM_MOST_CONTACTS][3][12];
    double changes[FINGERFEM_MOST_CONTACTS][3][12][12];
} fingerfem_contacts;

/* These at tensions, of the first object at d that is moved by (3) [m] besides. Returns 0 if there are more bodies than there is room for. */
int fingerfem_find_contacts(const fingerfem_touching *touching, const double *tensions, double d, const double *moved,
                            const double *loads, double *memory, fingerfem_contacts *found);

/* The same contacts' gaps [m] and compliances by their own force [m/N], both (contacts), linearised about normal forces, (contacts) [N]. */
void fingerfem_indent(const fingerfem_contacts *contacts, const double *forces, double *gaps, double *compliances);

/* Where the material points of contacts are under other tensions and loads, (contacts, 3) [m]. */
void fingerfem_material_points(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                               const fingerfem_contacts *contacts, double *points);

/* Contacts of the rubber with one object, for the contact solver of a rigid-body engine, in the clamp's axes: slices of rubber (`parts`) and their
 * corners, edges or faces (`names`); the distal sections of their elements, numbered from clamp to tip; points [m]; the normal out of the
 * object and two tangents; gaps, and compliances, linearised about forces, by their own forces [m, m/N]; and the wrenches of unit forces along
 * these axes on the distal section, in its frame: the rest of the force is on the section before. */
typedef struct {
    int32_t count, unused; /* doubles follow */
    int32_t parts[FINGERFEM_MOST_CONTACTS], names[FINGERFEM_MOST_CONTACTS], sections[FINGERFEM_MOST_CONTACTS];
    double places[FINGERFEM_MOST_CONTACTS][3], axes[FINGERFEM_MOST_CONTACTS][3][3], gaps[FINGERFEM_MOST_CONTACTS], compliances[FINGERFEM_MOST_CONTACTS];
    double arms[FINGERFEM_MOST_CONTACTS][3][FINGERFEM_WRENCH];
    double forces[FINGERFEM_MOST_CONTACTS][3]; /* on the finger [N] */
} fingerfem_engine_contacts;

/* These at tensions, where the sections, from clamp to tip, have places, (sections, 3) [m], and rotations, (sections, 3, 3), in the clamp's axes,
 * and transmit wrenches, (sections, 6), in their own. `found` has the contacts of the step before, with their forces,
 * about which new ones are linearised: they get the forces of the same names. */
void fingerfem_engine_find(const fingerfem_chain *chain, const fingerfem_object *object, const double *tensions, const double *places,
                           const double *rotations, const double *wrenches, double *memory, fingerfem_engine_contacts *found);

/* Estimated errors of an answer at a point, (1 + 2 count) [m, N, m], as of `fingerfem_evaluate`; the loads are where the solve begins, and
 * what it ends with. */
void fingerfem_touch_errors(const fingerfem_touching *touching, const double *point, double *memory, double *loads,
                            double *errors);

/* Least distance of the rubber, but for the slices next to plates, from the first object under loads [m]; infinite without it,
 * and where nothing is known of it. */
double fingerfem_rubber_gap(const fingerfem_touching *touching, const double *point, const double *loads, double *memory);

/* The surface of a chain under tensions and loads, as sections with four corners each, -y -z, -y z, y -z and
 * y z: of every segment its `places`, the first where its rubber begins, the last its plate's back, and its plate's front,
 * (sections, 4, 3) [m]. Returns 0 where nothing is known of a segment's rubber. */
int fingerfem_chain_sections(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                             double *corners);

/* Mass of plates and sections, in the order of `fingerfem_chain_loads`: masses, (bodies) [kg], first moments, (bodies, 3) [kg m], and
 * moments of inertia, (bodies, 3, 3) [kg m^2], both about its centre in its own frame. The symmetric
 * mass matrices of the elements, (bodies, 12, 12), add to both bodies of each: by their motions in the frame between them. */
typedef struct {
    int32_t count;
    const double *moduli, *times; /* (count): over the law's own shear modulus [-], and relaxation times [s] */
    double bulk;                  /* the shear modulus over three times the bulk's [-] */
} fingerfem_branches;

typedef struct {
    const double *masses, *moments, *inertias, *elements;
    const fingerfem_branches *branches; /* of viscoelastic rubber; NULL: it is elastic */
    double radius; /* spectral radius of the method for high frequencies, 0 to 1 [-]; 1 keeps them, less damps them */
    int32_t rests; /* whether steps have no inertia and end at rest; in a step of infinite length all branches relax */
} fingerfem_inertia;

/* How each of them moves, (bodies, FINGERFEM_MOVING): centre [m] and rotation, in space; velocity of the centre in
 * space [m/s], with that of the turn in its own frame [rad/s] behind it; likewise the wrench of elements on it [N, N m]; and the method's mean acceleration. */
enum { FINGERFEM_MOVING = 30 };

/* A base that moves, seen in its own axes: weight less the acceleration of the clamp [m/s^2], the angular velocity and its rate. */
enum { FINGERFEM_BASE = 9 };

enum { FINGERFEM_MOST_BRANCHES = 8 };

/* Contacts that press as a step of time ends, with which the next one begins: of which plate or slice of rubber, by which name and with which object;
 * forces [N]. */
typedef struct {
    int32_t count, parts[FINGERFEM_MOST_CONTACTS], names[FINGERFEM_MOST_CONTACTS], objects[FINGERFEM_MOST_CONTACTS], unused; /* doubles follow */
    double forces[FINGERFEM_MOST_CONTACTS];
} fingerfem_pressed;

/* A step of time, `length` [s], to tensions and the d of every object, (tensions + count), and the base's motion, (FINGERFEM_BASE), or NULL
 * if it rests, at the step's end: `moving` is where it begins and what it ends with, both seen from the base, as are the loads on all bodies,
 * contacts' and inertia's, what presses, and, with branches, what relaxes of all loads, (1 + branches, 6 elements + tensions) [N, N m], where a
 * chain with guides has the tensions of all elements; it also gets their slips and bends at the step's end. Takes the mean
 * force of every object, (count) [N], along its direction, and the kinetic energy [J]. Returns the number of evaluations of the map, negative without an answer: then
 * `moving`, loads and what presses stay; `inside` is as that of `fingerfem_touch`. */
int fingerfem_step(const fingerfem_touching *touching, const fingerfem_inertia *inertia, const double *point, const double *base,
                   double length, double *memory, double *moving, double *relaxing, double *loads, double *forces, double *energy,
                   int32_t *inside, fingerfem_pressed *pressed);

/* Mass matrix, and motions by wrenches, of all bodies in their own frames, (6 bodies, 6 bodies), from the clamp to the tip, about the
 * equilibrium at a point, (tensions + count), of which the loads are those of `fingerfem_touch`; contacts that press stay closed. Returns 0
 * if there are more bodies than there is room for, or no equilibrium. */
int fingerfem_linearise(const fingerfem_touching *touching, const fingerfem_inertia *inertia, const double *point, const double *loads,
                        double *memory, double *mass, double *compliance);

/* An answer with its errors: that of `fingerfem_touch`; errors, (1 + 2 count) [m, N, m], are the estimated ones of the tip, the forces and the touch
 * distances: infinite without an equilibrium. The report is computed unless it is NULL. */
int fingerfem_evaluate(const fingerfem_touching *touching, const double *point, double *memory, double *loads, double *out,
                   double *jacobian, double *errors, int32_t *inside, const fingerfem_report *report);

/* The same at many points, each from rest; all arrays have their number, `count`, as their first axis. */
void fingerfem_evaluate_many(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                     double *errors, int32_t *inside, const fingerfem_report *reports);

/* Answers at many points, `count`, with their derivatives, of which by_objects may be NULL, loads where they begin and end, inside
 * and evaluations. */
void fingerfem_touches(const fingerfem_touching *touching, int count, const double *points, double *memory, double *out,
                       double *jacobians, double *by_objects, double *loads, int32_t *inside,
                       int32_t *evaluations);
#endif
