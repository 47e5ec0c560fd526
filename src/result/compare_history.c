#include "result/compare_history.h"

#include <math.h>

static const double pulse_begins = 0.05, pulse_ends = 0.03; // of the largest |V|
static const double same_height = 0.1;                      // share by which two pulses differ
static const double near_edge = 0.2; // of the shortest time between two edges: the same edge
static const double rounding_s = 1e-6;

struct edge {
  double time_s, height_V;
  double width_s; // between the samples that it lies between
};

struct edges {
  size_t count;
  struct edge edge[DEA_CLOCK_EDGES_MAX];
};

/* Where |V| first reaches half of the height of the pulse of the samples [from, to). */
static double half_way(const struct dea_samples *track, size_t from, size_t to, double height_V,
                       double *width_s)
{
  const double *v = track->value, *t = track->at;
  size_t i = from;
  while (i < to && !(fabs(v[i]) >= 0.5 * height_V)) {
    i++;
  }
  *width_s = i > 0 && i < track->count ? t[i] - t[i - 1] : 0.0;
  if (i == 0 || i == to || isnan(v[i - 1])) {
    return t[i < to ? i : from];
  }
  double low = fabs(v[i - 1]), high = fabs(v[i]);
  double share = high > low ? (0.5 * height_V - low) / (high - low) : 1.0;
  return t[i - 1] + fmin(fmax(share, 0.0), 1.0) * (t[i] - t[i - 1]);
}

static void add_pulse(const struct dea_samples *track, size_t from, size_t to, double height_V,
                      struct edges *out)
{
  if (out->count < DEA_CLOCK_EDGES_MAX) {
    struct edge *edge = &out->edge[out->count++];
    edge->height_V = height_V;
    edge->time_s = half_way(track, from, to, height_V, &edge->width_s);
  }
}

static void find_edges(const struct dea_samples *track, struct edges *out)
{
  double largest = 0.0, height = 0.0;
  size_t from = 0;
  bool inside = false;
  out->count = 0;
  for (size_t i = 0; i < track->count; i++) {
    largest = fmax(largest, fabs(track->value[i]));
  }
  for (size_t i = 0; i < track->count && largest > 0.0; i++) {
    double v = fabs(track->value[i]);
    if (!inside && v > pulse_begins * largest) {
      inside = true;
      from = i;
      height = v;
    } else if (inside && v < pulse_ends * largest) {
      inside = false;
      add_pulse(track, from, i, height, out);
    }
    height = inside ? fmax(height, v) : height;
  }
  if (inside) {
    add_pulse(track, from, track->count, height, out);
  }
}

static double shortest_between(const struct edges *edges)
{
  double shortest = INFINITY;
  for (size_t i = 1; i < edges->count; i++) {
    shortest = fmin(shortest, edges->edge[i].time_s - edges->edge[i - 1].time_s);
  }
  return shortest;
}

/* How far an edge may be from where it was seen, on average. */
static double mean_width(const struct edges *edges)
{
  double sum = 0.0;
  for (size_t i = 0; i < edges->count; i++) {
    sum += edges->edge[i].width_s;
  }
  return edges->count > 0 ? sum / (double)edges->count : 0.0;
}

/* Edges that lie on each other when those of a are moved by shift_s, and the shift that leaves no
 * mean difference of them. */
static struct dea_clock_shift match(const struct edges *a, const struct edges *b, double shift_s,
                                    double near_s)
{
  struct dea_clock_shift out = {.shift_s = shift_s};
  double sum = 0.0;
  for (size_t i = 0, k = 0; i < a->count; i++) {
    double at = a->edge[i].time_s + shift_s;
    while (k < b->count && b->edge[k].time_s < at - near_s) {
      k++;
    }
    if (k == b->count || b->edge[k].time_s > at + near_s) {
      continue;
    }
    double off = b->edge[k].time_s - at, height = fmax(a->edge[i].height_V, b->edge[k].height_V);
    if (fabs(a->edge[i].height_V - b->edge[k].height_V) <= same_height * height) {
      out.edges++;
      sum += off;
    }
  }
  out.shift_s += out.edges > 0 ? sum / (double)out.edges : 0.0;
  return out;
}

void dea_clock_shift_find(const struct dea_samples *a, const struct dea_samples *b,
                          struct dea_clock_shift *out)
{
  struct edges of_a, of_b;
  find_edges(a, &of_a);
  find_edges(b, &of_b);
  double apart = fmin(shortest_between(&of_a), shortest_between(&of_b));
  double near_s = isfinite(apart) ? near_edge * apart : rounding_s;
  *out = (struct dea_clock_shift){0};
  for (size_t i = 0; i < of_a.count; i++) {
    for (size_t k = 0; k < of_b.count; k++) {
      double shift_s = of_b.edge[k].time_s - of_a.edge[i].time_s;
      struct dea_clock_shift one = match(&of_a, &of_b, shift_s, near_s);
      bool nearer = one.edges == out->edges && fabs(one.shift_s) < fabs(out->shift_s);
      if (one.edges > out->edges || (one.edges > 0 && nearer)) {
        *out = one;
      }
    }
  }
  out->resolution_s = mean_width(&of_a) + mean_width(&of_b);
  if (fabs(out->shift_s) <= out->resolution_s) { // one clock, as far as is seen
    out->shift_s = 0;
  }
}
