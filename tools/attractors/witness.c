/* Brute force, apart from the package: a mass with dry friction in a shaken cavity, from random starts to what recurs.

   Flights are closed forms; between zeros of w'' the velocity w' is monotone and between its zeros w is, so no event is missed (in the
   moving cavity zeros of w'' are looked for on a grid of a hundredth of a period). Read from standard input: "model starts seed", then a line
   of numbers per machine. Model 0, cavity shaken as C sin(psi): C r_left r_right a_left a_right b Omega left right rate, for
   w'' = -C Omega^2 sin(psi) - b - s a_s, -right <= w <= left. Model 1, moving cavity: chi G Omega lambda eps r mu g rate reach, chi = 1 with the
   damper between base and oscillator. Starts: all phases, all of the cavity, w' within +-rate, v and v' within +-reach.
   Arguments: forcing periods of the first transient, difference that counts as a return, how many transients (each four times longer). */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define PI M_PI
#define LONGEST 24 /* forcing periods of a recurrence */
#define KINDS 400  /* attractors at one value */
#define HITS 400   /* impacts of a cycle that are told */
#define PATIENCE 20000 /* forcing periods for which a motion that returns nearly is watched */
#define LEFT 1e-6      /* difference from the last return of a motion that has left where it seemed to settle */
#define FULL 6     /* starts that do not recur and are given all transients; later ones are given two */

static int model;
static double chi, C, rl, rr, al, ar, slope, Om, left, right, G, lam, eps, mu, g;
static double slide_sin, slide_cos, stick_sin, stick_cos, slide_rate, slide_decay, stick_rate, stick_decay;

typedef struct { double psi, w, dw, v, dv; int mode, hits, events; } State;
typedef struct { double psi0, w0, dw0, sin0, cos0, A, B, force, q2, dq2; int mode; } Flight;
typedef struct { double psi, B; int wall; } Hit;
typedef struct { int periods, hits, events, free, count, mirrored, told; State own[LONGEST], image[LONGEST]; Hit hit[HITS]; } Kind;

static Kind kinds[KINDS];
static Hit *record;
static int recorded;
static uint64_t random_state;

static double uniform(void) {
  random_state ^= random_state >> 12, random_state ^= random_state << 25, random_state ^= random_state >> 27;
  return ((random_state * 2685821657736338717ULL) >> 11) * (1.0 / 9007199254740992.0);
}

/* the oscillator of mass m, pushed by eps G (sin + chi eps lambda Omega cos), and its own motion */
static void respond(double m, double *s, double *c, double *rate, double *decay) {
  double f = eps * G, d = eps * lam * Om, k = 1 - m * Om * Om, h = f * chi * d, size = k * k + d * d;
  *s = (f * k + h * d) / size, *c = (k * h - f * d) / size;
  *decay = eps * lam / (2 * m), *rate = sqrt(1 / m - *decay * *decay);
}

static void prepare(void) {
  if (model == 0) return;
  left = right = 1;
  respond(1, &slide_sin, &slide_cos, &slide_rate, &slide_decay);
  respond(1 + eps, &stick_sin, &stick_cos, &stick_rate, &stick_decay);
}

static double pull(int mode) { return mode > 0 ? al : -ar; }

static Flight depart(const State *s) {
  Flight f = {.psi0 = s->psi, .w0 = s->w, .dw0 = s->dw, .sin0 = sin(s->psi), .cos0 = cos(s->psi), .mode = s->mode};
  if (model == 0) return f;
  int slides = s->mode != 0;
  double X = slides ? slide_cos : stick_cos, Y = slides ? slide_sin : stick_sin;
  double rate = slides ? slide_rate : stick_rate, decay = slides ? slide_decay : stick_decay;
  double q1 = (s->v + eps * s->w) / (1 + eps), d1 = (s->dv + eps * s->dw) / (1 + eps);
  f.q2 = (s->v - s->w) / (1 + eps), f.dq2 = (s->dv - s->dw) / (1 + eps);
  f.force = -eps * mu * g * s->mode;
  f.A = q1 - (X * f.cos0 + Y * f.sin0) - f.force;
  f.B = (d1 - Om * (Y * f.cos0 - X * f.sin0) + decay * f.A) / rate;
  return f;
}

