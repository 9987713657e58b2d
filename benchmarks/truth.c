/* Returns of a steadily driven spring-slider to its stress maximum, in long double.

   In units of V_lp, Dc and a sigma, with w = exp(v):

       dx/dT   = kappa (1 - w)
       dv/dT   = (x - v - beta psi)/(eta w)
       dpsi/dT = -w (v + psi)  (slip law)   or   exp(-psi) - w  (aging law)

   by Radau IIA collocation (Hairer & Wanner, Solving Ordinary Differential Equations II, section
   IV.5) with S stages, whose coefficients are in radau.h.  A step is as long as the polynomial of
   the step before, extrapolated, foretells it to a tolerance.  That costs more steps than needed,
   and leaves errors far below the tolerance.  Extremes and returns are ends of steps of their own,
   where the method has its full order 2 S - 1. */

#include <math.h>
#include <string.h>

typedef long double real;

/* S; nodes C[S]; A[S][S]; its inverse D[S][S], with derivatives at the stages of what interpolates
   there and is 0 at 0; W[S], weights of such an interpolation. */
#include "radau.h"

enum { SEEDS = 4, KEPT = 7 }; /* directions: x, psi at the start, ln kappa, ln eta; see `turn` */
enum { DONE, NO_CONVERGENCE, TOO_MANY_STEPS, NOT_RISING };

static const real GROWTH = 4, SHRINKAGE = 0.2L, SAFETY = 0.6L, RETREAT = 0.25L;
static const real CLOSED = 1e-18L, STUCK = 1e-15L, ROUNDING = 1e-17L;
enum { MOST_ITERATIONS = 12, MOST_LANDINGS = 6, HALVINGS = 70 };

typedef struct {
    int aging;
    real kappa, beta, eta;
} Slider;

/* A step from y of length h: Z[i] are the changes of y at its stages, K[i] the Jacobians there. */
typedef struct {
    real y[3], h, Z[S][3], K[S][3][3], f[S][3];
} Step;

/* A matrix as rows scaled and permuted, and its factors. */
typedef struct {
    real lu[S][S], scale[S];
    int row[S];
} Factors;

/* Of D/h - K, without x, and of the rest without psi. */
typedef struct {
    Factors psi, v;
} Solver;

static real larger(real a, real b) { return a > b ? a : b; }
static real smaller(real a, real b) { return a < b ? a : b; }

static void rates(const Slider *s, const real *y, real *f)
{
    real v = y[1], psi = y[2];
    int near = fabsl(v) < 1 && fabsl(psi) < 1; /* steady sliding, where differences cancel */
    real less = near ? expm1l(v) : expl(v) - 1, w = near ? 1 + less : expl(v);
    f[0] = -s->kappa * less;
    f[1] = (y[0] - v - s->beta * psi) / (s->eta * w);
    if (!s->aging)
        f[2] = -w * (v + psi);
    else
        f[2] = near ? expm1l(-psi) - less : expl(-psi) - w;
}

static void jacobian(const Slider *s, const real *y, const real *f, real K[3][3])
{
    real w = expl(y[1]), soft = 1 / (s->eta * w);
    K[0][0] = 0, K[0][1] = -s->kappa * w, K[0][2] = 0;
    K[1][0] = soft, K[1][1] = -soft - f[1], K[1][2] = -s->beta * soft;
    K[2][0] = 0;
    K[2][1] = s->aging ? -w : -w * (y[1] + y[2]) - w;
    K[2][2] = s->aging ? -expl(-y[2]) : -w;
}

static void at_stage(const Step *step, int i, real *y)
{
    for (int c = 0; c < 3; c++)
        y[c] = step->y[c] + step->Z[i][c];
}

/* Rates and, if asked for, Jacobians at all stages. */
static void evaluate(const Slider *s, Step *step, int derivatives)
{
    real y[3];
    for (int i = 0; i < S; i++) {
        at_stage(step, i, y);
        rates(s, y, step->f[i]);
        if (derivatives)
            jacobian(s, y, step->f[i], step->K[i]);
    }
}

/* Factors of what m->lu holds, with pivots chosen by what they are in their rows. */
static void factorise(Factors *m)
{
    for (int r = 0; r < S; r++) {
        real most = 0;
        for (int q = 0; q < S; q++)
            most = larger(most, fabsl(m->lu[r][q]));
        m->scale[r] = 1 / most;
        for (int q = 0; q < S; q++)
            m->lu[r][q] *= m->scale[r];
        m->row[r] = r;
    }
    for (int k = 0; k < S; k++) {
        int best = k;
        for (int r = k + 1; r < S; r++)
            if (fabsl(m->lu[m->row[r]][k]) > fabsl(m->lu[m->row[best]][k]))
                best = r;
        int chosen = m->row[best];
        m->row[best] = m->row[k], m->row[k] = chosen;
        const real *pivot = m->lu[chosen];
        for (int r = k + 1; r < S; r++) {
            real *row = m->lu[m->row[r]], part = row[k] /= pivot[k];
            for (int q = k + 1; q < S; q++)
                row[q] -= part * pivot[q];
        }
    }
}

