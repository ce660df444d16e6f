/* The loops of the caster, compiled.
 *
 * Takes: the arrays of a scene, what an area lists, and rays. Gives: distance and thing for each ray.
 * Leaves alone: memory (nothing is allocated), and which areas there are.
 *
 * Every distance is computed by the same operations in the same order as in raycast.py, so that both give the same
 * bits; culls differ and may, since they only leave out rays that pass by. A pseudo-angle stands for the angle there:
 * it grows with it and costs one division.
 */

#include <float.h>
#include <math.h>
#include <stdint.h>

#if FLT_EVAL_METHOD != 0
#error "distances must be rounded to double at every step"
#endif

#define BUCKETS 1024

struct scene {
    const double *x, *y, *radius, *height;
    double *ax, *ay, *bx, *by;
    const double *own_ax, *own_ay, *own_bx, *own_by;
    const int64_t *edge_thing;
};

struct area {
    double x, y;
    const int64_t *still_discs, *moving_discs, *still_edges, *moving_edges, *near;
    int64_t still_disc_count, moving_disc_count, still_edge_count, moving_edge_count, near_count, doubtful_count;
    const int64_t *doubtful, *column, *wound;
    const uint8_t *left;
    int64_t *winding;
};

/* order: rays by buckets, four turns of them. before[b + 1]: where in it bucket b begins, for b from -1 (the last bucket
 * of the turn before) to 2 * BUCKETS + 2. */
struct fan {
    int64_t count;
    const double *cos, *sin;
    const int64_t *order, *before;
};

struct rays {
    int64_t count;
    const double *x, *y, *dx, *dy, *height;
    double middle_x, middle_y, spread;
};

struct found {
    double *range;
    int64_t *thing;
};

static inline void meet(const struct found *found, int64_t ray, double at, int64_t thing)
{
    if (at < found->range[ray] || (at == found->range[ray] && thing < found->thing[ray])) {
        found->range[ray] = at;
        found->thing[ray] = thing;
    }
}

static inline void try_disc(const struct found *found, int64_t ray, double dx, double dy, double x, double y,
                            double radius, int64_t thing)
{
    const double along = dx * x + dy * y, across = fabs(dx * y - dy * x);
    if (across <= radius && (along > 0 || x * x + y * y < radius * radius)) {
        const double square = (radius - across) * (radius + across);
        const double half = sqrt(square >= 0 ? square : 0.0);
        const double enter = along - half;
        meet(found, ray, enter > 0 ? enter : 0.0, thing);
    }
}

static inline void try_edge(const struct found *found, int64_t ray, double dx, double dy, double ax, double ay,
                            double bx, double by, int64_t thing)
{
    const double a = dx * ay - dy * ax, b = dx * by - dy * bx;
    if (a >= 0 && b <= 0 && a > b) {
        const double along_a = dx * ax + dy * ay, along_b = dx * bx + dy * by;
        const double at = along_a + (along_b - along_a) * (a / (a - b));
        meet(found, ray, at > 0 ? at : 0.0, thing);
    }
}

/* Edges from the body frame to the world, for a thing at (x, y) whose heading has cosine c and sine s. */
void rplan_place(const struct scene *scene, int64_t first, int64_t last, double x, double y, double c, double s)
{
    int64_t e;
    for (e = first; e < last; e++) {
        const double ax = scene->own_ax[e], ay = scene->own_ay[e], bx = scene->own_bx[e], by = scene->own_by[e];
        scene->ax[e] = x + (c * ax - s * ay);
        scene->ay[e] = y + (s * ax + c * ay);
        scene->bx[e] = x + (c * bx - s * by);
        scene->by[e] = y + (s * bx + c * by);
    }
}

/* --- intervals of angles ------------------------------------------------------------------------------- */

static inline int64_t bucket(double x, double y)
{
    const double part = y / (fabs(x) + fabs(y));
    const double turn = x >= 0 ? (part >= 0 ? part : 4 + part) : 2 - part;
    const double at = turn * (BUCKETS / 4);
    if (!(at > 0))
        return 0;
    return at < BUCKETS ? (int64_t) at : BUCKETS - 1;
}

