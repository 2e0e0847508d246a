/* Motion of a plate by the variants of its rod's elements: all deviate at once, each at the wrench through it. */
#include "rod_follow.h"

enum { POSE = FINGERFEM_POSE, W = ROD_WRENCH };

/* Elements of one law share its contraction, or without a wrench the deviations, unless their tensions differ. */
void rod_deviate(const rod_state *rod, int pressed)
{
    static const double none[W] = {0.0};
    const fingerfem_segment *segment = rod->segment;
    const int row = POSE * segment->deviating;
    for (int law = 0; law < segment->laws; law++) {
        const fingerfem_variants *own = segment->variants[law];
        int first = -1;
        for (int k = 0; k < segment->elements; k++) {
            double *found = rod->deviations + row * k;
            if (segment->law_of[k] != law) continue;
            if (rod->guided || (first < 0 && !pressed)) {
                variants_at(own, rod_monomials(rod, k), pressed ? rod->elements[k].wrench : none, rod->work, found);
            } else if (pressed) {
                /* the first element of a law contracts it by the tensions */
                if (first < 0) variants_contract(own, rod_monomials(rod, k), rod->work);
                variants_under(own, rod->elements[k].wrench, rod->work, found);
            } else memcpy(found, rod->deviations + row * first, (size_t)row * sizeof *found);
            first = first < 0 ? k : first;
        }
    }
}

void rod_by_variants(const rod_state *rod, rod_part part, int pressed, double (*by_variants)[TENSIONS_MOST])
{
    const int count = rod->segment->deviating;
    follow_motion moved[WIDE_EIGHT] = {{{{0.0}}, {{0.0}}}};
    double end[3];
    /* deviations of all elements, once: the plate's part is evaluated first */
    if (!part.first) rod_deviate(rod, pressed);
    for (int k = part.first; k < part.last; k++) {
        const rod_element *element = rod->elements + k;
        const double *own = rod->deviations + POSE * count * k;
        /* motion of the proximal section; under a wrench also through the changes of the wrench */
        if (pressed) follow_changes(element, rod->elements[part.first].wrench, count, own, moved);
        for (int j = 0; WIDE * j < count && !pressed; j++) {
            wide change[W] = {{0.0}};
            follow_by_inputs(count, own, WIDE * j, change);
            follow_move(element, change, moved + j);
        }
    }
    /* motion of the body seen from the end of its part, by the variants */
    follow_clamp(rod, part, end);
    for (int j = 0; WIDE * j < count; j++) follow_from_clamp(end, moved + j, by_variants[0] + WIDE * j);
}