static void back_substitute(const Factors *m, const real *right, real *x)
{
    for (int k = 0; k < S; k++) {
        const real *row = m->lu[m->row[k]];
        real sum = right[m->row[k]] * m->scale[m->row[k]];
        for (int q = 0; q < k; q++)
            sum -= row[q] * x[q];
        x[k] = sum;
    }
    for (int k = S - 1; k >= 0; k--) {
        const real *row = m->lu[m->row[k]];
        real sum = x[k];
        for (int q = k + 1; q < S; q++)
            sum -= row[q] * x[q];
        x[k] = sum / row[k];
    }
}

/* Prepares `changes`.  With D = 1/A the equations (D/h - K) z = g of the changes z of a step's
   stages hold K at each stage alone, and there x and psi meet only v: what is left to be solved
   are one system of S for psi, and one for v. */
static void prepare(const Step *step, Solver *m)
{
    real column[S], by_v[S][S];
    for (int i = 0; i < S; i++)
        for (int j = 0; j < S; j++)
            m->psi.lu[i][j] = D[i][j] / step->h - (i == j ? step->K[i][2][2] : 0);
    factorise(&m->psi);
    for (int j = 0; j < S; j++) {
        memset(column, 0, sizeof column);
        column[j] = step->K[j][2][1];
        back_substitute(&m->psi, column, by_v[j]);
    }
    for (int i = 0; i < S; i++) {
        const real *K = step->K[i][1];
        for (int j = 0; j < S; j++)
            m->v.lu[i][j] = D[i][j] / step->h - (i == j ? K[1] : 0)
                            - K[0] * step->h * A[i][j] * step->K[j][0][1] - K[2] * by_v[j][i];
    }
    factorise(&m->v);
}

static void changes(const Step *step, const Solver *m, real g[S][3], real z[S][3])
{
    real x[S], psi[S], v[S], right[S];
    for (int i = 0; i < S; i++) {
        x[i] = 0;
        for (int j = 0; j < S; j++)
            x[i] += step->h * A[i][j] * g[j][0];
        right[i] = g[i][2];
    }
    back_substitute(&m->psi, right, psi);
    for (int i = 0; i < S; i++)
        right[i] = g[i][1] + step->K[i][1][0] * x[i] + step->K[i][1][2] * psi[i];
    back_substitute(&m->v, right, v);
    for (int i = 0; i < S; i++)
        right[i] = g[i][2] + step->K[i][2][1] * v[i];
    back_substitute(&m->psi, right, psi);
    for (int i = 0; i < S; i++) {
        for (int j = 0; j < S; j++)
            x[i] += step->h * A[i][j] * step->K[j][0][1] * v[j];
        z[i][0] = x[i], z[i][1] = v[i], z[i][2] = psi[i];
    }
}

/* One correction of Z; its size, NAN where it has none. */
static real correct(Step *step, const Solver *m)
{
    real gap[S][3], z[S][3], size = 0;
    for (int i = 0; i < S; i++)
        for (int c = 0; c < 3; c++) {
            real sum = 0;
            for (int j = 0; j < S; j++)
                sum += D[i][j] * step->Z[j][c];
            gap[i][c] = step->f[i][c] - sum / step->h;
        }
    changes(step, m, gap, z);
    for (int i = 0; i < S; i++)
        for (int c = 0; c < 3; c++) {
            if (!isfinite(z[i][c]))
                return NAN;
            step->Z[i][c] += z[i][c];
            size = larger(size, fabsl(z[i][c]) / larger(1, fabsl(step->y[c])));
        }
    return size;
}

/* Newton's method for Z from what it holds; whether it converged.  The matrix is renewed while
   that pays: corrections that fall slowly. */
static int solve(const Slider *s, Step *step, real small)
{
    static Solver m;
    real last = INFINITY;
    int renew = 1;
    for (int n = 0; n < MOST_ITERATIONS; n++) {
        evaluate(s, step, renew);
        if (renew)
            prepare(step, &m);
        real size = correct(step, &m);
        if (!(size < 100))
            return 0;
        if (size <= CLOSED * small || (size <= STUCK && size > 0.1L * last))
            return 1;
        if (size < last && size * size / last <= 0.1L * CLOSED * small && n)
            return 1;
        renew = size > 0.01L * last || size > 1e-3L;
        last = size;
    }
    return 0;
}