struct run {
    int64_t first, number;
};

static inline struct run between(const int64_t *before, int64_t count, int64_t low, int64_t high)
{
    struct run run;
    if (high < low)
        high += BUCKETS;
    run.first = before[low];
    run.number = before[high + 3] - run.first;
    if (run.number > count)
        run.number = count;
    return run;
}

/* Rays that a disc at (x, y) from the middle may meet. */
static inline struct run beside(const int64_t *before, int64_t count, double x, double y, double radius, double square)
{
    const struct run all = {0, count};
    const double rest = square - radius * radius;
    double side;
    if (!(rest > 1e-9 * square))
        return all;
    side = sqrt(rest);
    return between(before, count, bucket(x * side + y * radius, y * side - x * radius),
                   bucket(x * side - y * radius, y * side + x * radius));
}

/* --- starts inside things ------------------------------------------------------------------------------ */

static inline int inside(const struct scene *scene, const struct area *area, double x, double y, double height,
                         int64_t *thing)
{
    const double ux = x - area->x, uy = y - area->y;
    int64_t k, winding = 0;
    int found = 0, on_rim = 0;
    for (k = 0; k < area->doubtful_count; k++)
        area->winding[k] = area->wound[k];
    for (k = 0; k < area->near_count; k++) {
        const int64_t e = area->near[k];
        const double ax = scene->ax[e], ay = scene->ay[e], bx = scene->bx[e], by = scene->by[e];
        const int left = (ax - x) * (by - y) - (bx - x) * (ay - y) > 0;
        if (left != area->left[k]
            && (ux * (ay - area->y) - uy * (ax - area->x) >= 0) != (ux * (by - area->y) - uy * (bx - area->x) >= 0))
            area->winding[area->column[k]] += left ? 1 : -1;
    }
    for (k = area->doubtful_count - 1; k >= 0; k--)
        if (area->winding[k] > 0 && height < scene->height[area->doubtful[k]]) {
            *thing = area->doubtful[k];
            found = 1;
        }
    for (k = 0; k < area->moving_edge_count; k++) {
        const int64_t e = area->moving_edges[k], of = scene->edge_thing[e];
        const double ax = scene->ax[e], ay = scene->ay[e], bx = scene->bx[e], by = scene->by[e];
        const double side = (ax - x) * (by - y) - (bx - x) * (ay - y);
        if ((ay <= y) != (by <= y) && (ay <= y ? side > 0 : side < 0))
            winding += ay <= y ? 1 : -1;
        if (side == 0 && fmin(ax, bx) <= x && x <= fmax(ax, bx) && fmin(ay, by) <= y && y <= fmax(ay, by))
            on_rim = 1;
        if (k + 1 == area->moving_edge_count || scene->edge_thing[area->moving_edges[k + 1]] != of) {
            if (winding > 0 && !on_rim && height < scene->height[of] && (!found || of < *thing)) {
                *thing = of;
                found = 1;
            }
            winding = 0;
            on_rim = 0;
        }
    }
    return found;
}

/* --- rays from one origin ------------------------------------------------------------------------------ */

static void sweep_discs(const struct scene *scene, const int64_t *discs, int64_t number, const struct fan *fan,
                        double x, double y, double c, double s, double max_range, const double *dx, const double *dy,
                        const struct found *found)
{
    int64_t k, j;
    for (k = 0; k < number; k++) {
        const int64_t i = discs[k];
        const double to_x = scene->x[i] - x, to_y = scene->y[i] - y, radius = scene->radius[i];
        const double square = to_x * to_x + to_y * to_y, far = max_range + radius;
        struct run run;
        if (square > far * far * (1 + 1e-9))
            continue;
        run = beside(fan->before, fan->count, to_x * c + to_y * s, to_y * c - to_x * s, radius, square);
        for (j = run.first; j < run.first + run.number; j++) {
            const int64_t ray = fan->order[j];
            try_disc(found, ray, dx[ray], dy[ray], to_x, to_y, radius, i);
        }
    }
}