/* q1 and its first two derivatives by time */
static void oscillator(const Flight *f, double psi, double q[3]) {
  int slides = f->mode != 0;
  double X = slides ? slide_cos : stick_cos, Y = slides ? slide_sin : stick_sin;
  double rate = slides ? slide_rate : stick_rate, decay = slides ? slide_decay : stick_decay;
  double t = (psi - f->psi0) / Om, e = exp(-decay * t), c = cos(rate * t), s = sin(rate * t);
  double h = e * (f->A * c + f->B * s), dh = e * ((f->B * rate - decay * f->A) * c - (f->A * rate + decay * f->B) * s);
  double x = X * cos(psi) + Y * sin(psi);
  q[0] = h + x + f->force, q[1] = dh + Om * (Y * cos(psi) - X * sin(psi));
  q[2] = -2 * decay * dh - (decay * decay + rate * rate) * h - Om * Om * x;
}

/* w, w', w'' */
static void relative(const Flight *f, double psi, double w[3]) {
  double t = (psi - f->psi0) / Om;
  if (model == 0) {
    double b = pull(f->mode) + slope;
    w[0] = f->w0 + C * (sin(psi) - f->sin0) + (f->dw0 - C * Om * f->cos0) * t - b * t * t / 2;
    w[1] = f->dw0 + C * Om * (cos(psi) - f->cos0) - b * t, w[2] = -C * Om * Om * sin(psi) - b;
    return;
  }
  double q[3], a = mu * g * f->mode;
  oscillator(f, psi, q);
  w[0] = q[0] - (f->q2 + f->dq2 * t + a * t * t / 2), w[1] = q[1] - (f->dq2 + a * t), w[2] = q[2] - a;
}

static double value(const Flight *f, double psi, int k) { double w[3]; relative(f, psi, w); return w[k]; }

/* where w, w' or w'' passes a level: Newton's method held in the bracket */
static double crossing(const Flight *f, int k, double level, double low, double high) {
  double top = value(f, high, k) - level, x = 0.5 * (low + high);
  for (int i = 0; i < 200; i++) {
    double w[3];
    relative(f, x, w);
    double y = w[k] - level;
    if (y == 0) return x;
    if ((y > 0) == (top > 0)) high = x; else low = x;
    double next = k < 2 && w[k + 1] != 0 ? x - y * Om / w[k + 1] : low;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (fabs(next - x) < 1e-15 * (1 + fabs(x)) || high - low < 4e-16 * (1 + fabs(high))) return next;
    x = next;
  }
  return x;
}

/* acceleration that friction must bear while stuck */
static double burden(const Flight *f, double psi) {
  double q[3];
  if (model == 0) return -C * Om * Om * sin(psi) - slope;
  oscillator(f, psi, q);
  return q[2];
}

static double grip(int side) { return model == 0 ? (side > 0 ? al : ar) : mu * g; }

static void arrive(const Flight *f, double psi, State *s) {
  double w[3], q[3], t = (psi - f->psi0) / Om, a = mu * g * f->mode;
  if (f->mode) relative(f, psi, w), s->w = w[0], s->dw = w[1]; else s->dw = 0;
  if (model == 1) {
    oscillator(f, psi, q);
    double q2 = f->mode ? f->q2 + f->dq2 * t + a * t * t / 2 : q[0] - s->w, d2 = f->mode ? f->dq2 + a * t : q[1];
    s->v = q[0] + eps * q2, s->dv = q[1] + eps * d2;
  }
  s->psi = psi;
}

static int at_left(const State *s) { return s->w >= left - 1e-12; }
static int at_right(const State *s) { return s->w <= -right + 1e-12; }