/* Carries derivatives of y (3 x SEEDS) over a step that is solved. */
static void carry(const Slider *s, Step *step, const real from[3][SEEDS], real to[3][SEEDS])
{
    static Solver m;
    evaluate(s, step, 1);
    prepare(step, &m);
    for (int k = 0; k < SEEDS; k++) {
        real slope[S][3], z[S][3];
        for (int j = 0; j < S; j++) {
            for (int c = 0; c < 3; c++) {
                slope[j][c] = 0;
                for (int d = 0; d < 3; d++)
                    slope[j][c] += step->K[j][c][d] * from[d][k];
            }
            slope[j][0] += k == 2 ? step->f[j][0] : 0;
            slope[j][1] -= k == 3 ? step->f[j][1] : 0;
        }
        changes(step, &m, slope, z);
        for (int c = 0; c < 3; c++)
            to[c][k] = from[c][k] + z[S - 1][c];
    }
}

/* The polynomial of a step, as change from its start, at part tau of it: 0 at 0, Z at C. */
static void interpolate(const Step *step, real tau, real *change)
{
    real weight[S];
    for (int i = 0; i < S; i++) {
        weight[i] = W[i] * tau;
        for (int j = 0; j < S; j++)
            if (j != i)
                weight[i] *= tau - C[j];
    }
    for (int c = 0; c < 3; c++) {
        change[c] = 0;
        for (int i = 0; i < S; i++)
            change[c] += weight[i] * step->Z[i][c];
    }
}

/* dv/dtau of the polynomial at stage i. */
static real slope_of_v(const Step *step, int i)
{
    real sum = 0;
    for (int j = 0; j < S; j++)
        sum += D[i][j] * step->Z[j][1];
    return sum;
}

/* v of a step, or its slope by a difference, at tau. */
static real followed(const Step *step, real tau, int slope)
{
    real change[3], next[3];
    interpolate(step, tau, change);
    if (!slope)
        return step->y[1] + change[1];
    real d = 1e-6L;
    interpolate(step, tau + d, next);
    interpolate(step, tau - d, change);
    return next[1] - change[1];
}

/* tau in low..high where v, or its slope, changes sign. */
static real crossing(const Step *step, real low, real high, int slope)
{
    int rising = followed(step, high, slope) > 0;
    for (int n = 0; n < HALVINGS; n++) {
        real middle = (low + high) / 2;
        if ((followed(step, middle, slope) > 0) == rising)
            high = middle;
        else
            low = middle;
    }
    return (low + high) / 2;
}

/* A step from where `whole` starts that ends at tau of it. */
static int land(const Slider *s, const Step *whole, real tau, Step *landed, real small)
{
    memcpy(landed->y, whole->y, sizeof landed->y);
    landed->h = tau * whole->h;
    for (int i = 0; i < S; i++)
        interpolate(whole, tau * C[i], landed->Z[i]);
    return solve(s, landed, small);
}

/* The same, moved until v = 0 at its end. */
static int land_on_section(const Slider *s, const Step *whole, real tau, Step *landed, real small)
{
    for (int n = 0; n < MOST_LANDINGS; n++) {
        real y[3], f[3];
        if (!land(s, whole, tau, landed, small))
            return 0;
        at_stage(landed, S - 1, y);
        rates(s, y, f);
        if (fabsl(y[1]) <= CLOSED * small)
            break;
        tau -= y[1] / f[1] / whole->h;
    }
    return 1;
}

/* What a turn finds: values, and their derivatives by x and psi at its start, ln kappa, ln eta. */
typedef struct {
    real values[KEPT], slopes[KEPT][SEEDS];
} Found;

enum { X, PSI, PERIOD, X_HIGH, X_LOW, V_MAX, V_MIN };

static void keep(Found *found, int which, real value, const real *slopes, int sign)
{
    if (sign * (value - found->values[which]) > 0) {
        found->values[which] = value;
        memcpy(found->slopes[which], slopes, sizeof found->slopes[which]);
    }
}

/* Whether a speed is more extreme than those kept, by more than rounding, as of a slider at rest. */
static int beyond(const Found *found, real v)
{
    real margin = ROUNDING * larger(1, fabsl(v));
    return v > found->values[V_MAX] + margin || v < found->values[V_MIN] - margin;
}

/* The changes of sign within a step, in their order: x is extreme (v = 0), or v is.  How many of
   `returns` are left, or -1 where a landing failed. */