static void sweep_edges(const struct scene *scene, const int64_t *edges, int64_t number, const struct fan *fan,
                        double x, double y, double c, double s, double max_range, const double *dx, const double *dy,
                        const struct found *found)
{
    const double far = max_range * max_range * (1 + 1e-6);
    int64_t k, j;
    for (k = 0; k < number; k++) {
        const int64_t e = edges[k];
        const double ax = scene->ax[e] - x, ay = scene->ay[e] - y, bx = scene->bx[e] - x, by = scene->by[e] - y;
        const double area = ax * by - bx * ay, ex = bx - ax, ey = by - ay;
        struct run run;
        if (!(area <= 0) || area * area > far * (ex * ex + ey * ey))
            continue;
        if (area < 0) {
            run = between(fan->before, fan->count, bucket(bx * c + by * s, by * c - bx * s),
                          bucket(ax * c + ay * s, ay * c - ax * s));
        } else {
            run.first = 0;
            run.number = fan->count;
        }
        for (j = run.first; j < run.first + run.number; j++) {
            const int64_t ray = fan->order[j];
            try_edge(found, ray, dx[ray], dy[ray], ax, ay, bx, by, scene->edge_thing[e]);
        }
    }
}

static void begin(const struct found *found, int64_t count, double max_range)
{
    int64_t k;
    for (k = 0; k < count; k++) {
        found->range[k] = max_range;
        found->thing[k] = INT64_MAX;
    }
}

static void finish(const struct found *found, int64_t count)
{
    int64_t k;
    for (k = 0; k < count; k++)
        if (found->thing[k] == INT64_MAX)
            found->thing[k] = -1;
}

/* c, s: of the heading of the fan. directions: room for twice as many numbers as rays. */
void rplan_sweep(const struct scene *scene, const struct area *area, const struct fan *fan, double x, double y,
                 double c, double s, double max_range, double *directions, double *range, int64_t *thing)
{
    const struct found found = {range, thing};
    double *dx = directions, *dy = directions + fan->count;
    int64_t k, within = 0;
    for (k = 0; k < fan->count; k++) {
        dx[k] = fan->cos[k] * c - fan->sin[k] * s;
        dy[k] = fan->sin[k] * c + fan->cos[k] * s;
    }
    begin(&found, fan->count, max_range);
    sweep_discs(scene, area->still_discs, area->still_disc_count, fan, x, y, c, s, max_range, dx, dy, &found);
    sweep_discs(scene, area->moving_discs, area->moving_disc_count, fan, x, y, c, s, max_range, dx, dy, &found);
    sweep_edges(scene, area->still_edges, area->still_edge_count, fan, x, y, c, s, max_range, dx, dy, &found);
    sweep_edges(scene, area->moving_edges, area->moving_edge_count, fan, x, y, c, s, max_range, dx, dy, &found);
    if (inside(scene, area, x, y, -INFINITY, &within))
        for (k = 0; k < fan->count; k++)
            meet(&found, k, 0.0, within);
    finish(&found, fan->count);
}

/* --- any rays ------------------------------------------------------------------------------------------ */

/* Sorts rays by buckets into `order` (room for four turns of them) and fills `before`, as a fan has them. */
static void sort_rays(const struct rays *rays, int64_t *order, int64_t *before)
{
    const int64_t count = rays->count;
    int64_t k, b, last, sum = 0;
    for (b = 0; b < BUCKETS; b++)
        before[b] = 0;
    for (k = 0; k < count; k++)
        before[bucket(rays->dx[k], rays->dy[k])]++;
    for (b = 0; b < BUCKETS; b++) {
        const int64_t here = before[b];
        before[b] = sum;
        sum += here;
    }
    for (k = 0; k < count; k++)
        order[before[bucket(rays->dx[k], rays->dy[k])]++] = k;
    for (k = count; k < 4 * count; k++)
        order[k] = order[k - count];
    /* here before[b] is how many come before bucket b + 1 */
    last = before[BUCKETS - 2];
    for (b = 2 * BUCKETS + 2; b >= 0; b--)
        before[b + 1] = (b % BUCKETS ? before[b % BUCKETS - 1] : 0) + count * (1 + b / BUCKETS);
    before[0] = last;
}