/* w' = 0: it sticks, is held by a wall, or goes on to the side to which it is pulled */
static void stop(State *s) {
  s->mode = 0, s->dw = 0;
  Flight f = depart(s);
  double a = burden(&f, s->psi);
  if (a > grip(1) && !at_left(s)) s->mode = 1;
  if (a < -grip(-1) && !at_right(s)) s->mode = -1;
}

static void stay(State *s, double until) {
  Flight f = depart(s);
  int up = !at_left(s), down = !at_right(s);
  for (double x = s->psi; x < until; x += 2 * PI / 400) {
    double y = fmin(x + 2 * PI / 400, until), a = burden(&f, y);
    int side = up && a > grip(1) ? 1 : down && a < -grip(-1) ? -1 : 0;
    if (!side) continue;
    double low = x, high = y;
    if (side * burden(&f, x) >= grip(side)) high = low;
    for (int i = 0; i < 80 && high - low > 2e-16 * (1 + high); i++) {
      double middle = 0.5 * (low + high);
      if (side * burden(&f, middle) > grip(side)) high = middle; else low = middle;
    }
    arrive(&f, high, s), s->mode = side;
    return;
  }
  arrive(&f, until, s);
}

/* the next zero of w'', or a place before it; of the moving cavity also w, w', w'' there, from those at x */
static double bend(const Flight *f, double x, const double at[3], double there[3], int fresh) {
  if (model == 0) {
    double q = -(pull(f->mode) + slope) / (C * Om * Om);
    if (fabs(q) >= 1) return x + 2 * PI;
    double one = asin(q), other = PI - one;
    one += 2 * PI * ceil((x + 1e-9 - one) / (2 * PI)), other += 2 * PI * ceil((x + 1e-9 - other) / (2 * PI));
    return fmin(one, other);
  }
  double first = x + (fresh ? 1e-7 : 0), y = x + 2 * PI / 100;
  relative(f, y, there);
  if (((fresh ? value(f, first, 2) : at[2]) > 0) != (there[2] > 0)) {
    double zero = crossing(f, 2, 0, first, y);
    if (zero > x + 1e-9) return zero + 1e-12;
  }
  return y;
}

static void strike(const Flight *f, double psi, State *s) {
  int wall = f->mode;
  arrive(f, psi, s);
  s->w = wall > 0 ? left : -right, s->dw *= wall > 0 ? -rl : -rr, s->hits++, s->events++;
  if (record && recorded < HITS) record[recorded++] = (Hit){psi, (model == 0 ? C * Om * cos(psi) : s->dv) - s->dw, wall};
  if (fabs(s->dw) >= 1e-9) { s->mode = -wall; return; }
  stop(s), s->events += 1000; /* impacts have piled up */
}

static void fly(State *s, double until) {
  Flight f = depart(s);
  double wall = f.mode > 0 ? left : right, at[3], there[3];
  int fresh = 1;
  relative(&f, s->psi, at);
  for (double x = s->psi;; fresh = 0, memcpy(at, there, sizeof at)) {
    double next = bend(&f, x, at, there, fresh), y = fmin(next, until), end = y;
    int turns = 0;
    if (model == 0 || y != x + 2 * PI / 100) relative(&f, y, there);
    if (f.mode * there[1] <= 0) {
      double low = f.mode * at[1] > 0 ? x : x + 1e-9;
      turns = 1, end = low < y && f.mode * value(&f, low, 1) > 0 ? crossing(&f, 1, 0, low, y) : x;
    }
    if (end > x && f.mode * at[0] < wall + 1e-14 && f.mode * (turns ? value(&f, end, 0) : there[0]) >= wall) {
      strike(&f, crossing(&f, 0, f.mode * wall, x, end), s);
      return;
    }
    if (turns) {
      arrive(&f, end, s), s->events++, stop(s);
      if (s->hits && (at_left(s) || at_right(s))) s->events += 1000; /* so near a wall impacts have piled up */
      if (end <= x && s->mode == f.mode && fresh) s->psi += 1e-9;
      return;
    }
    if (y >= until) { arrive(&f, until, s); return; }
    x = y;
  }
}