static int events(const Slider *s, const Step *step, real t, real slope_before,
                  const real from[3][SEEDS], int returns, real small, Found *found)
{
    static Step landed;
    real v = step->y[1], slope = slope_before, tau = 0;
    for (int i = 0; i < S; i++) {
        real next_v = step->y[1] + step->Z[i][1], next_slope = slope_of_v(step, i);
        for (int kind = 0; kind < 2; kind++) {
            int extreme_v = kind == 0; /* between two zeros of v: no matter which comes first */
            real before = extreme_v ? slope : v, after = extreme_v ? next_slope : next_v;
            if ((before >= 0) == (after >= 0))
                continue;
            real reach = larger(fabsl(slope), fabsl(next_slope)) * (C[i] - tau);
            if (extreme_v && !beyond(found, v + reach) && !beyond(found, v - reach))
                continue;
            real y[3], to[3][SEEDS], at = crossing(step, tau, C[i], extreme_v);
            int ok = extreme_v ? land(s, step, at, &landed, small)
                               : land_on_section(s, step, at, &landed, small);
            if (!ok)
                return -1;
            at_stage(&landed, S - 1, y);
            carry(s, &landed, from, to);
            if (extreme_v) {
                keep(found, y[1] > 0 ? V_MAX : V_MIN, y[1], to[1], y[1] > 0 ? 1 : -1);
            } else if (after < 0) {
                keep(found, X_LOW, y[0], to[0], -1);
            } else {
                keep(found, X_HIGH, y[0], to[0], 1);
                if (--returns)
                    continue;
                real f[3];
                rates(s, y, f);
                found->values[X] = y[0], found->values[PSI] = y[2];
                found->values[PERIOD] = t + landed.h;
                for (int k = 0; k < SEEDS; k++) {
                    real later = -to[1][k] / f[1];
                    found->slopes[X][k] = to[0][k] + f[0] * later;
                    found->slopes[PSI][k] = to[2][k] + f[2] * later;
                    found->slopes[PERIOD][k] = later;
                }
                return 0;
            }
        }
        v = next_v, slope = next_slope, tau = C[i];
    }
    return returns;
}

/* From the stress maximum (x, psi) to the one `returns` later: found[KEPT][1 + SEEDS], each value
   with its slopes.  numbers: kappa, beta, eta; the tolerance of the extrapolation, in x, v and psi;
   the size of the orbit, <= 1, in whose units that is. */
int turn(int aging, const real *numbers, const real *u, int returns, int most_steps, real *out,
         int *taken)
{
    static Step step, trial;
    Slider s = {aging, numbers[0], numbers[1], numbers[2]};
    real tol = numbers[3], small = numbers[4];
    real y[3] = {u[0], 0, u[1]}, from[3][SEEDS] = {{1, 0, 0, 0}, {0}, {0, 1, 0, 0}};
    real f[3], t = 0, slope = 1, grow = 1, most = 1;
    Found found;
    memset(&found, 0, sizeof found);
    found.values[X_HIGH] = -INFINITY;
    rates(&s, y, f);
    if (!(f[1] > 0))
        return NOT_RISING;
    for (int c = 0; c < 3; c++)
        most = larger(most, fabsl(f[c]));
    real h = 1e-4L / most;
    step.h = 0;
    for (*taken = 0; *taken < most_steps; ++*taken) {
        memcpy(trial.y, y, sizeof y);
        trial.h = h;
        for (int i = 0; i < S; i++) {
            if (step.h == 0) {
                for (int c = 0; c < 3; c++)
                    trial.Z[i][c] = h * C[i] * f[c];
                continue;
            }
            interpolate(&step, 1 + C[i] * h / step.h, trial.Z[i]);
            for (int c = 0; c < 3; c++)
                trial.Z[i][c] -= step.Z[S - 1][c];
        }
        real guess[S][3], error = 0;
        memcpy(guess, trial.Z, sizeof guess);
        if (!solve(&s, &trial, small)) {
            h *= RETREAT;
            continue;
        }
        for (int i = 0; i < S; i++)
            for (int c = 0; c < 3; c++)
                error = larger(error, fabsl(trial.Z[i][c] - guess[i][c])
                                         / (small * larger(1, fabsl(y[c]))));
        grow = SAFETY * powl(tol / larger(error, 1e-30L), 1.0L / (S + 1));
        grow = step.h == 0 ? GROWTH : smaller(GROWTH, larger(SHRINKAGE, grow));
        if (step.h != 0 && error > tol) {
            h *= smaller(grow, 0.9L);
            continue;
        }
        step = trial;
        returns = events(&s, &step, t, slope, from, returns, small, &found);
        if (returns < 0)
            return NO_CONVERGENCE;
        if (returns == 0) {
            for (int k = 0; k < KEPT; k++) {
                out[k * (1 + SEEDS)] = found.values[k];
                memcpy(out + k * (1 + SEEDS) + 1, found.slopes[k], sizeof found.slopes[k]);
            }
            return DONE;
        }
        real to[3][SEEDS];
        carry(&s, &step, from, to);
        memcpy(from, to, sizeof to);
        slope = slope_of_v(&step, S - 1);
        at_stage(&step, S - 1, y);
        t += h;
        h *= grow;
    }
    return TOO_MANY_STEPS;
}