static void cast_discs(const struct scene *scene, const int64_t *discs, int64_t number, const struct rays *rays,
                       double max_range, const int64_t *order, const int64_t *before, const struct found *found)
{
    int64_t k, j;
    for (k = 0; k < number; k++) {
        const int64_t i = discs[k];
        const double to_x = scene->x[i] - rays->middle_x, to_y = scene->y[i] - rays->middle_y;
        const double square = to_x * to_x + to_y * to_y, size = scene->radius[i] + rays->spread;
        const double far = max_range + size;
        struct run run;
        if (square > far * far * (1 + 1e-9))
            continue;
        run = beside(before, rays->count, to_x, to_y, size, square);
        for (j = run.first; j < run.first + run.number; j++) {
            const int64_t ray = order[j];
            if (rays->height[ray] < scene->height[i])
                try_disc(found, ray, rays->dx[ray], rays->dy[ray], scene->x[i] - rays->x[ray],
                         scene->y[i] - rays->y[ray], scene->radius[i], i);
        }
    }
}

static void cast_edges(const struct scene *scene, const int64_t *edges, int64_t number, const struct rays *rays,
                       double max_range, const int64_t *order, const int64_t *before, const struct found *found)
{
    int64_t k, j;
    for (k = 0; k < number; k++) {
        const int64_t e = edges[k], thing = scene->edge_thing[e];
        const double ex = scene->bx[e] - scene->ax[e], ey = scene->by[e] - scene->ay[e];
        const double to_x = scene->ax[e] + ex / 2 - rays->middle_x, to_y = scene->ay[e] + ey / 2 - rays->middle_y;
        const double square = to_x * to_x + to_y * to_y, size = sqrt(ex * ex + ey * ey) / 2 + rays->spread;
        const double far = max_range + size;
        struct run run;
        if (square > far * far * (1 + 1e-9))
            continue;
        run = beside(before, rays->count, to_x, to_y, size, square);
        for (j = run.first; j < run.first + run.number; j++) {
            const int64_t ray = order[j];
            const double ax = scene->ax[e] - rays->x[ray], ay = scene->ay[e] - rays->y[ray];
            const double bx = scene->bx[e] - rays->x[ray], by = scene->by[e] - rays->y[ray];
            if (ax * by - bx * ay <= 0 && rays->height[ray] < scene->height[thing])
                try_edge(found, ray, rays->dx[ray], rays->dy[ray], ax, ay, bx, by, thing);
        }
    }
}

void rplan_cast(const struct scene *scene, const struct area *area, const struct rays *rays, double max_range,
                int64_t *order, int64_t *before, double *range, int64_t *thing)
{
    const struct found found = {range, thing};
    int64_t k, within = 0;
    int is_inside = 0;
    sort_rays(rays, order, before);
    begin(&found, rays->count, max_range);
    cast_discs(scene, area->still_discs, area->still_disc_count, rays, max_range, order, before, &found);
    cast_discs(scene, area->moving_discs, area->moving_disc_count, rays, max_range, order, before, &found);
    cast_edges(scene, area->still_edges, area->still_edge_count, rays, max_range, order, before, &found);
    cast_edges(scene, area->moving_edges, area->moving_edge_count, rays, max_range, order, before, &found);
    for (k = 0; k < rays->count; k++) {
        if (k == 0 || rays->x[k] != rays->x[k - 1] || rays->y[k] != rays->y[k - 1]
            || rays->height[k] != rays->height[k - 1])
            is_inside = inside(scene, area, rays->x[k], rays->y[k], rays->height[k], &within);
        if (is_inside)
            meet(&found, k, 0.0, within);
    }
    finish(&found, rays->count);
}