static void advance(State *s, double periods) { /* from psi to psi + 2 pi periods, and back by as much */
  double until = s->psi + 2 * PI * periods;
  while (s->psi < until) if (s->mode) fly(s, until); else stay(s, until);
  s->psi -= 2 * PI * floor(until / (2 * PI) + 1e-9);
}

static double apart(const State *a, const State *b) {
  double d = fmax(fabs(a->w - b->w), fabs(a->dw - b->dw));
  if (a->mode != b->mode && fabs(a->dw) + fabs(b->dw) > 1e-6) d = fmax(d, 1);
  return model == 0 ? d : fmax(d, fmax(fabs(a->v - b->v), fabs(a->dv - b->dv)));
}

/* growth of a small difference per period, drawn back once a period */
static double growth(State s, int periods) {
  double size = 1e-8, sum = 0;
  State o = s;
  if (s.mode) o.dw += size * s.mode; else o.w += s.w > 0 ? -size : size;
  for (int k = 0; k < periods; k++) {
    advance(&s, 1), advance(&o, 1);
    double d = sqrt(pow(o.w - s.w, 2) + pow(o.dw - s.dw, 2) + pow(o.v - s.v, 2) + pow(o.dv - s.dv, 2));
    d = fmax(d, 1e-14), sum += log(d / size);
    double q = size / d;
    o = (State){s.psi, fmin(fmax(s.w + (o.w - s.w) * q, -right), left), s.dw + (o.dw - s.dw) * q, s.v + (o.v - s.v) * q,
                s.dv + (o.dv - s.dv) * q, s.mode, 0, 0};
    if (!s.mode) o.dw = 0; else if (o.dw * s.mode < 0) o.mode = -s.mode;
  }
  return sum / periods;
}

/* whether a state lies on a motion without impacts, which has the same course anywhere between the walls */
static int drifted(const State *s, const State *one) {
  State a = *s, b = *one;
  a.v += eps * a.w, b.v += eps * b.w, a.w = b.w = 0;
  if (apart(&a, &b) >= 1e-6) return 0;
  a = *s, a.psi = a.hits = 0, advance(&a, 1);
  return !a.hits;
}

/* the attractor on which a state lies and whether it is the image of what was found first; -1 for none */
static int known(const State *s, int count, int *image) {
  *image = 0;
  for (int j = 0; j < count; j++)
    for (int q = 0; q < kinds[j].periods; q++) {
      if (kinds[j].free) {
        if (drifted(s, &kinds[j].own[q])) return j;
        continue;
      }
      *image = apart(s, &kinds[j].image[q]) < 1e-6;
      if (apart(s, &kinds[j].own[q]) < 1e-6) { *image = 0; return j; }
      if (*image) return j;
    }
  return -1;
}

/* beside a bifurcation a motion returns nearly long before it has settled: on until it returns to rounding. One that passed a saddle
   returns ever less: -2 */
static int settled(State *s, int periods, int count, int *image, State *seen) {
  int j = -1;
  for (double run = 0, gap = 1; run < PATIENCE && gap > 1e-12 && j < 0; run += periods) {
    State before = *s;
    before.psi = s->psi = s->hits = s->events = 0;
    for (int q = 0; q < periods; q++) seen[q] = *s, s->psi = 0, advance(s, 1);
    gap = apart(s, &before), j = known(s, count, image);
    if (j < 0 && gap > LEFT) return -2;
  }
  return j;
}

/* beside a doubling twice the period returns first: the shortest one, with its impacts and events */
static int shortest(State *s, int periods, const State *seen) {
  for (int q = 1; q < periods; q++)
    if (periods % q == 0 && apart(&seen[0], &seen[q]) < 1e-9) {
      *s = seen[0], s->psi = s->hits = s->events = 0, advance(s, q);
      return q;
    }
  return periods;
}

