/* Where the sections and plates of a chain are under loads. */
#include "chain.h"

void chain_section(const chain_rods *map, const chain_state *state, int segment, int element, double *place, double *rotation)
{
    const rod_element *own = map->rods[segment].elements + element;
    /* the body whose part contains the element */
    int b = chain_plate_of(map, segment);
    while (map->bodies[b].part.last <= element) b--;
    const chain_body *body = state->bodies + b;
    /* p = c_b + R_b p_k, Q = R_b Q_k, with the element's p_k, Q_k seen from that body */
    for (int i = 0; i < 3; i++) {
        const double *row = body->rotation + 3 * i, *Q = own->rotation;
        place[i] = body->centre[i] + row[0] * own->place[0] + row[1] * own->place[1] + row[2] * own->place[2];
        for (int j = 0; j < 3; j++) rotation[3 * i + j] = row[0] * Q[j] + row[1] * Q[3 + j] + row[2] * Q[6 + j];
    }
}

int chain_placed(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory, double *held,
                 chain_rods *map, chain_state *state)
{
    double wrench[CHAIN_WRENCH];
    /* rods at the tensions within their box */
    int inside = chain_clamped(chain, tensions, held);
    chain_set_tensions(chain, held, memory, map);
    chain_contract(map);
    /* bodies under the loads, motions by wrenches and by tensions */
    inside &= chain_take_loads(map, loads, wrench);
    inside &= chain_under(map, wrench, state);
    chain_by_tensions(map, state);
    for (int b = 0; b < map->count; b++) inside &= state->bodies[b].end.inside;
    return inside;
}

int fingerfem_chain_place(const fingerfem_chain *chain, const double *tensions, const double *loads, double *memory,
                          double *centres, double *rotations, double *motions)
{
    const int n = chain->plates, t = chain->tensions, columns = t + W * n;
    double held[TENSIONS_MOST];
    chain_rods map;
    chain_state state;
    const int inside = chain_placed(chain, tensions, loads, memory, held, &map, &state), w = chain_size(&map);
    for (int k = 0; k < n; k++) {
        /* pose of plate k in space */
        const chain_body *plate = state.bodies + chain_plate_of(&map, k);
        memcpy(centres + 3 * k, plate->centre, sizeof plate->centre);
        memcpy(rotations + 9 * k, plate->rotation, sizeof plate->rotation);
        /* rows of its motion: by tensions, 0 where these are clamped, then by wrenches on plates */
        for (int i = 0; i < W; i++) {
            double *row = motions + columns * (W * k + i);
            for (int c = 0; c < t; c++) row[c] = held[c] == tensions[c] ? plate->motion[i][w + c] : 0.0;
            for (int j = 0; j < n; j++) memcpy(row + t + W * j, plate->motion[i] + W * chain_plate_of(&map, j), W * sizeof *row);
        }
    }
    return inside;
}