static void learn(Kind *k, const State *seen, int periods, const State *end) {
  *k = (Kind){.periods = periods, .hits = end->hits, .events = end->events, .free = !end->hits, .count = 1};
  for (int q = 0; q < periods; q++) {
    State z = k->own[q] = seen[q];
    advance(&z, 0.5);
    k->image[q] = (State){0, -z.w, -z.dw, -z.v, -z.dv, -z.mode, 0, 0};
  }
  State z = seen[0];
  record = k->hit, recorded = 0, advance(&z, periods), record = NULL, k->told = recorded;
}

int main(int argc, char **argv) {
  int starts, tries = argc > 3 ? atoi(argv[3]) : 5;
  unsigned long seed;
  double transient = argc > 1 ? atof(argv[1]) : 300, back = argc > 2 ? atof(argv[2]) : 1e-8, rate, reach = 0;
  if (scanf("%d %d %lu", &model, &starts, &seed) != 3) return 1;
  while (model == 0 ? scanf("%lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &C, &rl, &rr, &al, &ar, &slope, &Om, &left, &right, &rate) == 10
                    : scanf("%lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &chi, &G, &Om, &lam, &eps, &rl, &mu, &g, &rate, &reach) == 10) {
    int count = 0, stuck = 0, wandering = 0, chaotic = 0, image;
    if (model == 1) rr = rl;
    prepare();
    random_state = 88172645463325252ULL ^ (seed * 0x9E3779B97F4A7C15ULL);
    for (int i = 0; i < 20; i++) uniform();
    for (int i = 0; i < starts; i++) {
      State s = {.psi = 2 * PI * uniform(), .w = -right + (left + right) * uniform(), .dw = rate * (2 * uniform() - 1)};
      if (model == 1) s.v = reach * (2 * uniform() - 1), s.dv = reach * (2 * uniform() - 1);
      s.mode = s.dw > 0 ? 1 : -1;
      advance(&s, 1 - s.psi / (2 * PI));
      int found = 0, most = wandering < FULL ? tries : 2;
      double length = transient;
      for (int t = 0; t < most && !found; t++, length *= 4) {
        State seen[LONGEST + 1];
        int j = -1, k, one;
        for (double x = 0; x < length && j < 0; x += 50) s.psi = 0, advance(&s, 50), j = known(&s, count, &image);
        s.psi = s.hits = s.events = 0;
        if (j >= 0) { kinds[j].count++, kinds[j].mirrored += image, found = 1; break; }
        seen[0] = s;
        for (k = 1; k <= LONGEST; k++) {
          s.psi = 0, advance(&s, 1);
          if (apart(&s, &seen[0]) < back) break;
          seen[k] = s;
        }
        if (k > LONGEST) continue;
        found = 1;
        if (!s.events && !s.mode) { stuck++; break; }
        for (j = 0; j < count; j++)
          if (!s.hits && kinds[j].free && kinds[j].periods == k && kinds[j].events == s.events) break;
        if (j == count && s.hits) {
          one = settled(&s, k, count, &image, seen);
          if (one == -2) { found = 0; continue; }
          if (one >= 0) kinds[one].mirrored += image, j = one;
          else k = shortest(&s, k, seen);
        }
        if (j < count) kinds[j].count++;
        else if (count < KINDS) learn(&kinds[count++], seen, k, &s);
      }
      if (!found && wandering++ < FULL) chaotic += growth(s, 4000) > 0.003;
    }
    printf("value %.17g %d %d %d %d\n", model == 0 ? C : Om, count, stuck, wandering, chaotic);
    for (int j = 0; j < count; j++) {
      Kind *k = &kinds[j];
      printf("%d %d %d %d %d %d", k->periods, k->hits, k->events, k->count, k->mirrored, k->told);
      for (int q = 0; q < k->told; q++) printf(" %d %.15g %.15g", k->hit[q].wall, k->hit[q].psi, k->hit[q].B);
      printf("\n");
    }
    fflush(stdout);
  }
  return 0;
}
